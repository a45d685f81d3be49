//! Small oscillations, read at any step.

use super::{Form, Side};
use crate::bounds::check_step;
use crate::error::{Error, Parameter};
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Motion, Parameters, Pendulum, State};
use crate::small::{Modes, SmallOscillations};

/// The [`SmallOscillations`] of a pendulum: a step costs nothing, only to read it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedForm<R> {
    parameters: Parameters<f64>,
    /// Steps per second, of which times are exact where they are whole.
    rate: f64,
    pendulum: Pendulum<R>,
}

/// Its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillating<R> {
    oscillations: SmallOscillations<R>,
    rate: f64,
    steps: u64,
}

impl<R: Real> Oscillating<R> {
    fn directions(&self) -> [Direction<R>; 2] {
        self.oscillations.directions(self.steps as f64 / self.rate)
    }
}

impl<R> Sealed for ClosedForm<R> {}

#[doc(hidden)]
impl<R: Real + Side> Form for ClosedForm<R> {
    type Real = R;
    type Carried = Oscillating<R>;
    type Side = R;
    const HAS_TURNS: bool = true;

    fn new(parameters: &Parameters<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        Modes::new(parameters)?;
        let whole = libm::rint(1.0 / dt);
        let rate = if 1.0 / whole == dt { whole } else { 1.0 / dt };
        Ok(Self { parameters: *parameters, rate, pendulum: Pendulum::new(&parameters.cast())? })
    }

    fn start(&self, state: &State<f64>) -> Result<Oscillating<R>, Error> {
        state.check()?;
        let motion = Pendulum::new(&self.parameters)?.to_motion(state);
        let oscillations = SmallOscillations::new(Modes::new(&self.parameters)?, &motion.cast());
        // wherever it is, momenta and the fourth powers that directions are made of are finite
        let [angle, velocity]: [R; 2] = oscillations.greatest();
        let fastest = Motion { w1: velocity, w2: velocity, ..Motion::default() };
        if !(angle * angle * angle * angle).is_finite() || self.pendulum.to_state(&fastest).check().is_err() {
            return Err(Error::OutOfRange { parameter: Parameter::A1, value: angle.to_f64() });
        }
        Ok(Oscillating { oscillations, rate: self.rate, steps: 0 })
    }

    fn advance(&self, carried: &mut Oscillating<R>, steps: u32) {
        carried.steps += u64::from(steps);
    }

    fn check(&self, carried: &Oscillating<R>) -> Result<(), Error> {
        carried.oscillations.at(carried.steps as f64 / self.rate).check().map_err(Error::diverged)
    }

    fn heads(carried: &Oscillating<R>) -> [Direction<R>; 2] {
        carried.directions()
    }

    fn directions<Q: Real>(&self, carried: &Oscillating<R>) -> [Direction<Q>; 2] {
        carried.directions().map(|direction| direction.map(R::cast))
    }

    fn momenta<Q: Real>(&self, carried: &Oscillating<R>) -> [Q; 2] {
        let State { p1, p2, .. } = self.state(carried);
        [Q::from_f64(p1), Q::from_f64(p2)]
    }

    fn state(&self, carried: &Oscillating<R>) -> State<f64> {
        self.pendulum.to_state(&carried.oscillations.at(carried.steps as f64 / self.rate)).cast()
    }

    fn bits(carried: &Oscillating<R>, mut feed: impl FnMut(u64)) {
        carried.directions().iter().flatten().for_each(|x| feed(x.bits()));
        feed(carried.steps);
    }
}
