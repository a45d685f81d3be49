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

/// The function, one per method, whose calls are counted.
const COUNTED: &str = "counted_steps";

/// The direction form restores the lengths of its directions eight times in it.
pub const FULL_CYCLE: u32 = 256;
/// The period, in steps, of the rarest thing that a method does regularly.
const REGULAR: u64 = 32;
/// The smallest number of steps. Fewer would show mainly the start, where momenta are zero and
/// soft-float arithmetic takes shortcuts.
const LEAST_STEPS: u64 = 4;
/// The instructions that are counted for a row of a table.
const AFFORDABLE: u64 = 300_000;

/// The cost of one step. Instructions, cycles and stalls are averages over `steps` steps; the sizes
/// are of the whole run, with the first step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCost {
    pub steps: u32,
    /// Exact.
    pub instructions: f64,
    /// Estimated, including the stalls.
    pub cycles: f64,
    /// The cycles that wait for a floating-point result or for the floating-point unit.
    pub stalls: f64,
    /// The distinct executed instructions, without literal pools.
    pub hot_bytes: u32,
    /// The entered functions, with their literal pools and the paths that were not taken.
    pub code_bytes: u32,
    pub stack_bytes: u32,
}

/// Returns the number of steps that can be counted in about a second. It depends only on the number
/// of executed instructions, not on the host.
pub fn affordable_steps(target: &Target, request: &Request) -> Result<u32> {
    Ok(affordable(one_step(target, request)?, AFFORDABLE))
}

fn affordable(one: Cost, instructions: u64) -> u32 {
    // A multiple of the period, so that the rare work has its true share of the average.
    let steps = instructions / one.instructions.max(1);
    let steps = steps.clamp(LEAST_STEPS, FULL_CYCLE.into());
    let steps = if steps < REGULAR {
        steps
    } else {
        steps - steps % REGULAR
    };
    steps as u32
}

pub fn affordable_cost(target: &Target, request: &Request) -> Result<StepCost> {
    cost_within(AFFORDABLE, target, request)
}

/// Returns the cost of one step, averaged over about this many instructions.
fn cost_within(instructions: u64, target: &Target, request: &Request) -> Result<StepCost> {
    let one = one_step(target, request)?;
    cost_after(one, target, request, affordable(one, instructions))
}

/// Returns the cost of one step, averaged over `request.stride` steps after the first. It is the
/// difference between two runs, so that the costs of the call and the return cancel.
pub fn step_cost(target: &Target, request: &Request) -> Result<StepCost> {
    cost_after(one_step(target, request)?, target, request, request.stride)
}

fn one_step(target: &Target, request: &Request) -> Result<Cost> {
    Ok(counted_run(target, request, 1)?.cost())
}

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

fn cost_after(calling: Cost, target: &Target, request: &Request, steps: u32) -> Result<StepCost> {
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
