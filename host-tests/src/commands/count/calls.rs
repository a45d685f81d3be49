//! The calls of a function in an executed stream: from its first instruction to its return, with all that it calls and that
//! interrupts it.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use anyhow::{Result, bail, ensure};
use firmware::job::Request;

use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::{Cost, Pipeline};
use super::trace::{Ended, LIMIT, Registers};
use super::{COUNTED, Target};
use crate::console::progress::Progress;
use crate::emulator::boards::Core;
use crate::emulator::process::timed_out;

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
pub(super) struct Stream {
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

    /// Runs `request` on `target`, all calls of the counted function together.
    pub fn counted(target: &'a Target, request: &Request) -> Result<Self> {
        let entries = target.image().functions_named(COUNTED).map(|function| function.address).collect();
        let mut calls = Self::of(target.image(), target.core(), entries);
        match target.trace(&request.to_string(), LIMIT, |registers| calls.see(registers))? {
            Ended { status: Some(status), .. } if status.success() => {}
            Ended { status: None, .. } => bail!(timed_out(&target.elf.display().to_string(), LIMIT)),
            Ended { output, .. } => bail!("{request}: {}", output.trim()),
        }
        ensure!(!calls.ended.is_empty(), "{COUNTED} was never called");
        Ok(calls)
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

/// Counts the calls of `function` until the program on `target` ends or the time is up: the function, what each call that returned
/// cost, one at least unless the program says that it failed, and how it ended.
pub fn calls_of<'a>(target: &'a Target, function: &str, limit: Duration) -> Result<(&'a Function, Vec<Cost>, Ended)> {
    let (image, core) = (target.image(), target.core());
    let function = image.function(function)?;
    target.check_memory()?;
    let mut calls = Calls::of(image, core, BTreeSet::from([function.address]));
    let progress = Progress::start(&format!("counts the calls of {}", function.name));
    let (mut instructions, mut before, mut unknown) = (0_u64, Registers::default(), None);
    let ended = target.trace("", limit, |registers| {
        instructions += 1;
        if instructions % TELL == 0 {
            progress.alive(Some(&format!("{} calls, {instructions} instructions", calls.ended.len())));
        }
        // An exception right after an instruction that the processor does not have is for the lack of it.
        if is_exception(&registers) && !is_exception(&before) {
            let instruction = image.instruction_at(before.pc()).ok();
            unknown = unknown.or(instruction.filter(|one| one.is_missing_on(core)).map(|one| (before.pc(), one)));
        }
        before = registers;
        calls.see(registers)
    })?;
    let name = &function.name;
    let failed = ended.status.is_some_and(|status| !status.success());
    if calls.ended.is_empty() && !failed {
        ensure!(calls.running.is_none(), "{name} was called and never returned");
        let Some((address, instruction)) = unknown else { bail!("{name} was never called") };
        let (instruction, cpu) = (instruction.row.name, target.board.cpu);
        bail!("{name} was never called: {instruction} at {address:#x} is no instruction of a {cpu}; see --on");
    }
    Ok((function, calls.ended, ended))
}

/// Instructions between two words about them.
const TELL: u64 = 1 << 18;

/// Whether the processor has just entered an exception: the link register then holds no address.
fn is_exception(registers: &Registers) -> bool {
    (0xffff_ffe0..u32::MAX).contains(&registers.lr())
}
