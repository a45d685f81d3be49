//! How a whole frame of an application is counted: all of it, what shows it, or the calls of a function.

use std::collections::BTreeSet;
use std::fs::File;
use std::thread;

use anyhow::Result;
use cycles::{Calls, Core, Cost, Image, Stream, for_each_instruction};
use firmware::protocol::Frame;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use crate::emulator::process::remove_on_interrupt;
use crate::emulator::qemu::Lockstep;

/// The functions that show a frame, the module's path and the name: they draw it, and bring it to the panel and over the link. They
/// are not inlined, and once in a program.
const SHOWING: [(&str, &str); 7] = [
    ("firmware::graphics::fade_layer::", "::add"),
    ("firmware::graphics::fade_layer::", "::fade"),
    ("firmware::graphics::canvas::", "::scroll"),
    ("firmware::app::player::", "::draw"),
    ("firmware::app::player::", "::check"),
    ("firmware::app::App", "::show"),
    ("firmware::board::cortex_m::retained::", "keep"),
];

/// What a frame executed.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameProfile {
    pub whole: Cost,
    /// In the functions that show it, with all that they call.
    pub showing: Cost,
}

impl FrameProfile {
    /// Lets `board` run to its next frame and profiles all that it executes for it.
    pub fn of_next(board: &mut Lockstep, image: &Image, core: Core) -> Result<(Frame, Self)> {
        let showing = SHOWING.into_iter().map(|(module, name)| address(image, module, name));
        let showing = showing.collect::<Result<BTreeSet<_>>>()?;
        next_frame_read(board, |mut log| {
            let (mut profile, mut stream) = (Self::default(), Stream::of(image, core));
            // Where the outermost function that shows returns to: the address and the stack pointer.
            let mut shows_until = None;
            for_each_instruction(&mut log, &mut |registers| {
                let cost = stream.see(registers)?.map(|(.., cost)| cost).unwrap_or_default();
                profile.whole += cost;
                if shows_until.is_some() {
                    profile.showing += cost;
                }
                shows_until = shows_until.filter(|place| *place != (registers.pc(), registers.sp()));
                if shows_until.is_none() && showing.contains(&registers.pc()) {
                    shows_until = Some((registers.lr() & !1, registers.sp()));
                }
                Ok(())
            })?;
            Ok(profile)
        })
    }
}

/// Where a function of an application begins; the error names one that it lacks.
fn address(image: &Image, module: &str, name: &str) -> Result<u32> {
    // One version of the compiler writes <path::Type>::name, the next path::Type::name.
    let is_it = |path: &str| path.trim_start_matches('<').starts_with(module) && path.ends_with(name);
    let function = image.functions_named(name).find(|function| is_it(&function.name));
    function.map(|function| function.address).ok_or_else(|| image.lacks(&format!("{module}..{name}")))
}

/// Lets `board` run to its next frame and counts the calls of `function` on the way, those that return.
pub fn calls_in_next(board: &mut Lockstep, image: &Image, core: Core, function: &str) -> Result<(Frame, Vec<Cost>)> {
    let entry = BTreeSet::from([image.function(function)?.address]);
    next_frame_read(board, |mut log| {
        let mut calls = Calls::of(image, core, entry);
        for_each_instruction(&mut log, &mut |registers| calls.see(registers))?;
        Ok(calls.ended)
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
