//! The program as the linker left it: code and symbols.

use std::collections::BTreeMap;
use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use super::CountError;
use super::instruction::Instruction;

/// Halfwords from here on begin a long instruction.
const LONG: u16 = 0xe800;

/// Code sections and functions of an ELF file.
#[derive(Debug)]
pub struct Image {
    /// Start address and bytes.
    code: Vec<(u32, Vec<u8>)>,
    functions: Vec<Function>,
    /// Where code begins (`true`) and where data in the midst of it, by the mapping symbols `$t` and `$d`.
    marks: BTreeMap<u32, bool>,
}

/// A function: literal pools and paths never taken included.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function {
    /// Its first instruction.
    pub address: u32,
    /// Bytes.
    pub size: u32,
    /// Demangled.
    pub name: String,
}

impl Image {
    /// Reads an ELF file.
    pub fn read(path: &Path) -> Result<Self, CountError> {
        let unreadable = |reason: String| CountError::Unreadable { path: path.to_owned(), reason };
        let bytes = std::fs::read(path).map_err(|error| unreadable(error.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|error| unreadable(error.to_string()))?;
        let code = file.sections().filter(|section| section.kind() == SectionKind::Text);
        let code = code.map(|section| Ok((section.address() as u32, section.data()?.to_vec())));
        let code = code.collect::<Result<_, object::Error>>().map_err(|error| unreadable(error.to_string()))?;
        let functions = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
        let mut functions: Vec<_> = functions
            .map(|symbol| Function {
                // bit 0 only says that the code is Thumb
                address: symbol.address() as u32 & !1,
                size: symbol.size() as u32,
                name: format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or_default())),
            })
            .collect();
        functions.sort();
        functions.dedup_by_key(|function| function.address);
        let is_code = |name: &str| match name.split('.').next() {
            Some("$t") => Some(true),
            Some("$d") => Some(false),
            _ => None,
        };
        let marks = file.symbols().filter_map(|symbol| Some((symbol.address() as u32, is_code(symbol.name().ok()?)?)));
        Ok(Self { code, functions, marks: marks.collect() })
    }

    /// The functions whose demangled name contains `part`.
    pub fn functions_named(&self, part: &str) -> impl Iterator<Item = &Function> {
        self.functions.iter().filter(move |function| function.name.contains(part))
    }

    /// The function that holds `address`.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let index = self.functions.partition_point(|function| function.address <= address).checked_sub(1)?;
        self.functions.get(index).filter(|function| address - function.address < function.size)
    }

    /// Every instruction there is, as its address and its halfwords, the second 0 if it has only one.
    pub fn words(&self) -> Vec<(u32, u16, u16)> {
        let mut words = Vec::new();
        for (start, bytes) in &self.code {
            let (halfwords, _) = bytes.as_chunks();
            let mut halfwords = (*start..).step_by(2).zip(halfwords.iter().map(|half| u16::from_le_bytes(*half)));
            while let Some((address, first)) = halfwords.next() {
                if self.marks.range(..=address).next_back().is_some_and(|(_, is_code)| *is_code) {
                    let is_long = first >= LONG;
                    let second = if is_long { halfwords.next().map_or(0, |(_, second)| second) } else { 0 };
                    words.push((address, first, second));
                }
            }
        }
        words
    }

    /// The instruction at `address`.
    pub fn instruction_at(&self, address: u32) -> Result<Instruction, CountError> {
        let halfword = |address: u32| {
            self.code.iter().find_map(|(start, bytes)| {
                let at = address.checked_sub(*start)? as usize;
                Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
            })
        };
        let first = halfword(address).ok_or(CountError::NoCode { address })?;
        let second = halfword(address + 2).unwrap_or_default();
        Instruction::decode(first, second).ok_or(CountError::UnknownInstruction { address, first, second })
    }
}
