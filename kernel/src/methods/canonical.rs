//! The state (a1, a2, p1, p2) itself, by equations of motion as one writes them down and the classical RK4.

use core::fmt::Debug;

use super::{Form, rk4};
use crate::bounds::check_step;
use crate::error::Error;
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// Equations of motion.
pub trait Derivatives<R: Real>: Copy + Debug + PartialEq + 'static {
    /// Refuses what they do not hold for.
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error>;
    /// The time derivatives of (a1, a2, p1, p2).
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

/// The state stepped by the equations `E`; nothing is carried along but the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canonical<R, E = Pendulum<R>> {
    equations: E,
    dt: R,
    state: State<R>,
}

impl<R, E> Sealed for Canonical<R, E> {}

#[doc(hidden)]
impl<R: Real + super::Side, E: Derivatives<R>> Form for Canonical<R, E> {
    type Real = R;
    type Side = R;
    const HAS_TURNS: bool = true;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        let equations = E::prepare(&parameters.cast())?;
        Self { equations, dt: R::from_f64(dt), state: State::default() }.started(start)
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        let state = start.cast();
        state.check()?;
        Ok(Self { state, ..*self })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.state = rk4::step(|z| self.equations.derivatives(z), &self.state.into(), self.dt).into();
        }
    }

    fn check(&self) -> Result<(), Error> {
        self.state.finite().map(drop)
    }

    fn heads(&self) -> [Direction<R>; 2] {
        self.state.angles().map(|angle| angle.own_sin_cos().into())
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.heads().map(|head| head.map(R::cast))
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        [self.state.p1.cast(), self.state.p2.cast()]
    }

    fn state(&self) -> State<f64> {
        self.state.cast()
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        <[R; 4]>::from(self.state).map(R::bits).into_iter().for_each(feed);
    }
}
