//! A motion by any method that a plan chooses from, and how far two of its frames are apart.

use super::cost::ORDER;
use crate::error::Error;
use crate::methods::{DirectionForm, Fixed32Form, Fixed64Form, Plain, Stepper};
use crate::pendulum::{Direction, Motion, Parameters, Pendulum, State};
use crate::small::{Modes, SmallOscillations};
use crate::table::Method;

/// The directions of both rods as they would be drawn.
pub type Directions = [Direction<f32>; 2];

/// A motion by any of [`Method::DRAWN`], read in `f32`: the one place that knows which type computes each.
#[expect(clippy::large_enum_variant, reason = "without a heap there is nowhere else to keep it")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AnyRun {
    ClosedForm(ClosedForm),
    DirectionPlain(Stepper<f32, DirectionForm<f32, Plain>>),
    Direction(Stepper<f32, DirectionForm<f32>>),
    Fixed32(Stepper<f32, Fixed32Form>),
    Fixed64(Stepper<f32, Fixed64Form<ORDER>>),
}

/// `$body` with the run of whichever method as `$run`.
macro_rules! with {
    ($any:expr, $run:ident => $body:expr) => {
        match $any {
            AnyRun::ClosedForm($run) => $body,
            AnyRun::DirectionPlain($run) => $body,
            AnyRun::Direction($run) => $body,
            AnyRun::Fixed32($run) => $body,
            AnyRun::Fixed64($run) => $body,
        }
    };
}

impl AnyRun {
    /// A pendulum from its start, with so many steps a second.
    ///
    /// Refuses what [`Form::new`](crate::methods::Form::new) and [`Form::start`](crate::methods::Form::start) refuse, what has no normal
    /// modes if the method is the closed form, and a method that is none of [`Method::DRAWN`].
    #[inline(never)] // each kind's preparations would stand side by side on the stack
    pub fn new(
        method: Method,
        (parameters, start): &(Parameters<f64>, State<f64>),
        per_second: f64,
    ) -> Result<Self, Error> {
        let dt = 1.0 / per_second;
        Ok(match method {
            Method::ClosedFormF32 => Self::ClosedForm(ClosedForm::new(parameters, start, per_second)?),
            Method::Rk4F32DirectionPlain => Self::DirectionPlain(Stepper::new(&parameters.cast(), &start.cast(), dt)?),
            Method::Rk4F32Direction => Self::Direction(Stepper::new(&parameters.cast(), &start.cast(), dt)?),
            Method::Rk4Fixed32 => Self::Fixed32(Stepper::<f64, _>::new(parameters, start, dt)?.read_in()),
            Method::Extrapolation10Fixed64 => Self::Fixed64(Stepper::<f64, _>::new(parameters, start, dt)?.read_in()),
            method => return Err(Error::NotDrawn { method }),
        })
    }

    /// Makes `steps` steps.
    #[inline(never)] // never inlined: a copy of every method for each caller
    pub fn advance(&mut self, steps: u32) {
        with!(self, run => run.advance(steps));
    }

    /// Where the rods point.
    #[inline(never)]
    pub fn directions(&self) -> Directions {
        with!(self, run => run.directions())
    }

    /// The momenta that go with the directions.
    #[inline(never)]
    pub fn momenta(&self) -> [f32; 2] {
        with!(self, run => run.momenta())
    }

    /// The canonical state, angles within a turn but in closed form.
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        with!(self, run => run.state())
    }
}

/// Small oscillations, read at any step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClosedForm {
    oscillations: SmallOscillations<f32>,
    pendulum: Pendulum<f32>,
    per_second: f64,
    steps: u64,
}

impl ClosedForm {
    fn new(parameters: &Parameters<f64>, start: &State<f64>, per_second: f64) -> Result<Self, Error> {
        let motion = Pendulum::new(*parameters)?.to_motion(start);
        let oscillations = SmallOscillations::new(Modes::new(parameters)?, &motion.cast());
        Ok(Self { oscillations, pendulum: Pendulum::new(parameters.cast())?, per_second, steps: 0 })
    }

    pub fn advance(&mut self, steps: u32) {
        self.steps += u64::from(steps);
    }

    fn time(&self) -> f64 {
        self.steps as f64 / self.per_second
    }

    pub fn directions(&self) -> Directions {
        self.oscillations.directions(self.time())
    }

    fn momenta(&self) -> [f32; 2] {
        let State { p1, p2, .. } = self.state();
        [p1, p2].map(|p| p as f32)
    }

    fn state(&self) -> State<f64> {
        let motion: Motion<f32> = self.oscillations.at(self.time());
        self.pendulum.to_state(&motion).cast()
    }
}

