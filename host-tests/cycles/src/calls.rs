//! The calls of a function in an executed stream: from its first instruction to its return, with all that it calls and that
//! interrupts it.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::Result;

use crate::Core;
use crate::image::Image;
use crate::instruction::Instruction;
use crate::log::Registers;
use crate::pipeline::{Cost, Pipeline};

/// Every call of one of the functions that begin at some addresses.
#[derive(Debug)]
pub struct Calls<'a> {
    image: &'a Image,
    core: Core,
    entries: BTreeSet<u32>,
    /// Where the call that is running came from, the stream since then, and what it has cost.
    pub running: Option<(Registers, Stream<'a>, Cost)>,
    /// What each call that returned cost, in order.
    pub ended: Vec<Cost>,
    /// By its address, an instruction and what all its executions together cost.
    pub spots: BTreeMap<u32, (Instruction, Cost)>,
    /// The deepest the stack pointer went below where the caller had it.
    pub stack_bytes: u32,
}

/// What a core executes, one instruction after the other.
#[derive(Debug)]
pub struct Stream<'a> {
    image: &'a Image,
    pipeline: Pipeline,
    /// The registers before the instruction that is about to be executed.
    before: Option<Registers>,
}

impl<'a> Stream<'a> {
    pub fn of(image: &'a Image, core: Core) -> Self {
        Self { image, pipeline: Pipeline::new(core), before: None }
    }

    /// Takes the registers before the next instruction; of the one before that, if there is one: its address, itself and its cost.
    pub fn see(&mut self, next: Registers) -> Result<Option<(u32, Instruction, Cost)>> {
        let Some(before) = self.before.replace(next) else { return Ok(None) };
        let instruction = self.image.instruction_at(before.pc())?;
        let branches = next.pc() != before.pc() + instruction.size();
        Ok(Some((before.pc(), instruction, self.pipeline.execute(instruction, &before, branches))))
    }
}

impl<'a> Calls<'a> {
    pub fn of(image: &'a Image, core: Core, entries: BTreeSet<u32>) -> Self {
        let (ended, spots) = (Vec::new(), BTreeMap::new());
        Self { image, core, entries, running: None, ended, spots, stack_bytes: 0 }
    }

    pub fn see(&mut self, registers: Registers) -> Result<()> {
        if self.running.is_none() && self.entries.contains(&registers.pc()) {
            self.running = Some((registers, Stream::of(self.image, self.core), Cost::default()));
        }
        let Some((caller, stream, cost)) = &mut self.running else { return Ok(()) };
        let Some((address, instruction, executed)) = stream.see(registers)? else { return Ok(()) };
        self.spots.entry(address).or_insert((instruction, Cost::default())).1 += executed;
        self.stack_bytes = self.stack_bytes.max(caller.sp().saturating_sub(registers.sp()));
        *cost += executed;
        if registers.pc() == caller.lr() & !1 && registers.sp() == caller.sp() {
            self.ended.push(*cost);
            self.running = None;
        }
        Ok(())
    }

    /// Of all calls that returned.
    pub fn cost(&self) -> Cost {
        let mut all = Cost::default();
        self.ended.iter().for_each(|call| all += *call);
        all
    }

    /// Bytes of the distinct instructions executed.
    pub fn hot_bytes(&self) -> u32 {
        self.spots.values().map(|(instruction, _)| instruction.size()).sum()
    }

    /// Bytes of the functions entered.
    pub fn code_bytes(&self) -> u32 {
        let functions: BTreeSet<_> = self.spots.keys().filter_map(|&address| self.image.function_at(address)).collect();
        functions.into_iter().map(|function| function.size).sum()
    }
}
