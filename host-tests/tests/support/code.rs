//! An ELF file's functions, and where they are called or pointed to, by the linker's notes (`--emit-relocs`). Not every test uses all
//! of it.
#![allow(dead_code)]

use std::ops::Range;
use std::path::Path;

use cycles::{Function, Image};
use object::elf::SHF_ALLOC;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SectionFlags};

/// A program for a Cortex-M, as the linker left it.
pub struct Code {
    image: Image,
    /// Where a branch, an instruction or a word names a function, and where that begins; but no branch within a function.
    names: Vec<(u32, u32)>,
}

impl Code {
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let (image, bytes) = (Image::read(path)?, std::fs::read(path)?);
        let file = object::File::parse(&*bytes)?;
        let is_loaded = |flags| matches!(flags, SectionFlags::Elf { sh_flags } if sh_flags & u64::from(SHF_ALLOC) != 0);
        let mut names = Vec::new();
        for section in file.sections().filter(|section| is_loaded(section.flags())) {
            for (at, note) in section.relocations() {
                let RelocationTarget::Symbol(index) = note.target() else {
                    continue;
                };
                // Bit 0 says that the code is Thumb.
                let address = file.symbol_by_index(index)?.address() as u32 & !1;
                if image
                    .function_at(address)
                    .is_some_and(|function| function.address == address)
                {
                    names.push((at as u32, address));
                }
            }
        }
        anyhow::ensure!(
            !names.is_empty(),
            "{}: linked without --emit-relocs",
            path.display()
        );
        Ok(Self { image, names })
    }

    /// The functions whose name `is_wanted`, by address.
    pub fn functions_named(&self, is_wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = u32> {
        let functions = self
            .image
            .functions_named("")
            .filter(|function| function.size > 0);
        functions
            .filter(move |function| is_wanted(&function.name))
            .map(|function| function.address)
    }

    /// The address and the name of the function that holds `address`.
    pub fn function_at(&self, address: u32) -> Option<(u32, &str)> {
        self.image
            .function_at(address)
            .map(|Function { address, name, .. }| (*address, &**name))
    }

    /// Where code between these addresses names a function elsewhere.
    pub fn leads_out_of<'a>(
        &'a self,
        addresses: &'a Range<u32>,
    ) -> impl Iterator<Item = (u32, u32)> + 'a {
        self.names
            .iter()
            .copied()
            .filter(|(at, to)| addresses.contains(at) && !addresses.contains(to))
    }

    /// Where others than `function` itself name it.
    pub fn names_of(&self, function: u32) -> impl Iterator<Item = u32> {
        let is_other = move |at| {
            self.function_at(at)
                .is_none_or(|(namer, _)| namer != function)
        };
        self.names
            .iter()
            .filter(move |(at, to)| *to == function && is_other(*at))
            .map(|(at, _)| *at)
    }

    /// The functions that `function` names.
    pub fn named_by(&self, function: u32) -> impl Iterator<Item = u32> {
        let is_own = move |at| {
            self.function_at(at)
                .is_some_and(|(namer, _)| namer == function)
        };
        self.names
            .iter()
            .filter(move |(at, _)| is_own(*at))
            .map(|(_, to)| *to)
    }
}
