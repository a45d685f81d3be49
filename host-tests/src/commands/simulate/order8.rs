//! Steps of order 8, computed on the host only: a motion to 1e-12 rad at a price that few chips can pay.

use std::io;

use anyhow::{anyhow, ensure};
use double_pendulum::form::{DirectionForm8, UnwrappedStepper};
use double_pendulum::{Motion, Pendulum, State};
use firmware::job::{self, Arithmetic, Model, Reading};

use super::{Method, Options, Place, Plan};

/// Refuses what does not go with order 8, naming --method.
pub fn check(options: &Options, form: job::Formulation) -> anyhow::Result<()> {
    let Options { arithmetic, model, place, .. } = options;
    let method = Method::Order8.name();
    let not_with = |option: &str, value: &str| anyhow!("--method {method}: not with {option} {value}");
    ensure!(*arithmetic == Arithmetic::F64, not_with("--arithmetic", arithmetic.name()));
    ensure!(*model == Model::General, not_with("--model", model.name()));
    ensure!(form != job::Formulation::Angle, not_with("--form", form.name()));
    match place {
        Place::Host => Ok(()),
        Place::Board(board) => Err(not_with("--on", board.name)),
    }
}

/// Something that steps.
trait Steps {
    fn step(&mut self);
    fn state(&self) -> State<f64>;
}

/// The canonical state, as one writes it down.
struct Canonical {
    pendulum: Pendulum<f64>,
    state: State<f64>,
    dt: f64,
}

impl Steps for Canonical {
    fn step(&mut self) {
        self.state = self.pendulum.step_of_order_8(&self.state, self.dt);
    }
    fn state(&self) -> State<f64> {
        self.state
    }
}

/// The direction form with its turns counted.
impl Steps for UnwrappedStepper<f64, DirectionForm8<f64>> {
    fn step(&mut self) {
        self.advance(1);
    }
    fn state(&self) -> State<f64> {
        UnwrappedStepper::state(self)
    }
}

/// Computes the motion and gives each reading to `row`.
pub fn run(plan: &Plan, mut row: impl FnMut(&Reading) -> io::Result<()>) -> anyhow::Result<()> {
    let request = &plan.request;
    let pendulum = Pendulum::new(request.parameters)?;
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let start = pendulum.to_state(&Motion { a1, a2, w1, w2 });
    let dt = request.dt;
    let mut steps: Box<dyn Steps> = match request.form {
        job::Formulation::Direction => {
            Box::new(UnwrappedStepper::<f64, DirectionForm8<f64>>::new(&request.parameters, &start, dt)?)
        }
        _ => Box::new(Canonical { pendulum, state: start, dt }),
    };
    for sample in 0..=request.samples {
        if sample > 0 {
            (0..request.stride).for_each(|_| steps.step());
        }
        let state = steps.state().finite()?;
        let motion = pendulum.to_motion(&state);
        let velocities = [motion.w1, motion.w2];
        row(&Reading { state: state.into(), velocities, energy: pendulum.energy(&state) })?;
    }
    Ok(())
}
