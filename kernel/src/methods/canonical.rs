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
}

impl<R, E> Sealed for Canonical<R, E> {}

#[doc(hidden)]
impl<R: Real + super::Side, E: Derivatives<R>> Form for Canonical<R, E> {
    type Real = R;
    type Carried = State<R>;
    type Side = R;
    const HAS_TURNS: bool = true;

    fn new(parameters: &Parameters<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        Ok(Self { equations: E::prepare(&parameters.cast())?, dt: R::from_f64(dt) })
    }

    fn start(&self, state: &State<f64>) -> Result<State<R>, Error> {
        let state = state.cast();
        state.check()?;
        Ok(state)
    }

    #[inline(always)]
    fn advance(&self, carried: &mut State<R>, steps: u32) {
        for _ in 0..steps {
            *carried = rk4::step(|z| self.equations.derivatives(z), &(*carried).into(), self.dt).into();
        }
    }

    fn check(&self, carried: &State<R>) -> Result<(), Error> {
        carried.finite().map(drop)
    }

    fn heads(carried: &State<R>) -> [Direction<R>; 2] {
        carried.angles().map(|angle| angle.own_sin_cos().into())
    }

    fn directions<Q: Real>(&self, carried: &State<R>) -> [Direction<Q>; 2] {
        Self::heads(carried).map(|head| head.map(R::cast))
    }

    fn momenta<Q: Real>(&self, carried: &State<R>) -> [Q; 2] {
        [carried.p1.cast(), carried.p2.cast()]
    }

    fn state(&self, carried: &State<R>) -> State<f64> {
        carried.cast()
    }

    fn bits(carried: &State<R>, feed: impl FnMut(u64)) {
        <[R; 4]>::from(*carried).map(R::bits).into_iter().for_each(feed);
    }
}
