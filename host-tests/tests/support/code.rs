//! An ELF file's functions, and where they are called or pointed to. Not every test uses all of it.
#![allow(dead_code)]

use std::ops::Range;
use std::path::Path;

use cycles::Image;

use super::branch::{Names, names};

/// Bit 0 of a function's address says that its code is Thumb.
const THUMB: u32 = 1;

/// A program for a Cortex-M, as the linker left it.
pub struct Code {
    image: Image,
    /// Where each direct branch is, and where it goes.
    branches: Vec<(u32, u32)>,
    /// Where each number is that might be an address: in the data, in literal pools, put together by two instructions.
    numbers: Vec<(u32, u32)>,
}

impl Code {
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let image = Image::read(path)?;
        let (mut branches, mut numbers, mut lower) = (Vec::new(), Vec::new(), [0; 16]);
        for (start, data) in image.loaded() {
            let words = data.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word));
            numbers.extend((start..).step_by(4).zip(words));
        }
        for (address, first, second) in image.words() {
            match names(first, second) {
                Some(Names::Branch(offset)) => {
                    branches.push((address, address.wrapping_add(4).wrapping_add_signed(offset)));
                }
                Some(Names::Lower(register, half)) => lower[usize::from(register)] = half,
                Some(Names::Upper(register, half)) => {
                    numbers.push((address, u32::from(half) << 16 | u32::from(lower[usize::from(register)])));
                }
                None => {}
            }
        }
        Ok(Self { image, branches, numbers })
    }

    /// The functions whose name `is_wanted`, by address.
    pub fn functions_named(&self, is_wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = u32> {
        let functions = self.image.functions_named("").filter(|function| function.size > 0);
        functions.filter(move |function| is_wanted(&function.name)).map(|function| function.address)
    }

    /// The address and the name of the function that holds `address`.
    pub fn function_at(&self, address: u32) -> Option<(u32, &str)> {
        self.image.function_at(address).map(|function| (function.address, &*function.name))
    }

    /// Where code between these addresses branches to other code, or has the address of another function.
    pub fn leads_out_of<'a>(&'a self, addresses: &'a Range<u32>) -> impl Iterator<Item = (u32, u32)> + 'a {
        let begins = |to: u32| self.function_at(to).is_some_and(|(start, _)| start == to);
        let within = |all: &'a [(u32, u32)]| all.iter().copied().filter(|(at, _)| addresses.contains(at));
        let functions = within(&self.numbers).filter(move |(_, to)| to & THUMB == THUMB && begins(to ^ THUMB));
        // What fills up the place between functions is no code.
        let is_code = |at: &u32| self.function_at(*at).is_some();
        within(&self.branches).chain(functions).filter(move |(at, to)| is_code(at) && !addresses.contains(to))
    }

    /// Where other functions branch to `function`.
    pub fn calls_of(&self, function: u32) -> impl Iterator<Item = u32> {
        let is_other = move |at| self.function_at(at).is_none_or(|(caller, _)| caller != function);
        self.branches.iter().filter(move |(at, to)| *to == function && is_other(*at)).map(|(at, _)| *at)
    }

    /// Where `function` branches to, itself included.
    pub fn calls_from(&self, function: u32) -> impl Iterator<Item = u32> {
        let is_own = move |at| self.function_at(at).is_some_and(|(caller, _)| caller == function);
        self.branches.iter().filter(move |(at, _)| is_own(*at)).map(|(_, to)| *to)
    }

    /// Where the address of `function` is kept, by which it could be called.
    pub fn pointers_to(&self, function: u32) -> impl Iterator<Item = u32> {
        self.numbers.iter().filter(move |(_, number)| *number == function | THUMB).map(|(at, _)| *at)
    }
}
