//! Where the instructions and cycles of the counted function go.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::{io, thread};

use firmware::measure::Request;
use firmware::protocol::Frame;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::{Cost, Pipeline};
use super::trace::{Registers, for_each_line};
use super::{COUNTED, CountError, Target};
use crate::emulator::boards::Core;
use crate::emulator::process::remove_on_interrupt;
use crate::emulator::qemu::Lockstep;

/// An instruction of the program and what all its executions together cost.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The instruction.
    pub instruction: Instruction,
    /// How often it was executed and what that cost.
    pub cost: Cost,
}

/// What one run of the counted function executed.
#[derive(Clone, Debug, Default)]
pub struct Profile {
    spots: BTreeMap<u32, Spot>,
    stack_bytes: u32,
}

impl Profile {
    /// Runs `request` on `target` and profiles the counted function, all calls of it together.
    pub fn of(target: &Target, request: &Request) -> Result<Self, CountError> {
        let image = target.image();
        let entries: BTreeSet<_> = image.functions_named(COUNTED).map(|function| function.address).collect();
        let mut profile = Self::default();
        let mut call: Option<Call> = None;
        target.trace(request, |registers| {
            match &mut call {
                Some(running) => {
                    profile.execute(&mut running.stream, registers.pc);
                    profile.stack_bytes = profile.stack_bytes.max(running.caller.sp.saturating_sub(registers.sp));
                    if running.has_returned(registers) {
                        call = None;
                    } else {
                        running.stream.next = (registers.pc, image.instruction_at(registers.pc)?);
                    }
                }
                None if entries.contains(&registers.pc) => {
                    let first = (registers.pc, image.instruction_at(registers.pc)?);
                    call = Some(Call {
                        caller: registers,
                        stream: Stream { next: first, pipeline: Pipeline::new(target.core()) },
                    });
                }
                None => {}
            }
            Ok(())
        })?;
        if profile.spots.is_empty() { Err(CountError::NotReached) } else { Ok(profile) }
    }

    /// Lets `board` run to its next frame and profiles all that it executes for it.
    pub fn of_frame(board: &mut Lockstep, image: &Image, core: Core) -> Result<(Frame, Self), CountError> {
        let folder = tempfile::tempdir().map_err(log)?;
        remove_on_interrupt(folder.path());
        let path = folder.path().join("log");
        mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR).map_err(|error| log(error.into()))?;
        thread::scope(|scope| {
            // The pipe opens for QEMU once it is open here, and the other way about.
            let profile = scope.spawn(|| Self::of_log(File::open(&path).map_err(log)?, image, core));
            let frame = board.next_frame_logged(&path)?;
            let profile = profile.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            Ok((frame, profile?))
        })
    }

    fn of_log(file: File, image: &Image, core: Core) -> Result<Self, CountError> {
        let mut profile = Self::default();
        let mut stream: Option<Stream> = None;
        for_each_line(file, |line| {
            let Some(Registers { pc, .. }) = Registers::parse(line) else { return Ok(()) };
            let next = (pc, image.instruction_at(pc)?);
            match &mut stream {
                Some(stream) => {
                    profile.execute(stream, pc);
                    stream.next = next;
                }
                None => stream = Some(Stream { next, pipeline: Pipeline::new(core) }),
            }
            Ok(())
        })?;
        if profile.spots.is_empty() { Err(CountError::NotReached) } else { Ok(profile) }
    }

    /// The pending instruction of `stream` has been executed and led to `pc`.
    fn execute(&mut self, stream: &mut Stream, pc: u32) {
        let (address, instruction) = stream.next;
        let branches = pc != address + instruction.size();
        let cost = stream.pipeline.execute(instruction, branches);
        let spot = self.spots.entry(address).or_insert(Spot { instruction, cost: Cost::default() });
        spot.cost += cost;
    }

    /// The cost of it all.
    pub fn cost(&self) -> Cost {
        let mut total = Cost::default();
        self.spots.values().for_each(|spot| total += spot.cost);
        total
    }

    /// Every instruction executed, by address.
    pub fn spots(&self) -> impl Iterator<Item = (u32, &Spot)> {
        self.spots.iter().map(|(address, spot)| (*address, spot))
    }

    /// The functions entered.
    pub fn functions<'a>(&self, image: &'a Image) -> impl Iterator<Item = &'a Function> {
        let functions: BTreeSet<_> = self.spots.keys().filter_map(|&address| image.function_at(address)).collect();
        functions.into_iter()
    }

    /// Bytes of the distinct instructions executed.
    pub fn hot_bytes(&self) -> u32 {
        self.spots.values().map(|spot| spot.instruction.size()).sum()
    }

    /// The deepest the stack pointer went below where the caller had it.
    pub fn stack_bytes(&self) -> u32 {
        self.stack_bytes
    }
}

/// A call of the counted function that is going on.
struct Call {
    /// The registers at its entry.
    caller: Registers,
    stream: Stream,
}

/// Instructions as they are executed.
struct Stream {
    /// The instruction about to be executed.
    next: (u32, Instruction),
    pipeline: Pipeline,
}

fn log(source: io::Error) -> CountError {
    CountError::Log { source }
}

impl Call {
    fn has_returned(&self, registers: Registers) -> bool {
        registers.pc == self.caller.lr & !1 && registers.sp == self.caller.sp
    }
}
