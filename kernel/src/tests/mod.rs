//! Tests of the equations: compared with the book, with each other and with their own symmetries.
//!
//! They are not in `kernel/tests`, because cargo would not run that folder if a unit test fails.

mod forms;
mod golden;
mod hamilton;
mod integrators;
mod lagrange;
mod random;
mod refusals;
mod runs;
mod small_oscillations;
mod symmetries;
mod tolerances;
mod trigonometry;

use core::fmt::{Debug, Display};

use double_pendulum::Real;

const EQUATIONS: [&str; 4] = ["w1", "w2", "p1'", "p2'"];

#[track_caller]
fn assert_near<R: Real>(
    name: impl Display,
    value: R,
    exact: R,
    scale: R,
    tolerance: f64,
    of: &impl Debug,
) {
    let [value, exact, scale] = [value, exact, scale].map(R::to_f64);
    let error = (value - exact).abs();
    assert!(
        error <= tolerance * scale.abs(),
        "{name} is off by {error:.2e}: {value} instead of {exact}; {of:?}"
    );
}
