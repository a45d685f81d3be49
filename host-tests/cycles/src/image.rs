//! A linked program: its code and symbols.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};
use object::{
    Architecture, Object, ObjectSection, ObjectSegment, ObjectSymbol, SectionKind, SymbolKind,
};

use crate::instruction::{Instruction, is_long};

/// A program. Its addresses are for use after the start, which may copy code and data.
#[derive(Debug)]
pub struct Image {
    path: PathBuf,
    loaded: Vec<(u32, Vec<u8>)>,
    code: Vec<(u32, Vec<u8>)>,
    functions: Vec<Function>,
    /// The beginnings of code (`true`) and of data between code (`false`): the mapping symbols `$t`
    /// and `$d`.
    marks: BTreeMap<u32, bool>,
}

/// A function with its literal pools, or any other symbol in a section with code.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function {
    /// The address without the Thumb bit.
    pub address: u32,
    /// 0 if the file does not declare it.
    pub size: u32,
    /// Demangled.
    pub name: String,
    /// The name that the linker uses, mangled or not.
    pub symbol: String,
}

impl Image {
    /// Reads an ELF file for a 32-bit ARM.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(path).with_context(|| path.display().to_string())
    }

    fn parse(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path)?;
        let file = object::File::parse(&*bytes).context("no ELF file for ARM")?;
        let architecture = file.architecture();
        ensure!(
            architecture == Architecture::Arm,
            "no program for ARM but for {architecture:?}"
        );

        let loaded = file
            .segments()
            .map(|segment| Ok((segment.address() as u32, segment.data()?.to_vec())));
        let sections = file
            .sections()
            .filter(|section| section.kind() == SectionKind::Text);
        let code = sections.map(|section| Ok((section.address() as u32, section.data()?.to_vec())));

        let is_in_code = |symbol: &object::Symbol| {
            let section = symbol
                .section_index()
                .and_then(|index| file.section_by_index(index).ok());
            section.is_some_and(|section| section.kind() == SectionKind::Text)
        };
        let mut functions = Vec::new();
        let mut marks = BTreeMap::new();

        for symbol in file.symbols() {
            let address = symbol.address() as u32;
            let name = symbol.name().unwrap_or_default();
            let is_function = symbol.kind() == SymbolKind::Text;
            match name.split('.').next() {
                _ if !is_function && !is_in_code(&symbol) => {}
                Some(mark @ ("$t" | "$d")) => drop(marks.insert(address, mark == "$t")),
                _ => functions.push(Function {
                    address: address & !1,
                    size: symbol.size() as u32,
                    name: format!("{:#}", rustc_demangle::demangle(name)),
                    symbol: name.to_owned(),
                }),
            }
        }

        functions.sort();
        let loaded = loaded.collect::<Result<_>>()?;
        let code = code.collect::<Result<_>>()?;
        Ok(Self {
            path: path.to_owned(),
            loaded,
            code,
            functions,
            marks,
        })
    }

    pub fn functions_named(&self, part: &str) -> impl Iterator<Item = &Function> {
        self.functions
            .iter()
            .filter(move |function| function.name.contains(part))
    }

    /// Returns the function with this name, mangled or demangled, or the only one whose demangled
    /// name contains it.
    pub fn function(&self, name: &str) -> Result<&Function> {
        let is_it = |function: &&Function| function.name == name || function.symbol == name;
        let mut found: Vec<_> = self.functions.iter().filter(is_it).collect();
        if found.is_empty() {
            found = self.functions_named(name).collect();
        }

        // Several names of the same address are not ambiguous.
        found.dedup_by_key(|function| function.address);
        match found[..] {
            [] => Err(self.lacks(name)),
            [function] => Ok(function),
            [one, another, ..] => {
                let [one, another] = [&one.symbol, &another.symbol];
                let number = found.len();
                bail!("{name} may be any of {number}, such as {one} and {another}")
            }
        }
    }

    pub fn word(&self, address: u32) -> Option<u32> {
        self.loaded.iter().find_map(|(start, bytes)| {
            let at = address.checked_sub(*start)? as usize;
            let word = bytes.get(at..at.checked_add(4)?)?;
            Some(u32::from_le_bytes(word.try_into().ok()?))
        })
    }

    pub fn lacks(&self, function: &str) -> anyhow::Error {
        anyhow!("{}: no function {function}", self.path.display())
    }

    /// Returns the function at this address; the last to begin, if there are several.
    pub fn function_at(&self, address: u32) -> Option<&Function> {
        let before = self
            .functions
            .partition_point(|function| function.address <= address);
        // A label without a size contains no address.
        self.functions[..before]
            .iter()
            .rfind(|function| address - function.address < function.size)
    }

    pub fn words(&self) -> Vec<(u32, u16, Option<u16>)> {
        let mut words = Vec::new();
        for (start, bytes) in &self.code {
            let halfwords = bytes
                .as_chunks()
                .0
                .iter()
                .map(|half| u16::from_le_bytes(*half));
            let mut halfwords = (*start..).step_by(2).zip(halfwords);
            while let Some((address, first)) = halfwords.next() {
                if self
                    .marks
                    .range(..=address)
                    .next_back()
                    .is_some_and(|(_, is_code)| *is_code)
                {
                    let second = if is_long(first) {
                        halfwords.next().map(|(_, second)| second)
                    } else {
                        None
                    };
                    words.push((address, first, second));
                }
            }
        }
        words
    }

    pub fn instruction_at(&self, address: u32) -> Result<Instruction> {
        let halfword = |address: u32| {
            self.loaded.iter().find_map(|(start, bytes)| {
                let at = address.checked_sub(*start)? as usize;
                Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
            })
        };

        let first = halfword(address).with_context(|| format!("no code at {address:#x}"))?;
        let second = halfword(address + 2).unwrap_or_default();
        Instruction::decode(first, second).with_context(|| {
            let function = self.function_at(address).map_or("?", |inside| &inside.name);
            format!(
                "no timing for the instruction {first:04x} {second:04x} \
                at {address:#x} in {function}"
            )
        })
    }
}
