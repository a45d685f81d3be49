//! How a whole frame of an application is counted: a profile by the parts of the work, or the calls of a function.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::thread;

use anyhow::Result;
use firmware::protocol::Frame;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use super::calls::{Calls, Stream};
use super::image::Image;
use super::pipeline::Cost;
use super::profile::Profile;
use super::trace::{Registers, for_each_instruction};
use crate::emulator::boards::Core;
use crate::emulator::process::remove_on_interrupt;
use crate::emulator::qemu::Lockstep;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The scene's tick, without what it draws.
    Motion,
    /// The frame's pixels.
    Drawing,
    /// The frame in numbers, to the panel and over the link; what is kept in case it is the last.
    Sending,
    /// The search for a plan, which takes what frames leave.
    Planning,
    /// The clock, the buttons, what is received.
    Rest,
}

/// The functions that the parts begin with: the module's path and the name. They are not inlined, and once in a program.
const BEGINNINGS: [(&str, &str, Part); 9] = [
    ("firmware::app::player::", "::tick", Part::Motion),
    ("firmware::graphics::fade_layer::", "::add", Part::Drawing),
    ("firmware::graphics::fade_layer::", "::fade", Part::Drawing),
    ("firmware::graphics::canvas::", "::scroll", Part::Drawing),
    ("firmware::app::player::", "::draw", Part::Drawing),
    ("firmware::app::player::", "::check", Part::Sending),
    ("firmware::app::App", "::show", Part::Sending),
    ("firmware::board::cortex_m::retained::", "keep", Part::Sending),
    ("firmware::motion::planner::", "::work", Part::Planning),
];

/// What a frame executed, by parts: each instruction belongs to the innermost of the functions above that is at work.
#[derive(Clone, Debug, Default)]
pub struct FrameProfile {
    parts: BTreeMap<Part, Profile>,
}

impl FrameProfile {
    /// Lets `board` run to its next frame and profiles all that it executes for it.
    pub fn of_next(board: &mut Lockstep, image: &Image, core: Core) -> Result<(Frame, Self)> {
        next_frame_read(board, |log| Self::of_log(log, image, core))
    }

    fn of_log(file: File, image: &Image, core: Core) -> Result<Self> {
        let (mut profile, mut parts) = (Self::default(), Parts::of(image)?);
        let mut stream: Option<(Stream, Part)> = None;
        for_each_instruction(file, |registers| {
            match &mut stream {
                Some((stream, part)) => {
                    profile.parts.entry(*part).or_default().add(stream.execute(&registers), 0);
                    stream.go_on(image, registers)?;
                    *part = parts.see(&registers);
                }
                None => stream = Some((Stream::begin(image, core, registers)?, parts.see(&registers))),
            }
            Ok(())
        })?;
        Ok(profile)
    }

    pub fn cost(&self, part: Part) -> Cost {
        self.parts.get(&part).map_or_else(Cost::default, Profile::cost)
    }

    pub fn whole(&self) -> Cost {
        let mut whole = Cost::default();
        self.parts.values().for_each(|part| whole += part.cost());
        whole
    }
}

/// Lets `board` run to its next frame and counts the calls of `function` on the way, those that return.
pub fn calls_in_next(board: &mut Lockstep, image: &Image, core: Core, function: &str) -> Result<(Frame, Vec<Cost>)> {
    let entry = BTreeSet::from([image.function(function)?.address]);
    next_frame_read(board, |log| {
        let mut calls = Calls::of(image, core, entry);
        for_each_instruction(log, |registers| calls.see(registers))?;
        Ok(calls.into_ended())
    })
}

/// Lets `board` run to its next frame and `read` the log of what it executes.
fn next_frame_read<T: Send>(board: &mut Lockstep, read: impl FnOnce(File) -> Result<T> + Send) -> Result<(Frame, T)> {
    let folder = tempfile::tempdir()?;
    remove_on_interrupt(folder.path());
    let path = folder.path().join("log");
    mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR)?;
    thread::scope(|scope| {
        // The pipe opens for QEMU once it is open here, and the other way about.
        let reader = scope.spawn(|| read(File::open(&path)?));
        let frame = board.next_frame_logged(&path)?;
        let read = reader.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        Ok((frame, read?))
    })
}

struct Parts {
    beginnings: BTreeMap<u32, Part>,
    /// The parts at work, each with where its function returns to: the address and the stack pointer.
    running: Vec<(Part, u32, u32)>,
}

impl Parts {
    /// Of an application; the error names a function that it lacks.
    fn of(image: &Image) -> Result<Self> {
        let address = |(module, name, part): (&str, &str, Part)| {
            // One version of the compiler writes <path::Type>::name, the next path::Type::name.
            let is_it = |path: &str| path.trim_start_matches('<').starts_with(module) && path.ends_with(name);
            let function = image.functions_named(name).find(|function| is_it(&function.name));
            function.map(|function| (function.address, part)).ok_or_else(|| image.lacks(&format!("{module}..{name}")))
        };
        Ok(Self { beginnings: BEGINNINGS.into_iter().map(address).collect::<Result<_, _>>()?, running: Vec::new() })
    }

    /// The part to which the instruction belongs that these registers are before.
    fn see(&mut self, registers: &Registers) -> Part {
        let here = (registers.pc(), registers.sp());
        while self.running.last().is_some_and(|(_, address, sp)| (*address, *sp) == here) {
            self.running.pop();
        }
        if let Some(part) = self.beginnings.get(&registers.pc()) {
            self.running.push((*part, registers.lr() & !1, registers.sp()));
        }
        self.running.last().map_or(Part::Rest, |(part, ..)| *part)
    }
}
