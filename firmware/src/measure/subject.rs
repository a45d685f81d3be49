//! The table of arithmetics under measurement.

use double_pendulum::form::Stepper as Formed;
use double_pendulum::form::{AngleForm, Compensated, DirectionForm, DirectionForm8, Divided, Followed, Form, Plain};
use double_pendulum::trig::{Libm, Micromath, Own, SinCos};
use double_pendulum::{Error, Modes, Motion, Parameters, Pendulum, Real, SmallOscillations, State};

use super::textbook::Separate;
use super::{Outcome, Request, RequestError, Textbook};

/// An arithmetic that can be measured.
#[derive(Clone, Copy, Debug)]
pub struct Subject {
    /// What a request calls it: precision, form if it is not the canonical state, source of sine and cosine or kind of sum.
    pub name: &'static str,
    run: fn(&Request, Each) -> Result<(), Error>,
    outcome: fn(&Request) -> Result<Outcome, Error>,
}

const fn subject<S: Stepper>(name: &'static str) -> Subject {
    Subject { name, run: run::<S>, outcome: outcome::<S> }
}

/// Is given every sampled state.
type Each<'a> = &'a mut dyn FnMut(&State<f64>);

/// A name stands for one arithmetic.
impl PartialEq for Subject {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Every arithmetic there is, the page's own first.
pub const SUBJECTS: &[Subject] = &[
    subject::<Canonical<f32, Textbook<f32>>>("f32-textbook-libm"),
    subject::<Canonical<f32, Pendulum<f32, Libm>>>("f32-libm"),
    subject::<Canonical<f32, Pendulum<f32, Micromath>>>("f32-micromath"),
    subject::<Canonical<f32, Pendulum<f32, Own>>>("f32-own"),
    subject::<Formed<f32, AngleForm<f32>>>("f32-angle-compensated"),
    subject::<Formed<f32, DirectionForm<f32>>>("f32-direction-compensated"),
    subject::<Formed<f32, DirectionForm<f32, Plain, Followed>>>("f32-direction-plain"),
    subject::<Formed<f32, DirectionForm<f32, Plain, Divided>>>("f32-direction-plain-divided"),
    subject::<Canonical<f64, Textbook<f64>>>("f64-textbook-libm"),
    subject::<Canonical<f64, Pendulum<f64, Libm>>>("f64-libm"),
    subject::<Canonical<f64, Pendulum<f64, Own>>>("f64-own"),
    subject::<Formed<f64, AngleForm<f64, Plain>>>("f64-angle-plain"),
    subject::<Formed<f64, AngleForm<f64, Compensated<f64>>>>("f64-angle-compensated"),
    subject::<Formed<f64, DirectionForm<f64, Plain>>>("f64-direction-plain"),
    subject::<Formed<f64, DirectionForm8<f64>>>("f64-direction8-compensated"),
];

/// Small oscillations in closed form: a step is a frame, at any time. Right for small angles alone.
pub const CLOSED_FORM: Subject = subject::<ClosedForm>("f32-closed-form");

impl Request<'_> {
    /// Runs the request and calls `each` with every sampled state.
    pub fn run(&self, each: Each) -> Result<(), RequestError> {
        (self.subject()?.run)(self, each).map_err(RequestError::Refused)
    }

    /// Runs the request and takes the CRC.
    pub fn outcome(&self) -> Result<Outcome, RequestError> {
        (self.subject()?.outcome)(self).map_err(RequestError::Refused)
    }

    fn subject(&self) -> Result<&'static Subject, RequestError> {
        SUBJECTS
            .iter()
            .chain([&CLOSED_FORM])
            .find(|subject| subject.name == self.subject)
            .ok_or(RequestError::UnknownSubject)
    }
}

/// A pendulum with all that its arithmetic carries along. The one trait a new arithmetic implements to be measured.
trait Stepper: Copy {
    /// At the start of the request.
    fn start(request: &Request) -> Result<Self, Error>;
    /// Makes `steps` steps.
    fn advance(&mut self, steps: u32);
    /// The canonical state, SI units.
    fn state(&self) -> State<f64>;
    /// Gives `feed` the bit patterns of all that is carried from step to step.
    fn bits(&self, feed: impl FnMut(u64));
}

