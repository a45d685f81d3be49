//! Where the instructions and cycles of the counted function go.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, bail, ensure};
use firmware::job::Request;

use super::calls::Calls;
use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::Cost;
use super::trace::{Ended, LIMIT};
use super::{COUNTED, Target};
use crate::emulator::process::timed_out;

/// An instruction of the program and what all its executions together cost.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub instruction: Instruction,
    pub cost: Cost,
}

#[derive(Clone, Debug, Default)]
pub struct Profile {
    spots: BTreeMap<u32, Spot>,
    stack_bytes: u32,
}

impl Profile {
    /// Runs `request` on `target` and profiles the counted function, all calls of it together.
    pub fn of(target: &Target, request: &Request) -> Result<Self> {
        let image = target.image();
        let entries = image.functions_named(COUNTED).map(|function| function.address).collect();
        let mut calls = Calls::of(image, target.core(), entries);
        match target.trace(&request.to_string(), LIMIT, |registers| calls.see(registers))? {
            Ended { status: Some(status), .. } if status.success() => {}
            Ended { status: None, .. } => bail!(timed_out(&target.elf.display().to_string(), LIMIT)),
            Ended { output, .. } => bail!("{request}: {}", output.trim()),
        }
        let profile = calls.into_profile();
        ensure!(!profile.spots.is_empty(), "{COUNTED} was never called");
        Ok(profile)
    }

    /// An instruction that has been executed at an address, what it cost, and how deep the stack is.
    pub(super) fn add(&mut self, (address, instruction, cost): (u32, Instruction, Cost), stack_bytes: u32) {
        let spot = self.spots.entry(address).or_insert(Spot { instruction, cost: Cost::default() });
        spot.cost += cost;
        self.stack_bytes = self.stack_bytes.max(stack_bytes);
    }

    pub fn cost(&self) -> Cost {
        let mut total = Cost::default();
        self.spots.values().for_each(|spot| total += spot.cost);
        total
    }

    pub fn spots(&self) -> impl Iterator<Item = (u32, &Spot)> {
        self.spots.iter().map(|(address, spot)| (*address, spot))
    }

    pub fn functions<'a>(&self, image: &'a Image) -> impl Iterator<Item = &'a Function> {
        let functions: BTreeSet<_> = self.spots.keys().filter_map(|&address| image.function_at(address)).collect();
        functions.into_iter()
    }

    pub fn hot_bytes(&self) -> u32 {
        self.spots.values().map(|spot| spot.instruction.size()).sum()
    }

    /// The deepest the stack pointer went below where the caller had it.
    pub fn stack_bytes(&self) -> u32 {
        self.stack_bytes
    }
}
