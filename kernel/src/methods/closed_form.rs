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
    oscillations: SmallOscillations<R>,
    steps: u64,
}

impl<R: Real> ClosedForm<R> {
    fn time(&self) -> f64 {
        self.steps as f64 / self.rate
    }
}

impl<R> Sealed for ClosedForm<R> {}

#[doc(hidden)]
impl<R: Real + Side> Form for ClosedForm<R> {
    type Real = R;
    type Side = R;
    const HAS_TURNS: bool = true;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        check_step::<f64>(dt)?;
        let oscillations = SmallOscillations::new(Modes::new(parameters)?, &Motion::default());
        let whole = libm::rint(1.0 / dt);
        let rate = if 1.0 / whole == dt { whole } else { 1.0 / dt };
        let pendulum = Pendulum::new(&parameters.cast())?;
        Self { parameters: *parameters, rate, pendulum, oscillations, steps: 0 }.started(start)
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        start.check()?;
        let motion = Pendulum::new(&self.parameters)?.to_motion(start);
        let oscillations = SmallOscillations::new(Modes::new(&self.parameters)?, &motion.cast());
        // wherever it is, momenta and the fourth powers that directions are made of are finite
        let [angle, velocity]: [R; 2] = oscillations.greatest();
        let fastest = Motion { w1: velocity, w2: velocity, ..Motion::default() };
        if !(angle * angle * angle * angle).is_finite() || self.pendulum.to_state(&fastest).check().is_err() {
            return Err(Error::OutOfRange { parameter: Parameter::A1, value: angle.to_f64() });
        }
        Ok(Self { oscillations, steps: 0, ..*self })
    }

    fn advance(&mut self, steps: u32) {
        self.steps += u64::from(steps);
    }

    fn check(&self) -> Result<(), Error> {
        self.oscillations.at(self.time()).check().map_err(Error::diverged)
    }

    fn heads(&self) -> [Direction<R>; 2] {
        self.oscillations.directions(self.time())
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.heads().map(|direction| direction.map(R::cast))
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        let State { p1, p2, .. } = self.state();
        [Q::from_f64(p1), Q::from_f64(p2)]
    }

    fn state(&self) -> State<f64> {
        self.pendulum.to_state(&self.oscillations.at(self.time())).cast()
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.heads().iter().flatten().for_each(|x| feed(x.bits()));
        feed(self.steps);
    }
}
