//! The loop of all programs of this crate: a motion is advanced and drawn. `cargo count --minimal`
//! counts the calls of [`advance`], and the bytes of each program.
#![no_std]

// A Cortex-M0+ has no long product. This one takes half the time of the compiler's own.
#[cfg(armv6m)]
#[path = "../../../firmware/src/board/cortex_m/long_product.rs"]
mod long_product;

use core::hint::black_box;

use cortex_m_semihosting::debug;
use double_pendulum::{Error, Form, Parameters, Pendulum, Run, State};

/// Returns a motion at its start: equal rods and bobs, let go at 0.5 rad, in steps of 1/256 s.
pub fn start<F: Form>() -> Result<Run<F>, Error> {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    pendulum.run(&State::at_rest(0.5, 0.5), 1.0 / 256.0)
}

/// Without a floating-point unit a step takes 40 to 140 times as many cycles.
pub const STEPS_IN_F32: u32 = if cfg!(target_abi = "eabihf") { 32 } else { 8 };

/// Computes motions from `start` of no step, of one step, and of `steps` more than one.
pub fn swing<F: Form, const TURNS: bool>(
    start: Result<Run<F, TURNS>, Error>,
    steps: u32,
    draw: impl Fn(&Run<F, TURNS>),
) -> ! {
    let frames = |start: Run<F, TURNS>| {
        for steps in [0, 1, 1 + steps] {
            let mut run = start;
            advance(&mut run, black_box(steps))?;
            draw(&run);
        }
        Ok(())
    };
    end(start.and_then(frames).map_err(drop))
}

pub fn end(outcome: Result<(), ()>) -> ! {
    debug::exit(outcome);
    loop {}
}

/// Advances the motion. The counter finds this function by its name.
#[inline(never)]
fn advance<F: Form, const TURNS: bool>(run: &mut Run<F, TURNS>, steps: u32) -> Result<(), Error> {
    run.advance(steps)
}

pub fn draw<F: Form, const TURNS: bool>(run: &Run<F, TURNS>) {
    black_box(run.directions());
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
