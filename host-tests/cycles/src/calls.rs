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
    running: Option<(Registers, Stream, Cost)>,
    /// What each call that returned cost, in order.
    pub ended: Vec<Cost>,
    /// By its address, an instruction and what all its executions together cost.
    pub spots: BTreeMap<u32, (Instruction, Cost)>,
    /// The deepest the stack pointer went below where the caller had it.
    pub stack_bytes: u32,
}

#[derive(Clone, Copy, Debug)]
pub struct Stream {
    /// The registers before the instruction that is about to be executed.
    before: Registers,
    instruction: Instruction,
    pipeline: Pipeline,
}

impl Stream {
    pub fn begin(image: &Image, core: Core, before: Registers) -> Result<Self> {
        Ok(Self { before, instruction: image.instruction_at(before.pc())?, pipeline: Pipeline::new(core) })
    }

    /// The pending instruction has been executed and led to `next`: its address, itself and what it cost.
    pub fn execute(&mut self, next: &Registers) -> (u32, Instruction, Cost) {
        let (address, instruction) = (self.before.pc(), self.instruction);
        let branches = next.pc() != address + instruction.size();
        (address, instruction, self.pipeline.execute(instruction, &self.before, branches))
    }

    pub fn go_on(&mut self, image: &Image, next: Registers) -> Result<()> {
        (self.before, self.instruction) = (next, image.instruction_at(next.pc())?);
        Ok(())
    }
}

impl<'a> Calls<'a> {
    pub fn of(image: &'a Image, core: Core, entries: BTreeSet<u32>) -> Self {
        let (ended, spots) = (Vec::new(), BTreeMap::new());
        Self { image, core, entries, running: None, ended, spots, stack_bytes: 0 }
    }

    pub fn see(&mut self, registers: Registers) -> Result<()> {
        match &mut self.running {
            Some((caller, stream, cost)) => {
                let (address, instruction, executed) = stream.execute(&registers);
                self.spots.entry(address).or_insert((instruction, Cost::default())).1 += executed;
                self.stack_bytes = self.stack_bytes.max(caller.sp().saturating_sub(registers.sp()));
                *cost += executed;
                if registers.pc() != caller.lr() & !1 || registers.sp() != caller.sp() {
                    return stream.go_on(self.image, registers);
                }
                self.ended.push(*cost);
                self.running = None;
            }
            None if self.entries.contains(&registers.pc()) => {
                self.running = Some((registers, Stream::begin(self.image, self.core, registers)?, Cost::default()));
            }
            None => {}
        }
        Ok(())
    }

    pub fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Of all calls that returned.
    pub fn cost(&self) -> Cost {
        self.ended.iter().copied().sum()
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
