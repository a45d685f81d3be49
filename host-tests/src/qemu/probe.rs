//! A board under a debugger: stopped at any place in its program, its memory open.

use std::ops::Range;

use super::QemuError;
use super::gdb::Debugger;
use super::machine::{Machine, Settings};

/// A board that runs from one place in its program to the next, and stands still between.
#[derive(Debug)]
pub struct Probe {
    machine: Machine,
    debugger: Debugger,
}

impl Probe {
    /// Starts a board, which stands still at its first instruction.
    pub fn start(settings: &Settings) -> Result<Self, QemuError> {
        let (machine, debugger) = Machine::start_stopped(settings)?;
        Ok(Self { machine, debugger: Debugger::new(debugger, &[])? })
    }

    /// Runs until the instruction at this address is about to be executed.
    pub fn run_to(&mut self, address: u32) -> Result<(), QemuError> {
        self.debugger.run_to(address).map_err(|error| self.machine.explain(error))
    }

    /// The bytes at these addresses.
    pub fn read(&mut self, addresses: Range<u32>) -> Result<Vec<u8>, QemuError> {
        self.debugger.read(addresses).map_err(|error| self.machine.explain(error))
    }
}
