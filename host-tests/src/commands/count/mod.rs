//! Counts what a method costs on the target: executed instructions (exact), Cortex-M cycles (an **estimate** from
//! the published instruction timings), bytes of code and bytes of stack.

mod application;
mod command;
mod trace;

pub use application::{FrameProfile, prices};
pub use command::{CountOptions, run};
pub use trace::Target;

use anyhow::Result;
use firmware::job::Request;
use trace::counted;

/// Name of the function, one per method, that is counted from its first instruction to its return.
const COUNTED: &str = "counted_steps";

/// Steps over which an average is fair to what a method does only now and then: a second of steps of 2^-8 s, in which the
/// direction form restores its lengths eight times.
pub const FULL_CYCLE: u32 = 256;
/// The rarest thing that a method does regularly, it does once in so many steps.
const REGULAR: u64 = 32;
/// Fewer would show little but the start, where momenta are zero and soft-float arithmetic takes short cuts.
const LEAST_STEPS: u64 = 4;
const AFFORDABLE_INSTRUCTIONS: u64 = 300_000;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCost {
    pub steps: u32,
    pub instructions: f64,
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
pub fn affordable_steps(target: &Target, request: &Request) -> Result<u32> {
    let one = counted(
        target,
        &Request {
            stride: 1,
            samples: 1,
            ..*request
        },
    )?
    .cost()
    .instructions;
    let steps = (AFFORDABLE_INSTRUCTIONS / one.max(1)).clamp(LEAST_STEPS, FULL_CYCLE.into());
    Ok(if steps < REGULAR {
        steps
    } else {
        steps - steps % REGULAR
    } as u32)
}

/// The cost of one step of `request` on `target`, averaged over as many steps as can be afforded.
pub fn affordable_cost(target: &Target, request: &Request) -> Result<StepCost> {
    step_cost(
        target,
        &Request {
            stride: affordable_steps(target, request)?,
            ..*request
        },
    )
}

/// The cost of one step of `request` on `target`, averaged over the steps after the first; as many as to its first sample.
///
/// A run of one step more minus a run of one step, so that calling and returning cancel.
pub fn step_cost(target: &Target, request: &Request) -> Result<StepCost> {
    let steps = request.stride;
    let run = |stride| {
        counted(
            target,
            &Request {
                stride,
                samples: 1,
                ..*request
            },
        )
    };
    let (calling, whole) = (run(1)?.cost(), run(1 + steps)?);
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
