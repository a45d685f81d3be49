//! Steps of the kernel for tests that make millions of them.
//!
//! The kernel's functions are generic, so a caller compiles them with its own settings. The tests
//! are not optimised. This package is.

use double_pendulum::{Pendulum, Real, State};

/// A number type, `f32` or `f64`, whose steps of RK4 are compiled in this package.
pub trait Step: Real {
    /// Returns the state after a step of RK4: [`Pendulum::step`].
    fn step(pendulum: &Pendulum<Self>, state: &State<Self>, dt: Self) -> State<Self>;
}

impl Step for f32 {
    fn step(pendulum: &Pendulum<Self>, state: &State<Self>, dt: Self) -> State<Self> {
        pendulum.step(state, dt)
    }
}

impl Step for f64 {
    fn step(pendulum: &Pendulum<Self>, state: &State<Self>, dt: Self) -> State<Self> {
        pendulum.step(state, dt)
    }
}
