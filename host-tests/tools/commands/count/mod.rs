//! Counts the costs of a method on the target: executed instructions (exact), Cortex-M cycles (an
//! **estimate** from the published instruction timings), bytes of code and bytes of stack.

mod application;
mod command;
mod minimal;
mod trace;

pub use application::{FrameProfile, prices};
pub use command::{CountOptions, run};
pub use minimal::{Minimal, MinimalPrices, Program, table, table_in_readme};
pub use trace::Target;

use anyhow::Result;
use cycles::{Calls, Cost};
use firmware::job::Request;
use trace::counted;

/// The name of the function, one per method, whose calls are counted from the first instruction to
/// the return.
const COUNTED: &str = "counted_steps";

/// The number of steps whose average includes everything that a method does rarely. It is a second
/// of steps of 2^-8 s. The direction form restores the lengths of its directions eight times in it.
pub const FULL_CYCLE: u32 = 256;
/// The period, in steps, of the rarest thing that a method does regularly.
const REGULAR: u64 = 32;
/// The smallest number of steps. Fewer would show mainly the start, where momenta are zero and
/// soft-float arithmetic takes shortcuts.
const LEAST_STEPS: u64 = 4;
/// The number of instructions that QEMU logs in a few seconds.
const AFFORDABLE_INSTRUCTIONS: u64 = 300_000;

/// The cost of one step of a method on a target. Instructions, cycles and stalls are averages over
/// `steps` steps; the sizes are of the whole run, with the first step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCost {
    /// The number of steps that the averages are over, all after the first step.
    pub steps: u32,
    /// Executed instructions per step (exact).
    pub instructions: f64,
    /// Cycles per step (estimated), including the stalls.
    pub cycles: f64,
    /// The cycles per step that wait for a floating-point result or for the floating-point unit; 0
    /// without such a unit.
    pub stalls: f64,
    /// The size of the distinct executed instructions, without literal pools, in bytes.
    pub hot_bytes: u32,
    /// The size of all entered functions, with their literal pools and the paths that were not
    /// taken, in bytes.
    pub code_bytes: u32,
    /// The stack used from the call of the step loop, in bytes.
    pub stack_bytes: u32,
}

/// Runs one step in QEMU and returns the number of steps that can be counted in a few seconds:
/// [`FULL_CYCLE`] for a cheap method, fewer for an expensive one, at least 4. From 32 on it is a
/// multiple of 32. It depends only on the number of executed instructions, not on the host.
///
/// The method, the pendulum and the step size are those of `request`; its numbers of steps and
/// samples are ignored. An error means that QEMU fails or runs for half an hour, that the program
/// refuses the request, that it does not call `counted_steps` ([`Target::of`]), or that it executes
/// an instruction without a known timing there.
pub fn affordable_steps(target: &Target, request: &Request) -> Result<u32> {
    Ok(affordable(one_step(target, request)?.instructions))
}

/// Returns the number of steps that can be counted in a few seconds if one takes this number of
/// instructions.
fn affordable(one: u64) -> u32 {
    // A multiple of the period, so that the rare work has its true share of the average.
    let steps = (AFFORDABLE_INSTRUCTIONS / one.max(1)).clamp(LEAST_STEPS, FULL_CYCLE.into());
    let steps = if steps < REGULAR {
        steps
    } else {
        steps - steps % REGULAR
    };
    steps as u32
}

/// Returns the cost of one step of `request` on `target`, averaged over the number of steps that
/// can be counted in a few seconds. `request` and errors are as in [`affordable_steps`].
pub fn affordable_cost(target: &Target, request: &Request) -> Result<StepCost> {
    let calling = one_step(target, request)?;
    cost_after(calling, target, request, affordable(calling.instructions))
}

/// Returns the cost of one step of `request` on `target`, averaged over `request.stride` steps
/// after the first; `stride` must be from 1 to 2^32 - 2, which is not checked (0 makes the averages
/// NaN), and `samples` is ignored. Errors are as in [`affordable_steps`].
///
/// It is the difference between a run of `stride` + 1 steps and a run of one step, so that the
/// costs of the call and the return cancel.
pub fn step_cost(target: &Target, request: &Request) -> Result<StepCost> {
    cost_after(one_step(target, request)?, target, request, request.stride)
}

/// Returns the cost of a run of one step, including its call.
fn one_step(target: &Target, request: &Request) -> Result<Cost> {
    Ok(counted_run(target, request, 1)?.cost())
}

/// Returns the calls of a run of this number of steps.
fn counted_run<'a>(target: &'a Target, request: &Request, stride: u32) -> Result<Calls<'a>> {
    counted(
        target,
        &Request {
            stride,
            samples: 1,
            ..*request
        },
    )
}

/// Returns the cost of one step, averaged over `steps` steps after the first. `calling` is the cost
/// of a run of one step.
fn cost_after(calling: Cost, target: &Target, request: &Request, steps: u32) -> Result<StepCost> {
    // The difference of the two runs is the cost of `steps` steps.
    let whole = counted_run(target, request, 1 + steps)?;
    let all = whole.cost();
    let per_step = |all: u64, calling: u64| all.saturating_sub(calling) as f64 / f64::from(steps);
    Ok(StepCost {
        steps,
        instructions: per_step(all.instructions, calling.instructions),
        cycles: per_step(all.cycles, calling.cycles),
        stalls: per_step(all.stalls, calling.stalls),
        hot_bytes: whole.hot_bytes(),
        code_bytes: whole.code_bytes(),
        stack_bytes: whole.stack_bytes,
    })
}
