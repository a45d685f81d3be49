//! The program as the linker left it: code and symbols.

use std::path::Path;

use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use super::CountError;
use super::instruction::Instruction;

/// Code sections and functions of an ELF file.
#[derive(Debug)]
pub struct Image {
    /// Start address and bytes.
    code: Vec<(u32, Vec<u8>)>,
    functions: Vec<Function>,
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
        Ok(Self { code, functions })
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
