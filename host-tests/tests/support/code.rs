//! The functions of an ELF file, and the places where they are called or referenced, from the
//! linker's relocations (`--emit-relocs`). Not every test uses all of this module.
#![allow(dead_code)]

use std::path::Path;

use cycles::{Function, Image};
use object::elf::SHF_ALLOC;
use object::{Object, ObjectSection, ObjectSymbol, RelocationTarget, SectionFlags};

pub struct Code {
    image: Image,
    /// The places that refer to a function, and the address of that function. Branches within a
    /// function are not included.
    names: Vec<(u32, u32)>,
}

impl Code {
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let image = Image::read(path)?;
        let bytes = std::fs::read(path)?;
        let file = object::File::parse(&*bytes)?;
        let allocates = |flags: u64| flags & u64::from(SHF_ALLOC) != 0;
        let is_loaded =
            |flags| matches!(flags, SectionFlags::Elf { sh_flags } if allocates(sh_flags));
        let mut names = Vec::new();
        // Debugging information has relocations as well, but is not loaded.
        for section in file.sections().filter(|section| is_loaded(section.flags())) {
            for (at, note) in section.relocations() {
                let RelocationTarget::Symbol(index) = note.target() else {
                    continue;
                };

                // Bit 0 marks the code as Thumb.
                let address = file.symbol_by_index(index)?.address() as u32 & !1;
                // A reference into the middle of a function is a branch within it.
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

    pub fn functions_named(&self, is_wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = u32> {
        let functions = self
            .image
            .functions_named("")
            .filter(|function| function.size > 0);
        functions
            .filter(move |function| is_wanted(&function.name))
            .map(|function| function.address)
    }

    pub fn function_at(&self, address: u32) -> Option<(u32, &str)> {
        self.image
            .function_at(address)
            .map(|Function { address, name, .. }| (*address, &**name))
    }

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

    /// A function is there once for each place.
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
