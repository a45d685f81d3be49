//! The classical Runge-Kutta method of order 4 (RK4), for any system of first-order equations.
//!
//! Scenes are drawn by RK4 steps that are written out for their numbers: those of `f32` are in
//! `rk4_direction.rs`, those of fixed point in `rk4_fixed32.rs`.

use crate::numbers::Real;
use crate::pendulum::{Pendulum, State};

/// Computes one step of RK4 for z' = f(z): returns the state a time `dt` after `z`.
///
/// ```text
/// Y1 = dt f(z)      Y2 = dt f(z + Y1/2)      Y3 = dt f(z + Y2/2)      Y4 = dt f(z + Y3)
///
/// z(t + dt) = z + (Y1 + 2 Y2 + 2 Y3 + Y4)/6
/// ```
///
/// The error is O(dt^5) after one step, and O(dt^4) after a fixed time. A negative `dt` steps
/// backwards. NaN or infinity in `z` or `dt` gives NaN or infinity.
#[must_use]
pub fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
    let half = dt * R::HALF;
    let k1 = f(z);
    let k2 = f(&advanced(z, half, &k1));
    let k3 = f(&advanced(z, half, &k2));
    let k4 = f(&advanced(z, dt, &k3));
    let sixth = dt / R::from_f64(6.0);
    core::array::from_fn(|i| z[i] + sixth * (k1[i] + R::TWO * (k2[i] + k3[i]) + k4[i]))
}

fn advanced<R: Real, const N: usize>(z: &[R; N], dt: R, k: &[R; N]) -> [R; N] {
    core::array::from_fn(|i| z[i] + dt * k[i])
}

impl<R: Real> Pendulum<R> {
    /// Computes one step of RK4: returns the state a time `dt`, s, after `state`.
    ///
    /// A negative `dt` steps backwards. Angles are not wrapped. A step that is too long for the
    /// motion gives a meaningless state, which in the end is infinite or NaN: call
    /// [`check_step`](Self::check_step) or [`admissible_step`](Self::admissible_step) before the
    /// first step, and [`State::finite`] after each.
    #[must_use]
    pub fn step(&self, state: &State<R>, dt: R) -> State<R> {
        step(|z| self.derivatives(z), &(*state).into(), dt).into()
    }
}