/// What a [`Run`] steps: a motion by any method, or by one where that takes less memory.
pub(super) trait Stepped: Sized {
    fn prepared(method: Method, given: &(Parameters<f64>, State<f64>), per_second: f64) -> Result<Self, Error>;
    fn steps(&mut self, steps: u32);
    fn shown(&self) -> Directions;
}

impl Stepped for AnyRun {
    fn prepared(method: Method, given: &(Parameters<f64>, State<f64>), per_second: f64) -> Result<Self, Error> {
        Self::new(method, given, per_second)
    }
    fn steps(&mut self, steps: u32) {
        self.advance(steps);
    }
    fn shown(&self) -> Directions {
        self.directions()
    }
}

impl Stepped for Stepper<f32, DirectionForm<f32, Plain>> {
    #[inline(never)]
    fn prepared(_: Method, given: &(Parameters<f64>, State<f64>), per_second: f64) -> Result<Self, Error> {
        Self::new(&given.0.cast(), &given.1.cast(), 1.0 / per_second)
    }
    fn steps(&mut self, steps: u32) {
        self.advance(steps);
    }
    fn shown(&self) -> Directions {
        self.directions()
    }
}

/// A motion that is prepared before its first step, and stepped from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run<M = AnyRun> {
    motion: Prepared<M>,
    per_frame: u32,
    /// Steps made since the last frame.
    made: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Prepared<M> {
    /// A pendulum and its start, others if these are refused, and steps a second.
    NotYet(Method, [(Parameters<f64>, State<f64>); 2], f64),
    Ready(M),
}

impl<M: Stepped> Run<M> {
    /// By `method`: a pendulum and its start, or the others if the first are refused, with `per_frame` steps for each of the
    /// `rate` frames of a second.
    pub fn new(method: Method, given: [(Parameters<f64>, State<f64>); 2], rate: u16, per_frame: u32) -> Self {
        let per_second = f64::from(rate) * f64::from(per_frame);
        Self { motion: Prepared::NotYet(method, given, per_second), per_frame, made: 0 }
    }

    /// Prepares the steps; whether they were not.
    #[inline(never)]
    pub fn prepare(&mut self) -> Result<bool, Error> {
        let Prepared::NotYet(method, [first, other], per_second) = &self.motion else { return Ok(false) };
        let run = M::prepared(*method, first, *per_second);
        self.motion = Prepared::Ready(run.or_else(|_| M::prepared(*method, other, *per_second))?);
        Ok(true)
    }

    /// Makes `most` of the steps towards the next frame, or as many as are left. How many that were: 0 if nothing was left to
    /// do.
    #[inline(never)]
    pub fn advance(&mut self, most: u32) -> u32 {
        let left = self.per_frame.saturating_sub(self.made);
        let steps = if most < left { most } else { left };
        if let Prepared::Ready(motion) = &mut self.motion {
            motion.steps(steps);
        }
        self.made += steps;
        steps
    }

    /// The frame, when nothing is left to do; the next steps lead to the next.
    #[inline(never)]
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        match &self.motion {
            Prepared::NotYet(..) => [[f32::NAN; 2]; 2],
            Prepared::Ready(motion) => motion.shown(),
        }
    }
}
/// How far the farther of the two bobs is off, or bob 2 as seen from bob 1, where the rods are as long as `rods`, in their
/// unit; NaN if anything is.
///
/// The last keeps curves of the angles right, too: opposite errors of both may leave bob 2 where it belongs.
#[inline(never)] // one copy
pub(super) fn distance(rods: [f32; 2], a: &Directions, b: &Directions) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let [bob1, relative] = [0, 1].map(|rod| [difference(rod, 0), difference(rod, 1)]);
    let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
    let [bob1, relative, bob2] = [bob1, relative, bob2].map(|[x, y]| x * x + y * y);
    libm::sqrtf(greater(greater(bob1, relative), bob2))
}

/// The greater; NaN if either is.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bob 2 is where both rods lead, and may be less far off than either.
    #[test]
    fn the_farthest_of_what_is_seen_counts() {
        let from = |a: Directions| distance([2.0, 3.0], &a, &[[0.0; 2]; 2]);
        assert_eq!(from([[1.0, 0.0], [0.0, 1.0]]), 13.0_f32.sqrt());
        assert_eq!(from([[0.5, 0.0], [1.0, 0.0]]), 4.0);
        assert_eq!(from([[3.0, 0.0], [-1.0, 0.0]]), 6.0);
        assert_eq!(from([[0.0, 1.0], [0.0, -2.0]]), 6.0);
        assert!(from([[0.0, f32::NAN], [0.0, 1.0]]).is_nan());
    }
}