fn run<S: Stepper>(request: &Request, each: Each) -> Result<(), Error> {
    let mut stepper = S::start(request)?;
    for _ in 0..request.samples {
        counted_steps(&mut stepper, request.steps);
        each(&stepper.state());
    }
    Ok(())
}

/// The reflected CRC-32 of zip and Ethernet.
const CRC: crc::Crc<u32, crc::Table<1>> = crc::Crc::<u32, crc::Table<1>>::new(&crc::CRC_32_ISO_HDLC);

fn outcome<S: Stepper>(request: &Request) -> Result<Outcome, Error> {
    let mut stepper = S::start(request)?;
    let mut digest = CRC.digest();
    for _ in 0..request.samples {
        counted_steps(&mut stepper, request.steps);
        stepper.bits(|word| digest.update(&word.to_le_bytes()));
    }
    Ok(Outcome { crc: digest.finalize(), state: stepper.state() })
}

/// What the counter counts, from this function's first instruction to its return; it finds it by this name.
#[inline(never)]
fn counted_steps<S: Stepper>(stepper: &mut S, steps: u32) {
    let mut local = *stepper;
    local.advance(steps);
    *stepper = local;
}

/// Equations of motion for the state (a1, a2, p1, p2) in SI units.
trait Equations<R>: Copy {
    fn prepare(parameters: Parameters<R>) -> Result<Self, Error>;
    fn step(&self, state: &State<R>, dt: R) -> State<R>;
}

impl<R: Separate> Equations<R> for Textbook<R> {
    fn prepare(parameters: Parameters<R>) -> Result<Self, Error> {
        Ok(Textbook::new(parameters))
    }
    fn step(&self, state: &State<R>, dt: R) -> State<R> {
        Textbook::step(self, state, dt)
    }
}

impl<R: Real, T: SinCos<R>> Equations<R> for Pendulum<R, T> {
    fn prepare(parameters: Parameters<R>) -> Result<Self, Error> {
        Pendulum::with_trig(parameters)
    }
    fn step(&self, state: &State<R>, dt: R) -> State<R> {
        Pendulum::step(self, state, dt)
    }
}

/// Classical RK4 on `E` with nothing carried along but the state.
#[derive(Clone, Copy)]
struct Canonical<R, E> {
    equations: E,
    state: State<R>,
    dt: R,
}

impl<R: Real, E: Equations<R>> Stepper for Canonical<R, E> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, state, dt) = rounded(request);
        Ok(Self { equations: E::prepare(parameters)?, state, dt })
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

impl<R: Real, F: Form<R>> Stepper for Formed<R, F> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, state, _) = rounded(request);
        Formed::new(&parameters, &state, request.dt)
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        Formed::advance(self, steps);
    }

    fn state(&self) -> State<f64> {
        Formed::state(self)
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        Formed::bits(self, feed);
    }
}

/// The directions of the rods, drawn at one time after the other.
#[derive(Clone, Copy)]
struct ClosedForm {
    motion: SmallOscillations<f32>,
    step: u32,
    dt: f32,
    directions: [[f32; 2]; 2],
}

impl Stepper for ClosedForm {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, state, dt) = rounded(request);
        let motion = SmallOscillations::new(Modes::new(&parameters)?, &Motion::at_rest(state.a1, state.a2));
        Ok(Self { motion, step: 0, dt, directions: motion.directions(0.0) })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step += 1;
            self.directions = self.motion.directions(self.step as f32 * self.dt);
        }
    }

    /// Without momenta.
    fn state(&self) -> State<f64> {
        let [a1, a2] = self.directions.map(|[sin, cos]| Real::atan2(sin, cos).to_f64());
        State::at_rest(a1, a2)
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.directions.iter().flatten().for_each(|x| feed(x.bits()));
    }
}

/// The request's numbers in `R`, each rounded once: the pendulum, the start, the step.
fn rounded<R: Real>(request: &Request) -> (Parameters<R>, State<R>, R) {
    let [a1, a2] = request.angles;
    (request.parameters.cast(), State::at_rest(a1, a2).cast(), R::from_f64(request.dt))
}
