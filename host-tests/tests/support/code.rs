//! An ELF file's functions, and where they are called or pointed to. Not every test uses all of it.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;
use std::path::Path;

use object::{File, Object, ObjectSection, ObjectSymbol, SectionFlags, SectionIndex, SectionKind, SymbolKind};

use super::branch::{Names, names};

/// Bit 0 of a function's address says that its code is Thumb.
const THUMB: u32 = 1;
/// Halfwords from here on begin a long instruction.
const LONG: u16 = 0xe800;

/// A program for a Cortex-M, as the linker left it.
pub struct Code {
    functions: BTreeMap<u32, Function>,
    /// Where each direct branch is, and where it goes.
    branches: Vec<(u32, u32)>,
    /// Where each number is that might be an address: in the data, in literal pools, put together by two instructions.
    numbers: Vec<(u32, u32)>,
}

struct Function {
    size: u32,
    name: String,
}

impl Code {
    pub fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let bytes = std::fs::read(path)?;
        let file = File::parse(&*bytes)?;
        let symbols = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
        let functions = symbols.map(|symbol| {
            let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or_default()));
            (symbol.address() as u32 & !THUMB, Function { size: symbol.size() as u32, name })
        });
        let mut code = Self { functions: functions.collect(), branches: Vec::new(), numbers: Vec::new() };
        for section in file.sections() {
            let (start, data) = (section.address() as u32, section.data()?);
            if section.kind() == SectionKind::Text {
                code.read_instructions(start, data, &code_and_data(&file, section.index()));
            }
            if is_loaded(section.flags()) {
                let words = data.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word));
                code.numbers.extend((start..).step_by(4).zip(words));
            }
        }
        Ok(code)
    }

    fn read_instructions(&mut self, start: u32, data: &[u8], code_and_data: &BTreeMap<u32, bool>) {
        let mut halfwords = (start..).step_by(2).zip(data.as_chunks().0.iter().map(|half| u16::from_le_bytes(*half)));
        let mut lower = [0; 16];
        while let Some((address, first)) = halfwords.next() {
            let is_code = code_and_data.range(..=address).next_back().is_some_and(|(_, is_code)| *is_code);
            if !is_code {
                continue;
            }
            let second = if first >= LONG { halfwords.next().map(|(_, second)| second) } else { None };
            match names(first, second) {
                Some(Names::Branch(offset)) => {
                    self.branches.push((address, address.wrapping_add(4).wrapping_add_signed(offset)));
                }
                Some(Names::Lower(register, half)) => lower[usize::from(register)] = half,
                Some(Names::Upper(register, half)) => {
                    let number = u32::from(half) << 16 | u32::from(lower[usize::from(register)]);
                    self.numbers.push((address, number));
                }
                None => {}
            }
        }
    }

    /// The functions whose name `is_wanted`, by address.
    pub fn functions_named(&self, is_wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = u32> {
        self.functions.iter().filter(move |(_, function)| is_wanted(&function.name)).map(|(address, _)| *address)
    }

    /// The address and the name of the function that holds `address`.
    pub fn function_at(&self, address: u32) -> Option<(u32, &str)> {
        let (start, function) = self.functions.range(..=address).next_back()?;
        (address - start < function.size).then_some((*start, &*function.name))
    }

    /// Where code between these addresses branches to other code, or has the address of another function.
    pub fn leads_out_of<'a>(&'a self, addresses: &'a Range<u32>) -> impl Iterator<Item = (u32, u32)> + 'a {
        let functions =
            self.numbers.iter().filter(|(_, to)| to & THUMB == THUMB && self.functions.contains_key(&(to ^ THUMB)));
        let all = self.branches.iter().chain(functions).copied();
        // What fills up the place between functions is no code.
        let is_code = |at: &u32| addresses.contains(at) && self.function_at(*at).is_some();
        all.filter(move |(at, to)| is_code(at) && !addresses.contains(to))
    }

    /// Where other functions branch to `function`.
    pub fn calls_of(&self, function: u32) -> impl Iterator<Item = u32> {
        let is_other = move |at| self.function_at(at).is_none_or(|(caller, _)| caller != function);
        self.branches.iter().filter(move |(at, to)| *to == function && is_other(*at)).map(|(at, _)| *at)
    }

    /// Where the address of `function` is kept, by which it could be called.
    pub fn pointers_to(&self, function: u32) -> impl Iterator<Item = u32> {
        self.numbers.iter().filter(move |(_, number)| *number == function | THUMB).map(|(at, _)| *at)
    }
}

/// Where in a section code begins (`true`) and where data in the midst of it: the mapping symbols `$t` and `$d`.
fn code_and_data(file: &File, section: SectionIndex) -> BTreeMap<u32, bool> {
    let is_code = |name: &str| match name.split('.').next() {
        Some("$t") => Some(true),
        Some("$d") => Some(false),
        _ => None,
    };
    let symbols = file.symbols().filter(|symbol| symbol.section_index() == Some(section));
    symbols.filter_map(|symbol| Some((symbol.address() as u32, is_code(symbol.name().ok()?)?))).collect()
}

fn is_loaded(flags: SectionFlags) -> bool {
    matches!(flags, SectionFlags::Elf { sh_flags } if sh_flags & u64::from(object::elf::SHF_ALLOC) != 0)
}
