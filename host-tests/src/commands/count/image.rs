//! The program as the linker left it: code and symbols.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use object::{Architecture, Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionKind, SymbolKind};

use super::CountError;
use super::instruction::Instruction;

/// Halfwords from here on begin a long instruction.
const LONG: u16 = 0xe800;

/// Code sections and functions of an ELF file.
#[derive(Debug)]
pub struct Image {
    path: PathBuf,
    /// Start address and bytes of all that is loaded, functions that run in RAM included.
    loaded: Vec<(u32, Vec<u8>)>,
    /// Of the code sections.
    code: Vec<(u32, Vec<u8>)>,
    functions: Vec<Function>,
    /// Names in code that the assembler was not told to be functions.
    labels: Vec<Function>,
    /// Where code begins (`true`) and where data in the midst of it, by the mapping symbols `$t` and `$d`.
    marks: BTreeMap<u32, bool>,
}

/// A function: literal pools and paths never taken included.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function {
    /// Its first instruction.
    pub address: u32,
    /// Bytes; 0 if the assembler was not told.
    pub size: u32,
    /// Demangled.
    pub name: String,
    /// As the linker knows it.
    pub symbol: String,
}

impl Image {
    /// Reads an ELF file for ARM.
    pub fn read(path: &Path) -> Result<Self, CountError> {
        let unreadable = |reason: String| CountError::Unreadable { path: path.to_owned(), reason };
        let bytes = std::fs::read(path).map_err(|error| unreadable(error.to_string()))?;
        let file = object::File::parse(&*bytes).map_err(|error| unreadable(error.to_string()))?;
        if file.architecture() != Architecture::Arm {
            return Err(unreadable(format!("no program for ARM but for {:?}", file.architecture())));
        }
        let read = |error: object::Error| unreadable(error.to_string());
        let loaded = file.segments().map(|segment| Ok((segment.address() as u32, segment.data()?.to_vec())));
        let loaded = loaded.collect::<Result<_, object::Error>>().map_err(read)?;
        let code = file.sections().filter(|section| section.kind() == SectionKind::Text);
        let code = code.map(|section| Ok((section.address() as u32, section.data()?.to_vec())));
        let code = code.collect::<Result<_, object::Error>>().map_err(read)?;
        let function = |symbol: object::Symbol| Function {
            // bit 0 only says that the code is Thumb
            address: symbol.address() as u32 & !1,
            size: symbol.size() as u32,
            name: format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or_default())),
            symbol: symbol.name().unwrap_or_default().to_owned(),
        };
        let (functions, others): (Vec<_>, Vec<_>) =
            file.symbols().partition(|symbol| symbol.kind() == SymbolKind::Text);
        let mut functions: Vec<_> = functions.into_iter().map(function).collect();
        functions.sort();
        let is_label = |symbol: &object::Symbol| {
            let section = symbol.section_index().and_then(|index| file.section_by_index(index).ok());
            section.is_some_and(|section| section.kind() == SectionKind::Text)
        };
        let labels = others.into_iter().filter(is_label).map(function).collect();
        let is_code = |name: &str| match name.split('.').next() {
            Some("$t") => Some(true),
            Some("$d") => Some(false),
            _ => None,
        };
        let marks = file.symbols().filter_map(|symbol| Some((symbol.address() as u32, is_code(symbol.name().ok()?)?)));
        Ok(Self { path: path.to_owned(), loaded, code, functions, labels, marks: marks.collect() })
    }

    /// The functions whose demangled name contains `part`.
    pub fn functions_named(&self, part: &str) -> impl Iterator<Item = &Function> {
        self.functions.iter().filter(move |function| function.name.contains(part))
    }

    /// The one function or label of this name, mangled or demangled, or the one function whose demangled name contains it.
    pub fn function(&self, name: &str) -> Result<&Function, CountError> {
        let is_it = |function: &&Function| function.name == name || function.symbol == name;
        let mut found: Vec<_> = self.functions.iter().chain(&self.labels).filter(is_it).collect();
        if found.is_empty() {
            found = self.functions_named(name).collect();
        }
        // Several names of one place are no question.
        found.dedup_by_key(|function| function.address);
        match found[..] {
            [] => Err(self.lacks(name)),
            [function] => Ok(function),
            [one, another, ..] => Err(CountError::Ambiguous {
                function: name.to_owned(),
                number: found.len(),
                one: one.symbol.clone(),
                another: another.symbol.clone(),
            }),
        }
    }

    /// Whether something is loaded to `address`.
    pub fn holds(&self, address: u32) -> bool {
        self.loaded.iter().any(|(start, bytes)| address.wrapping_sub(*start) < bytes.len() as u32)
    }

    /// That it has no such function.
    pub fn lacks(&self, function: &str) -> CountError {
        CountError::NoFunction { path: self.path.clone(), function: function.to_owned() }
    }

    /// The function that holds `address`.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let before = self.functions.partition_point(|function| function.address <= address);
        self.functions[..before].iter().rfind(|function| address - function.address < function.size)
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
            self.loaded.iter().find_map(|(start, bytes)| {
                let at = address.checked_sub(*start)? as usize;
                Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
            })
        };
        let first = halfword(address).ok_or(CountError::NoCode { address })?;
        let second = halfword(address + 2).unwrap_or_default();
        Instruction::decode(first, second).ok_or_else(|| {
            let function = self.function_at(address).map_or_else(|| String::from("?"), |inside| inside.name.clone());
            CountError::UnknownInstruction { address, first, second, function }
        })
    }
}
