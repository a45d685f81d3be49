//! Explicit Runge-Kutta methods on the equations of motion in angles and momenta.

use core::fmt::Debug;
use core::marker::PhantomData;

use super::{Advance, FormOperations, rk4};
use crate::bounds::{RK4_STABLE, check_step};
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// The equations of motion of a pendulum. Any crate may implement this trait; [`Canonical`] with
/// these equations is a [`Form`](super::Form), which [`Pendulum::run`] accepts.
pub trait Derivatives<R: Real>: Copy + Debug + PartialEq + 'static {
    /// Prepares the equations; refuses the parameters that they do not accept.
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error>;
    /// Returns the time derivatives of z = (a1, a2, p1, p2), in rad/s and N m, where z is in rad
    /// and kg m^2/s.
    fn derivatives(&self, z: &[R; 4]) -> [R; 4];
}

/// Hamilton's equations ([`Pendulum::derivatives`]), which [`Canonical`] integrates by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hamilton<R>(Pendulum<R>);

impl<R: Real> Derivatives<R> for Hamilton<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::new(parameters).map(Self)
    }
    fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        self.0.derivatives(z)
    }
}

/// An explicit Runge-Kutta method, for any system of first-order equations.
///
/// To add an integrator, implement this trait in a file of its own, as [`Rk4`] does.
pub trait RungeKutta: Copy + Debug + PartialEq + 'static {
    /// The order p: the error of a step is proportional to dt^(p + 1).
    const ORDER: u32;

    /// The largest phase w dt, rad, of a stable step, where w is the frequency of an oscillation.
    /// [`Pendulum::run`] refuses steps that are longer for the fast normal mode.
    const STABLE: f64;

    /// Computes one step for z' = f(z): returns the state a time `dt` after `z`, in the unit of
    /// time of f.
    fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N];
}

/// The classical Runge-Kutta method ([`rk4::step`]), as the integrator of [`Canonical`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rk4;

impl RungeKutta for Rk4 {
    const ORDER: u32 = 4;
    const STABLE: f64 = RK4_STABLE;

    fn step<R: Real, const N: usize>(f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        rk4::step(f, z, dt)
    }
}

/// A motion on the equations `E` by the integrator `I`. Its angles include whole turns. A step is
/// dt rounded to `R`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canonical<R, E = Hamilton<R>, I = Rk4> {
    equations: E,
    dt: R,
    state: State<R>,
    integrator: PhantomData<I>,
}

impl<R: Real, E: Derivatives<R>, I: RungeKutta> Advance for Canonical<R, E, I> {
    fn has_turns(&self) -> bool {
        true
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        let state = start.cast();
        state.check()?;
        Ok(Self { state, ..*self })
    }

    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.state = I::step(
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
}

impl<R: Real, E: Derivatives<R>, I: RungeKutta> FormOperations for Canonical<R, E, I> {
    type Real = R;
    const STABLE: f64 = I::STABLE;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<R>(dt)?;
        let equations = E::prepare(&parameters.cast())?;
        Self {
            equations,
            dt: R::from_f64(dt),
            state: State::default(),
            integrator: PhantomData,
        }
        .started(start)
    }

    fn side_value(side: i32) -> R {
        R::from_side(side)
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        <[R; 4]>::from(self.state)
            .map(R::bits)
            .into_iter()
            .for_each(feed);
    }
}
