//! Small oscillations as a scene draws them.

use double_pendulum::{Direction, Modes, Pendulum, Real, SmallOscillations, State};

use super::run::{Run, rounded};
use super::{JobError, Request};

/// The directions of the rods at every step.
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
    fn time(&self) -> f64 {
        f64::from(self.steps) * self.dt
    }
}

impl Run for Drawn {
    fn start(request: &Request) -> Result<Self, JobError> {
        let (parameters, start) = rounded::<f32>(request);
        start.check()?;
        let pendulum = Pendulum::new(&parameters.cast())?;
        let oscillations = SmallOscillations::new(Modes::new(&parameters.cast())?, &start);
        Ok(Self { oscillations, directions: oscillations.directions(0.0), pendulum, dt: request.dt, steps: 0 })
    }

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
