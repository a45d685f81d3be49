//! The state (a1, a2, p1, p2), by equations of motion as one writes them down.

use double_pendulum::trig::SinCos;
use double_pendulum::{EqualRods, Error, Parameters, Pendulum, Real, State, Units};

use super::run::{Run, checked};
use super::textbook::{Separate, Textbook};
use super::{JobError, Request};

/// A step of the state in SI units.
pub(super) trait Equations<R>: Copy {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error>;
    /// The state a time `dt` (s) after `state`.
    fn step(&self, state: &State<R>, dt: R) -> State<R>;
}

impl<R: Real, T: SinCos<R>> Equations<R> for Pendulum<R, T> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::with_trig(*parameters)
    }

    #[inline(always)]
    fn step(&self, state: &State<R>, dt: R) -> State<R> {
        Pendulum::step(self, state, dt)
    }
}

impl<R: Separate> Equations<R> for Textbook<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Ok(Textbook::new(*parameters))
    }

    #[inline(always)]
    fn step(&self, state: &State<R>, dt: R) -> State<R> {
        Textbook::step(self, state, dt)
    }
}

/// Nothing is carried along but the state.
#[derive(Clone, Copy, Debug)]
pub struct Canonical<R, E = Pendulum<R>> {
    equations: E,
    state: State<R>,
    dt: R,
}

impl<R: Real, E: Equations<R>> Run for Canonical<R, E> {
    fn start(request: &Request) -> Result<Self, JobError> {
        let (pendulum, state) = checked(request)?;
        Ok(Self { equations: E::prepare(pendulum.parameters())?, state, dt: R::from_f64(request.dt) })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.state = self.equations.step(&self.state, self.dt);
        }
    }

    fn state(&self) -> State<f64> {
        self.state.cast()
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        <[R; 4]>::from(self.state).map(R::bits).into_iter().for_each(feed);
    }
}

/// The same in the units of the equal-rod form.
#[derive(Clone, Copy, Debug)]
pub struct Equal<R> {
    rods: EqualRods<R>,
    units: Units<R>,
    state: State<R>,
    /// In units of time.
    dt: R,
}

impl<R: Real> Run for Equal<R> {
    fn start(request: &Request) -> Result<Self, JobError> {
        let (pendulum, state) = checked::<R>(request)?;
        let units = Units::of(pendulum.parameters())?;
        let rods = EqualRods::new(pendulum.parameters().mass_ratio())?;
        Ok(Self { rods, units, state: units.from_si(&state), dt: R::from_f64(request.dt) / units.time })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.state = self.rods.step(&self.state, self.dt);
        }
    }

    fn state(&self) -> State<f64> {
        self.units.to_si(&self.state).cast()
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        <[R; 4]>::from(self.state).map(R::bits).into_iter().for_each(feed);
    }
}
