//! The calls of a function in an executed stream: from its first instruction to its return, with all that it calls and that
//! interrupts it.

use std::collections::BTreeSet;
use std::time::Duration;

use anyhow::{Result, bail};

use super::Target;
use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::{Cost, Pipeline};
use super::profile::Profile;
use super::trace::{Ended, Registers};
use crate::console::progress::Progress;
use crate::emulator::boards::Core;

/// Every call of one of the functions that begin at some addresses.
#[derive(Debug)]
pub struct Calls<'a> {
    image: &'a Image,
    core: Core,
    entries: BTreeSet<u32>,
    running: Option<Call>,
    profile: Profile,
    ended: Vec<Cost>,
}

#[derive(Clone, Copy, Debug)]
struct Call {
    caller: Registers,
    stream: Stream,
    cost: Cost,
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
        Self { image, core, entries, running: None, profile: Profile::default(), ended: Vec::new() }
    }

    pub fn see(&mut self, registers: Registers) -> Result<()> {
        match &mut self.running {
            Some(call) => {
                let executed = call.stream.execute(&registers);
                self.profile.add(executed, call.caller.sp().saturating_sub(registers.sp()));
                call.cost += executed.2;
                if registers.pc() == call.caller.lr() & !1 && registers.sp() == call.caller.sp() {
                    self.ended.push(call.cost);
                    self.running = None;
                } else {
                    return call.stream.go_on(self.image, registers);
                }
            }
            None if self.entries.contains(&registers.pc()) => {
                let stream = Stream::begin(self.image, self.core, registers)?;
                self.running = Some(Call { caller: registers, stream, cost: Cost::default() });
            }
            None => {}
        }
        Ok(())
    }

    /// What each call that returned cost, in order.
    pub fn into_ended(self) -> Vec<Cost> {
        self.ended
    }

    pub fn into_profile(self) -> Profile {
        self.profile
    }
}

#[derive(Debug)]
pub struct CallCosts {
    pub function: Function,
    /// Each call that returned, in order; one at least, unless the program says that it failed.
    pub calls: Vec<Cost>,
    pub ended: Ended,
}

/// Counts the calls of `function` until the program on `target` ends or the time is up.
pub fn calls_of(target: &Target, function: &str, limit: Duration) -> Result<CallCosts> {
    let (image, core) = (target.image(), target.core());
    let function = image.function(function)?.clone();
    target.check_memory()?;
    let mut calls = Calls::of(image, core, BTreeSet::from([function.address]));
    let mut progress = Progress::start(&format!("counts the calls of {}", function.name));
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
        match unknown {
            _ if calls.running.is_some() => bail!("{name} was called and never returned"),
            Some((address, instruction)) => {
                let (instruction, cpu) = (instruction.row.name, target.board.cpu);
                bail!("{name} was never called: {instruction} at {address:#x} is no instruction of a {cpu}; see --on")
            }
            None => bail!("{name} was never called"),
        }
    }
    Ok(CallCosts { function, calls: calls.ended, ended })
}

/// Instructions between two words about them.
const TELL: u64 = 1 << 18;

/// Whether the processor has just entered an exception: the link register then holds no address.
fn is_exception(registers: &Registers) -> bool {
    (0xffff_ffe0..u32::MAX).contains(&registers.lr())
}
