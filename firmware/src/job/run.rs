//! The ways to compute a motion: one row of a table for each pair of arithmetic and model.

use double_pendulum::{EqualRods, Error, Modes, Motion, Parameters, Pendulum, Real, SmallOscillations, State, Units};

use super::{Arithmetic, Model, Reading, Request};

/// One motion under way. It starts at step 0 with the request's angles and velocities.
trait Run: Sized {
    fn start(request: &Request) -> Result<Self, Error>;
    /// Moves one step on.
    fn step(&mut self);
    fn reading(&self) -> Reading;
}

macro_rules! runs {
    ($($name:ident: $arithmetic:ident, $model:ident => $run:ty;)*) => {
        #[derive(Clone, Copy, Debug)]
        enum Kind { $($name($run),)* }

        impl Kind {
            fn start(request: &Request) -> Result<Self, Error> {
                match (request.arithmetic, request.model) {
                    $((Arithmetic::$arithmetic, Model::$model) => Ok(Kind::$name(<$run>::start(request)?)),)*
                }
            }

            fn step(&mut self) {
                match self { $(Kind::$name(run) => run.step(),)* }
            }

            fn reading(&self) -> Reading {
                match self { $(Kind::$name(run) => run.reading(),)* }
            }
        }
    };
}

runs! {
    GeneralF32: F32, General => General<f32>;
    GeneralF64: F64, General => General<f64>;
    EqualRodsF32: F32, EqualRods => Equal<f32>;
    EqualRodsF64: F64, EqualRods => Equal<f64>;
    LinearF32: F32, Linear => Linear<f32>;
    LinearF64: F64, Linear => Linear<f64>;
}

/// A request being answered: computes the samples one after the other, a bounded amount of work at a time.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    kind: Kind,
    stride: u32,
    /// Samples still to come, the one at the start included.
    left: u32,
    /// Steps until the next of them.
    steps: u32,
}

impl Job {
    /// Refuses parameters, angles, velocities and step sizes that the kernel refuses.
    pub fn new(request: &Request) -> Result<Self, Error> {
        let kind = Kind::start(request)?;
        Ok(Self { kind, stride: request.stride, left: request.samples.saturating_add(1), steps: 0 })
    }

    /// Whether every sample has been given.
    pub fn is_finished(&self) -> bool {
        self.left == 0
    }

    /// Computes at most one step; the reading, when a sample is due.
    pub fn advance(&mut self) -> Option<Reading> {
        if self.is_finished() {
            return None;
        }
        if self.steps > 0 {
            self.kind.step();
            self.steps -= 1;
        }
        if self.steps > 0 {
            return None;
        }
        self.left -= 1;
        self.steps = self.stride;
        Some(self.kind.reading())
    }
}

/// The request's numbers in the arithmetic `R`, each rounded once.
fn rounded<R: Real>(request: &Request) -> (Parameters<R>, Motion<R>, R) {
    let Parameters { m1, m2, l1, l2, g } = request.parameters;
    let parameters = Parameters { m1: R::of(m1), m2: R::of(m2), l1: R::of(l1), l2: R::of(l2), g: R::of(g) };
    let ([a1, a2], [w1, w2]) = (request.angles.map(R::of), request.velocities.map(R::of));
    (parameters, Motion { a1, a2, w1, w2 }, R::of(request.step_size))
}

fn reading<R: Real>(pendulum: &Pendulum<R>, state: &State<R>, motion: &Motion<R>) -> Reading {
    Reading {
        state: <[R; 4]>::from(*state).map(R::to_f64),
        velocities: [motion.w1.to_f64(), motion.w2.to_f64()],
        energy: pendulum.energy(state).to_f64(),
    }
}

#[derive(Clone, Copy, Debug)]
struct General<R> {
    pendulum: Pendulum<R>,
    step_size: R,
    state: State<R>,
}

impl<R: Real> Run for General<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, start, step_size) = rounded(request);
        start.check()?;
        let pendulum = Pendulum::new(parameters)?;
        pendulum.check_step(step_size)?;
        let state = pendulum.state(&start);
        state.check()?;
        Ok(Self { pendulum, step_size, state })
    }

    fn step(&mut self) {
        self.state = self.pendulum.step(&self.state, self.step_size);
    }

    fn reading(&self) -> Reading {
        reading(&self.pendulum, &self.state, &self.pendulum.motion(&self.state))
    }
}

/// As [`General`], stepped in the units of the equal-rod form.
#[derive(Clone, Copy, Debug)]
struct Equal<R> {
    rods: EqualRods<R>,
    units: Units<R>,
    state: State<R>,
    /// In units of time.
    step_size: R,
    si: Pendulum<R>,
}

impl<R: Real> Run for Equal<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let General { pendulum, step_size, state } = General::<R>::start(request)?;
        let units = Units::of(pendulum.parameters())?;
        let rods = EqualRods::new(pendulum.parameters().mass_ratio())?;
        Ok(Self { rods, units, state: units.from_si(&state), step_size: step_size / units.time, si: pendulum })
    }

    fn step(&mut self) {
        self.state = self.rods.step(&self.state, self.step_size);
    }

    fn reading(&self) -> Reading {
        let state = self.units.to_si(&self.state);
        reading(&self.si, &state, &self.si.motion(&state))
    }
}

/// The closed form: a step costs nothing, only a reading does.
#[derive(Clone, Copy, Debug)]
struct Linear<R> {
    oscillations: SmallOscillations<R>,
    pendulum: Pendulum<R>,
    /// In f64, so that the time is rounded once.
    step_size: f64,
    steps: u32,
}

impl<R: Real> Run for Linear<R> {
    fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, start, _) = rounded(request);
        start.check()?;
        let pendulum = Pendulum::new(parameters)?;
        let oscillations = SmallOscillations::new(Modes::new(&parameters)?, &start);
        Ok(Self { oscillations, pendulum, step_size: request.step_size, steps: 0 })
    }

    fn step(&mut self) {
        self.steps = self.steps.wrapping_add(1);
    }

    fn reading(&self) -> Reading {
        let motion = self.oscillations.at(R::of(f64::from(self.steps) * self.step_size));
        reading(&self.pendulum, &self.pendulum.state(&motion), &motion)
    }
}
