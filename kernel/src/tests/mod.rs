//! The equations, held against the book, against each other and against their own symmetries. What fails says which equation
//! is off, and by how much. They stand here and not in `kernel/tests`, so that cargo runs them with the unit tests: if one of
//! those fails, it does not come to the programs of that folder.

mod added_method;
mod forms;
mod golden;
mod hamilton;
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

/// The equations in the order of [`double_pendulum::Pendulum::derivatives`].
const EQUATIONS: [&str; 4] = ["w1", "w2", "p1'", "p2'"];

/// `value`, named `name`, is `exact` within `tolerance` of `scale`; `of` is the case.
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
