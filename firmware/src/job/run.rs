//! What a row of the table is: a motion that can be started, stepped and read.

use double_pendulum::{
    Direction, Error, Form, Integrator, Modes, Motion, Parameters, Pendulum, Real, SmallOscillations, State,
};

use super::Request;

/// One motion under way, with all that its arithmetic carries along: the one trait that a new row's type implements.
pub trait Run: Copy {
    /// Makes `steps` steps. How they are dealt out to calls makes no difference to any bit.
    fn advance(&mut self, steps: u32);

    /// The canonical state now, SI units, to the last digit carried; of the angles, whole turns may be missing where there
    /// are [`sides`](Self::sides).
    fn state(&self) -> State<f64>;

    /// The signs of the rods' directions, if somebody has to count whole turns by them.
    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        None
    }

    /// Gives `feed` the bit patterns of all that is carried from step to step.
    fn bits(&self, feed: impl FnMut(u64));
}

/// At step 0, with the request's angles and velocities; refuses what the kernel refuses.
#[inline(never)]
pub(super) fn start<F: Form>(request: &Request) -> Result<F, Error> {
    let checked = if request.method.is_single() { checked::<f32> } else { checked::<f64> };
    let (parameters, state) = checked(request)?;
    Form::new(&parameters, &state, request.dt)
}

/// By any method of the kernel that makes steps.
impl<F: Form> Run for F {
    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        Form::advance(self, steps);
    }

    fn state(&self) -> State<f64> {
        Form::state(self)
    }

    fn sides(&self) -> Option<[[i32; 2]; 2]> {
        (!F::HAS_TURNS).then(|| Form::sides(self))
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        Form::bits(self, feed);
    }
}

/// The request's numbers in the arithmetic `R`, each rounded once.
fn rounded<R: Real>(request: &Request) -> (Parameters<R>, Motion<R>) {
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    (request.parameters.cast(), Motion { a1, a2, w1, w2 }.cast())
}

/// The pendulum and its state at the start, checked and computed in the arithmetic `R`.
#[inline(never)] // flash has room for one of it, not for one of each row
fn checked<R: Real>(request: &Request) -> Result<(Parameters<f64>, State<f64>), Error> {
    let (parameters, start) = rounded::<R>(request);
    start.check()?;
    let pendulum = Pendulum::new(&parameters)?;
    if request.method.integrator() != Integrator::ClosedForm {
        pendulum.check_step(request.dt)?;
    }
    let state = pendulum.to_state(&start);
    state.check()?;
    Ok((parameters.cast(), state.cast()))
}

/// Small oscillations as a scene draws them: the directions of the rods at every step.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    oscillations: SmallOscillations<f32>,
    directions: [Direction<f32>; 2],
    /// In f64, so that no digit of the velocities is lost in the momenta.
    pendulum: Pendulum<f64>,
    dt: f64,
    steps: u32,
}

impl Drawn {
    /// As [`start`].
    pub(super) fn start(request: &Request) -> Result<Self, Error> {
        let (parameters, start) = rounded::<f32>(request);
        start.check()?;
        let pendulum = Pendulum::new(&parameters.cast())?;
        let oscillations = SmallOscillations::new(Modes::new(&parameters.cast())?, &start);
        Ok(Self { oscillations, directions: oscillations.directions(0.0), pendulum, dt: request.dt, steps: 0 })
    }

    fn time(&self) -> f64 {
        f64::from(self.steps) * self.dt
    }
}

impl Run for Drawn {
    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.steps = self.steps.wrapping_add(1);
            self.directions = self.oscillations.directions(self.time());
        }
    }

    fn state(&self) -> State<f64> {
        self.pendulum.to_state(&self.oscillations.at(self.time()).cast())
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.directions.iter().flatten().for_each(|x| feed(x.bits()));
    }
}
