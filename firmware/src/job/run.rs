//! How each model and form of the kernel's is run for a request, in any arithmetic.

use core::f64::consts::TAU;

use double_pendulum::form::{self, Stepper, Winding};
use double_pendulum::{EqualRods, Error, Modes, Motion, Parameters, Pendulum, Real, SmallOscillations, State, Units};

use super::{Reading, Request};

/// One motion under way. It starts at step 0 with the request's angles and velocities.
pub(super) trait Run: Sized {
    fn start(request: &Request) -> Result<Self, Error>;
    /// Moves one step on.
    fn step(&mut self);
    fn reading(&self) -> Reading;
}

/// The request's numbers in the arithmetic `R`, each rounded once.
fn rounded<R: Real>(request: &Request) -> (Parameters<R>, Motion<R>, R) {
    let parameters = request.parameters.cast();
    let ([a1, a2], [w1, w2]) = (request.angles.map(R::from_f64), request.velocities.map(R::from_f64));
    (parameters, Motion { a1, a2, w1, w2 }, R::from_f64(request.dt))
}

fn reading<R: Real>(pendulum: &Pendulum<R>, state: &State<R>, motion: &Motion<R>) -> Reading {
    Reading {
        state: state.cast().into(),
        velocities: [motion.w1.to_f64(), motion.w2.to_f64()],
        energy: pendulum.energy(state).to_f64(),
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct General<R> {
    pendulum: Pendulum<R>,
    dt: R,
    state: State<R>,
}

impl<R: Real> Run for General<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, start, dt) = rounded(request);
        start.check()?;
        let pendulum = Pendulum::new(parameters)?;
        pendulum.check_step(request.dt)?;
        let state = pendulum.to_state(&start);
        state.check()?;
        Ok(Self { pendulum, dt, state })
    }

    fn step(&mut self) {
        self.state = self.pendulum.step(&self.state, self.dt);
    }

    fn reading(&self) -> Reading {
        reading(&self.pendulum, &self.state, &self.pendulum.to_motion(&self.state))
    }
}

/// As [`General`], stepped in the units of the equal-rod form.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equal<R> {
    rods: EqualRods<R>,
    units: Units<R>,
    state: State<R>,
    /// In units of time.
    dt: R,
    si: Pendulum<R>,
}

impl<R: Real> Run for Equal<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let General { pendulum, dt, state } = General::<R>::start(request)?;
        let units = Units::of(pendulum.parameters())?;
        let rods = EqualRods::new(pendulum.parameters().mass_ratio())?;
        Ok(Self { rods, units, state: units.from_si(&state), dt: dt / units.time, si: pendulum })
    }

    fn step(&mut self) {
        self.state = self.rods.step(&self.state, self.dt);
    }

    fn reading(&self) -> Reading {
        let state = self.units.to_si(&self.state);
        reading(&self.si, &state, &self.si.to_motion(&state))
    }
}

/// A form of the kernel's, with what it carries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Formed<R: Real, F: form::Form<R>> {
    stepper: Stepper<R, F>,
    /// In double precision, for readings hold more digits than an `f32`.
    pendulum: Pendulum<f64>,
}

impl<R: Real, F: form::Form<R>> Formed<R, F> {
    fn read(&self, state: &State<f64>) -> Reading {
        reading(&self.pendulum, state, &self.pendulum.to_motion(state))
    }
}

impl<R: Real, F: form::Form<R>> Run for Formed<R, F> {
    fn start(request: &Request) -> Result<Self, Error> {
        let General { pendulum, state, .. } = General::<R>::start(request)?;
        let stepper = Stepper::new(pendulum.parameters(), &state, request.dt)?;
        let pendulum = Pendulum::new(pendulum.parameters().cast())?;
        Ok(Self { stepper, pendulum })
    }

    fn step(&mut self) {
        self.stepper.advance(1);
    }

    fn reading(&self) -> Reading {
        self.read(&self.stepper.state())
    }
}

/// A form that knows directions only, its whole turns counted beside it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wound<R: Real, F: form::Form<R>> {
    formed: Formed<R, F>,
    windings: [Winding<R>; 2],
}

impl<R: Real, F: form::Form<R>> Run for Wound<R, F> {
    fn start(request: &Request) -> Result<Self, Error> {
        let formed = Formed::start(request)?;
        Ok(Self { formed, windings: request.angles.map(|angle| Winding::new(R::from_f64(angle))) })
    }

    fn step(&mut self) {
        self.formed.step();
        let directions = self.formed.stepper.directions();
        self.windings.iter_mut().zip(directions).for_each(|(winding, direction)| winding.observe(direction));
    }

    fn reading(&self) -> Reading {
        let State { a1, a2, p1, p2 } = self.formed.stepper.state();
        let [winding1, winding2] = self.windings;
        self.formed.read(&State { a1: unwrapped(a1, &winding1), a2: unwrapped(a2, &winding2), p1, p2 })
    }
}

/// The angle, rad, that points where `angle` does and has the turns of `winding`.
fn unwrapped<R: Real>(angle: f64, winding: &Winding<R>) -> f64 {
    angle + TAU * libm::rint((winding.angle() - angle) / TAU)
}

/// The closed form: a step costs nothing, only a reading does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear<R> {
    oscillations: SmallOscillations<R>,
    pendulum: Pendulum<R>,
    /// In f64, so that the time is rounded once.
    dt: f64,
    steps: u32,
}

impl<R: Real> Run for Linear<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, start, _) = rounded(request);
        start.check()?;
        let pendulum = Pendulum::new(parameters)?;
        let oscillations = SmallOscillations::new(Modes::new(&parameters)?, &start);
        Ok(Self { oscillations, pendulum, dt: request.dt, steps: 0 })
    }

    fn step(&mut self) {
        self.steps = self.steps.wrapping_add(1);
    }

    fn reading(&self) -> Reading {
        let motion = self.oscillations.at(R::from_f64(f64::from(self.steps) * self.dt));
        reading(&self.pendulum, &self.pendulum.to_state(&motion), &motion)
    }
}
