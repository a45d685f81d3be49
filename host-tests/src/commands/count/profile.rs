//! Where the instructions and cycles of the counted function go.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::{io, thread};

use firmware::job::Request;
use firmware::protocol::Frame;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use super::calls::{Calls, Stream};
use super::image::{Function, Image};
use super::instruction::Instruction;
use super::pipeline::Cost;
use super::trace::{Ended, LIMIT, for_each_instruction};
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
        let entries = image.functions_named(COUNTED).map(|function| function.address).collect();
        let mut calls = Calls::of(image, target.core(), entries);
        let request = request.to_string();
        match target.trace(&request, LIMIT, |registers| calls.see(registers))? {
            Ended { success: true, .. } => calls.into_profile().executed(),
            Ended { output, .. } => Err(CountError::Refused { request, reason: output.trim().to_owned() }),
        }
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
        for_each_instruction(file, |registers| {
            match &mut stream {
                Some(stream) => {
                    profile.add(stream.execute(&registers), 0);
                    stream.go_on(image, registers)?;
                }
                None => stream = Some(Stream::begin(image, core, registers)?),
            }
            Ok(())
        })?;
        profile.executed()
    }

    /// An instruction that has been executed at an address, what it cost, and how deep the stack is.
    pub(super) fn add(&mut self, (address, instruction, cost): (u32, Instruction, Cost), stack_bytes: u32) {
        let spot = self.spots.entry(address).or_insert(Spot { instruction, cost: Cost::default() });
        spot.cost += cost;
        self.stack_bytes = self.stack_bytes.max(stack_bytes);
    }

    /// Itself, if anything was executed.
    fn executed(self) -> Result<Self, CountError> {
        if self.spots.is_empty() { Err(CountError::NotCalled { function: COUNTED.to_owned() }) } else { Ok(self) }
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

fn log(source: io::Error) -> CountError {
    CountError::Log { source }
}
