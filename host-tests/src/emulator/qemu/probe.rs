//! A board under a debugger: stopped at any place in its program, its memory open.

use std::ops::Range;

use super::QemuError;
use super::gdb::Debugger;
use super::machine::{Machine, Settings};

/// A register of the processor, with GDB's number of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// The stack pointer.
    Sp = 13,
    /// The link register.
    Lr = 14,
    /// The program counter.
    Pc = 15,
}

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

    /// Makes the processor go on elsewhere: the values of some registers. To be followed by [`run`](Self::run).
    pub fn divert(&mut self, registers: &[(Register, u32)]) -> Result<(), QemuError> {
        let set = |(register, value): &(Register, u32)| self.debugger.set(*register as u32, *value);
        registers.iter().try_for_each(set).map_err(|error| self.machine.explain(error))
    }

    /// Puts bytes into the memory.
    pub fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), QemuError> {
        self.debugger.write(address, bytes).map_err(|error| self.machine.explain(error))
    }

    /// Lets it run for good.
    pub fn run(&mut self) -> Result<&mut Machine, QemuError> {
        self.debugger.run()?;
        Ok(&mut self.machine)
    }

    /// The machine, for its link and its log.
    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }

    /// The bytes at these addresses.
    pub fn read(&mut self, addresses: Range<u32>) -> Result<Vec<u8>, QemuError> {
        self.debugger.read(addresses).map_err(|error| self.machine.explain(error))
    }
}
