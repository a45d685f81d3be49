//! How a profile is taken: of the counted function in a run of its own, or of a whole frame of an application.

use std::fs::File;
use std::{io, thread};

use firmware::job::Request;
use firmware::protocol::Frame;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use super::calls::{Calls, Stream};
use super::image::Image;
use super::profile::Profile;
use super::trace::{Ended, LIMIT, for_each_instruction};
use super::{COUNTED, CountError, Target};
use crate::emulator::boards::Core;
use crate::emulator::process::remove_on_interrupt;
use crate::emulator::qemu::Lockstep;

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
}

fn log(source: io::Error) -> CountError {
    CountError::Log { source }
}
