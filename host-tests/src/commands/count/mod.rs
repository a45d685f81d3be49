//! Counts what a method costs on the target: executed instructions (exact), Cortex-M cycles (an **estimate** from
//! the published instruction timings), bytes of code and bytes of stack.

mod calls;
mod frame_profile;
pub mod goal;
mod image;
mod instruction;
mod pipeline;
mod profile;
mod record;
mod row;
#[cfg(test)]
mod silicon;
mod target;
pub mod timing;
mod trace;

pub use calls::{CallCosts, calls_of};
pub use frame_profile::{FrameProfile, Part, calls_in_next};
pub use image::{Function, Image};
pub use instruction::Instruction;
pub use pipeline::{Cost, ERROR_BAR, Pipeline};
pub use profile::{Profile, Spot};
pub use target::Target;
pub use trace::{Ended, Registers};

use std::io;
use std::path::PathBuf;
use std::process::ExitStatus;

use firmware::job::Request;

use crate::emulator::process::ProcessError;
use crate::emulator::qemu::QemuError;
use crate::emulator::toolchain::BuildError;

/// Name of the function, one per method, that is counted from its first instruction to its return.
const COUNTED: &str = "counted_steps";

/// Steps over which an average is fair to what a method does only now and then: a second of steps of 2^-8 s. In it
/// the rods of a regular motion pass several marks of the angle form; the direction form restores its lengths eight times.
pub const FULL_CYCLE: u32 = 256;
/// The rarest thing that a method does regularly, it does once in so many steps.
const REGULAR: u64 = 32;
/// Fewer would show little but the start, where momenta are zero and soft-float arithmetic takes short cuts.
const LEAST_STEPS: u64 = 4;
const AFFORDABLE_INSTRUCTIONS: u64 = 300_000;

/// Why something could not be counted.
#[derive(Debug, thiserror::Error)]
pub enum CountError {
    /// The program is not there or not an ELF file for ARM.
    #[error("{}: {reason}", path.display())]
    Unreadable {
        /// The program.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// An executed address lies outside the program.
    #[error("no code at {address:#x}")]
    NoCode {
        /// The address.
        address: u32,
    },
    /// The timing table has no row for an executed instruction.
    #[error("no timing for the instruction {first:04x} {second:04x} at {address:#x} in {function}")]
    UnknownInstruction {
        /// Where it is.
        address: u32,
        /// Its first halfword.
        first: u16,
        /// The halfword after that.
        second: u16,
        /// The function that has it, demangled.
        function: String,
    },
    /// The program has no such function.
    #[error("{}: no function {function}", path.display())]
    NoFunction {
        /// The program.
        path: PathBuf,
        /// What was asked for.
        function: String,
    },
    /// The name stands for several functions.
    #[error("{function} may be any of {number}, such as {one} and {another}")]
    Ambiguous {
        /// What was asked for.
        function: String,
        /// How many functions it may be.
        number: usize,
        /// The symbol of one.
        one: String,
        /// The symbol of another.
        another: String,
    },
    /// The program ended, or its time was up, before it came to the function.
    #[error("{function} was never called")]
    NotCalled {
        /// The function.
        function: String,
    },
    /// The program ended, or its time was up, within the first call.
    #[error("{function} was called and never returned")]
    NotReturned {
        /// The function.
        function: String,
    },
    /// The program is not where the board looks for one.
    #[error("never called: the program has nothing at {vectors:#x}, where {board} reads its vectors; see --on")]
    Elsewhere {
        /// The board.
        board: &'static str,
        /// Where its flash begins.
        vectors: u32,
    },
    /// The program stopped at an instruction that the processor lacks.
    #[error("{function} was never called: {instruction} at {address:#x} is no instruction of a {cpu}; see --on")]
    WrongCore {
        /// The function.
        function: String,
        /// The processor.
        cpu: &'static str,
        /// The instruction.
        instruction: &'static str,
        /// Where it is.
        address: u32,
    },
    /// The program ended by itself and says that it failed.
    #[error("the program failed after {calls} calls, {status}: {}", output.trim())]
    Failed {
        /// How QEMU ended.
        status: ExitStatus,
        /// Calls that had returned.
        calls: usize,
        /// What it had printed.
        output: String,
    },
    /// The program did not accept the request.
    #[error("{request}: {reason}")]
    Refused {
        /// The request.
        request: String,
        /// What the program said.
        reason: String,
    },
    /// QEMU's version is needed to know its options.
    #[error("cannot tell QEMU's version from {version:?}")]
    UnknownVersion {
        /// What it said.
        version: String,
    },
    /// QEMU's log broke off.
    #[error("QEMU's log: {source}")]
    Log {
        /// The system's reason.
        source: io::Error,
    },
    /// The program that measures does not compile.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The emulated board did not do what it should.
    #[error(transparent)]
    Qemu(#[from] QemuError),
    /// QEMU could not be run.
    #[error(transparent)]
    Process(#[from] ProcessError),
}

/// The cost of one step, on average over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepCost {
    /// Executed instructions.
    pub instructions: f64,
    /// Estimated cycles.
    pub cycles: f64,
    /// Those of the cycles that wait for a floating-point result or for the unit that makes one.
    pub stalls: f64,
    /// Bytes of the distinct instructions executed; literal pools are not among them.
    pub hot_bytes: u32,
    /// Bytes of all functions entered, with their literal pools and the paths not taken.
    pub code_bytes: u32,
    /// Bytes of stack from the call of the step loop on.
    pub stack_bytes: u32,
}

/// The steps to count so that the counting takes a few seconds: [`FULL_CYCLE`] of a cheap method, fewer of a costly one.
pub fn affordable_steps(target: &Target, request: &Request) -> Result<u32, CountError> {
    let one = Profile::of(target, &Request { stride: 1, ..*request })?.cost().instructions;
    let steps = (AFFORDABLE_INSTRUCTIONS / one.max(1)).clamp(LEAST_STEPS, FULL_CYCLE.into());
    Ok(if steps < REGULAR { steps } else { steps - steps % REGULAR } as u32)
}

/// The cost of one step of `request` on `target`, averaged over its steps.
///
/// A run of twice the steps minus a run of once the steps, so that calling and returning cancel.
pub fn step_cost(target: &Target, request: &Request) -> Result<StepCost, CountError> {
    let once = Profile::of(target, request)?;
    let twice = Profile::of(target, &Request { stride: 2 * request.stride, ..*request })?;
    let cost = twice.cost() - once.cost();
    let per_step = |total: u64| total as f64 / f64::from(request.stride);
    Ok(StepCost {
        instructions: per_step(cost.instructions),
        cycles: per_step(cost.cycles),
        stalls: per_step(cost.stalls),
        hot_bytes: twice.hot_bytes(),
        code_bytes: twice.functions(target.image()).map(|function| function.size).sum(),
        stack_bytes: twice.stack_bytes(),
    })
}
