//! A form together with one motion in it.

use super::{Form, Winding};
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, State};

/// One motion, stepped in the form `F`: what most programs want.
///
/// It is a [`Form`] and what that carries from step to step, side by side; its methods are the form's. Where many motions
/// of one pendulum run at once, keep the form once and what it carries for each.
///
/// ```
/// use double_pendulum::methods::{DirectionForm, Stepper};
/// use double_pendulum::{Parameters, State};
///
/// let pendulum = Parameters::equal_rods(1.0, 1.0, 9.81);
/// let mut motion = Stepper::<f32, DirectionForm<f32>>::new(&pendulum, &State::at_rest(0.5, 0.5), 1.0 / 240.0)?;
/// motion.try_advance(240)?;
/// let [[sin1, cos1], _] = motion.directions(); // enough to draw rod 1
/// assert!((sin1 * sin1 + cos1 * cos1 - 1.0).abs() < 1e-6);
/// # Ok::<(), double_pendulum::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper<R: Real, F: Form<R>> {
    form: F,
    carried: F::Carried,
}

impl<R: Real, F: Form<R>> Stepper<R, F> {
    /// The motion from `start` in steps of `dt` seconds.
    ///
    /// Refuses what [`Form::new`] and [`Form::start`] refuse.
    pub fn new(parameters: &Parameters<R>, start: &State<R>, dt: f64) -> Result<Self, Error> {
        let form = F::new(parameters, dt)?;
        Ok(Self { form, carried: form.start(start)? })
    }

    /// The same motion, read in the arithmetic `Q`.
    pub(crate) fn read_in<Q: Real>(self) -> Stepper<Q, F>
    where
        F: Form<Q, Carried = <F as Form<R>>::Carried>,
    {
        let Self { form, carried } = self;
        Stepper { form, carried }
    }

    /// Makes `steps` steps ([`Form::advance`]).
    #[inline(always)]
    pub fn advance(&mut self, steps: u32) {
        self.form.advance(&mut self.carried, steps);
    }

    /// Makes `steps` steps, or none if they led out of the finite numbers ([`Form::try_advance`]).
    pub fn try_advance(&mut self, steps: u32) -> Result<(), Error> {
        self.form.try_advance(&mut self.carried, steps)
    }

    /// Where the rods point, (sin, cos) each ([`Form::directions`]).
    #[must_use]
    #[inline]
    pub fn directions(&self) -> [Direction<R>; 2] {
        self.form.directions(&self.carried)
    }

    /// The momenta that go with the directions ([`Form::momenta`]).
    #[must_use]
    pub fn momenta(&self) -> [R; 2] {
        self.form.momenta(&self.carried)
    }

    /// The canonical state in SI units ([`Form::state`]).
    #[must_use]
    pub fn state(&self) -> State<f64> {
        self.form.state(&self.carried)
    }

    /// Gives `feed` the bit patterns of all that is carried ([`Form::bits`]).
    pub fn bits(&self, feed: impl FnMut(u64)) {
        F::bits(&self.carried, feed);
    }
}

/// As [`Stepper`], with the turns of both rods counted: its [`state`](Self::state) has unwrapped angles in any form.
///
/// It looks at the directions after each step, so a step may turn a rod by a quarter turn at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnwrappedStepper<R: Real, F: Form<R>> {
    stepper: Stepper<R, F>,
    windings: [Winding<R>; 2],
}

impl<R: Real, F: Form<R>> UnwrappedStepper<R, F> {
    /// As [`Stepper::new`].
    pub fn new(parameters: &Parameters<R>, start: &State<R>, dt: f64) -> Result<Self, Error> {
        Ok(Self::of(Stepper::new(parameters, start, dt)?, start.angles()))
    }

    /// A motion that starts at these angles.
    pub(crate) fn of(stepper: Stepper<R, F>, start: [R; 2]) -> Self {
        let ([start1, start2], [upper, lower]) = (start, stepper.directions());
        Self { stepper, windings: [Winding::at(start1, upper), Winding::at(start2, lower)] }
    }

    #[inline(never)] // one copy
    fn observe(&mut self) {
        for (winding, direction) in self.windings.iter_mut().zip(self.stepper.directions()) {
            winding.observe(direction);
        }
    }

    /// Makes `steps` steps and counts the turns.
    #[inline]
    pub fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.stepper.advance(1);
            self.observe();
        }
    }

    /// As [`Stepper::directions`].
    #[must_use]
    #[inline]
    pub fn directions(&self) -> [Direction<R>; 2] {
        self.windings.each_ref().map(Winding::last)
    }

    /// As [`Stepper::state`], the angles with all their turns.
    #[must_use]
    pub fn state(&self) -> State<f64> {
        self.unwrap(self.stepper.state())
    }

    /// A `state` of this motion now, the angles with all their turns.
    #[must_use]
    pub fn unwrap(&self, state: State<f64>) -> State<f64> {
        let [winding1, winding2] = &self.windings;
        State { a1: winding1.unwrap(state.a1), a2: winding2.unwrap(state.a2), ..state }
    }

    /// The motion without its turns.
    #[must_use]
    pub fn stepper(&self) -> &Stepper<R, F> {
        &self.stepper
    }
}
