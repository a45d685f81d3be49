//! The classical Runge-Kutta method of order 4 (RK4), for any system of first-order equations and
//! for Hamilton's equations in angles and momenta.

use core::fmt::Debug;

use super::Form;
use crate::bounds::check_step;
use crate::error::Error;
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// Computes one step of RK4 for z' = f(z): returns the state a time `dt` after `z`.
///
/// ```text
/// Y1 = dt f(z)      Y2 = dt f(z + Y1/2)      Y3 = dt f(z + Y2/2)      Y4 = dt f(z + Y3)
///
/// z(t + dt) = z + (Y1 + 2 Y2 + 2 Y3 + Y4)/6
/// ```
///
/// The error is O(dt^5) after one step, and O(dt^4) after a fixed time. A negative `dt` steps
/// backwards.
#[must_use]
#[inline]
pub fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
    let half = dt * R::HALF;
    let k1 = f(z);
    let k2 = f(&advanced(z, half, &k1));
    let k3 = f(&advanced(z, half, &k2));
    let k4 = f(&advanced(z, dt, &k3));
    let sixth = dt / R::from_f64(6.0);
    core::array::from_fn(|i| z[i] + sixth * (k1[i] + R::TWO * (k2[i] + k3[i]) + k4[i]))
}

/// Returns z + dt k.
#[inline(always)]
fn advanced<R: Real, const N: usize>(z: &[R; N], dt: R, k: &[R; N]) -> [R; N] {
    core::array::from_fn(|i| z[i] + dt * k[i])
}

impl<R: Real> Pendulum<R> {
    /// Computes one step of RK4: returns the state a time `dt`, s, after `state`.
    ///
    /// A negative `dt` steps backwards. The inputs are not checked. A state or a step that is NaN
    /// gives NaN. A step that is too long for the motion gives a meaningless state, which in the
    /// end is infinite or NaN. Call [`check_step`](Self::check_step) or
    /// [`admissible_step`](Self::admissible_step) before the first step, and [`State::finite`]
    /// after each.
    #[must_use]
    #[inline]
    pub fn step(&self, state: &State<R>, dt: R) -> State<R> {
        step(|z| self.derivatives(z), &(*state).into(), dt).into()
    }
}

/// The equations of motion of a pendulum.
#[doc(hidden)]
pub trait Derivatives<R: Real>: Copy + Debug + PartialEq + 'static {
    /// Prepares the equations. Refuses parameters out of their range.
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error>;
    /// Returns the time derivatives of (a1, a2, p1, p2).
    fn derivatives(&self, z: &[R; 4]) -> [R; 4];
}

#[doc(hidden)]
impl<R: Real> Derivatives<R> for Pendulum<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::new(parameters)
    }
    #[inline(always)]
    fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        Pendulum::derivatives(self, z)
    }
}

/// A motion by RK4 on the equations `E`. It carries the state (a1, a2, p1, p2) only.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canonical<R, E = Pendulum<R>> {
    equations: E,
    dt: R,
    state: State<R>,
}

impl<R, E> Sealed for Canonical<R, E> {}

#[doc(hidden)]
impl<R: Real, E: Derivatives<R>> Form for Canonical<R, E> {
    type Real = R;
    const HAS_TURNS: bool = true;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        let equations = E::prepare(&parameters.cast())?;
        Self {
            equations,
            dt: R::from_f64(dt),
            state: State::default(),
        }
        .started(start)
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        let state = start.cast();
        state.check()?;
        Ok(Self { state, ..*self })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.state = step(
                |z| self.equations.derivatives(z),
                &self.state.into(),
                self.dt,
            )
            .into();
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.state.finite().map(drop)
    }

    fn sides(&self) -> [[i32; 2]; 2] {
        self.directions::<R>()
            .map(|direction| direction.map(R::side))
    }

    fn side_value(side: i32) -> R {
        R::from_side(side)
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.state.angles().map(|angle| {
            let (sin, cos) = angle.own_sin_cos();
            [sin.cast(), cos.cast()]
        })
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        [self.state.p1.cast(), self.state.p2.cast()]
    }

    fn state(&self) -> State<f64> {
        self.state.cast()
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        <[R; 4]>::from(self.state)
            .map(R::bits)
            .into_iter()
            .for_each(feed);
    }
}
