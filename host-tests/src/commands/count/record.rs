//! How a profile is taken of the counted function, in a run of its own.

use firmware::job::Request;

use super::calls::Calls;
use super::profile::Profile;
use super::trace::{Ended, LIMIT};
use super::{COUNTED, CountError, Target};
use crate::emulator::process::ProcessError;

impl Profile {
    /// Runs `request` on `target` and profiles the counted function, all calls of it together.
    pub fn of(target: &Target, request: &Request) -> Result<Self, CountError> {
        let image = target.image();
        let entries = image.functions_named(COUNTED).map(|function| function.address).collect();
        let mut calls = Calls::of(image, target.core(), entries);
        let request = request.to_string();
        match target.trace(&request, LIMIT, |registers| calls.see(registers))? {
            Ended { status: Some(status), .. } if status.success() => calls.into_profile().executed(),
            Ended { status: None, .. } => Err(ProcessError::TimedOut(target.elf.display().to_string(), LIMIT).into()),
            Ended { output, .. } => Err(CountError::Refused { request, reason: output.trim().to_owned() }),
        }
    }
}
