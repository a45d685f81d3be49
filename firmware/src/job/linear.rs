//! Small oscillations in closed form.

use double_pendulum::{Direction, Modes, Motion, Pendulum, Real, SmallOscillations, State};

use super::run::{Run, rounded};
use super::{JobError, Request};

/// A step costs nothing, only a reading does.
#[derive(Clone, Copy, Debug)]
pub struct Linear<R> {
    oscillations: SmallOscillations<R>,
    /// In f64, so that no digit of the velocities is lost in the momenta.
    pendulum: Pendulum<f64>,
    dt: f64,
    steps: u32,
}

impl<R: Real> Linear<R> {
    fn time(&self) -> f64 {
        f64::from(self.steps) * self.dt
    }

    fn motion(&self) -> Motion<R> {
        self.oscillations.at(self.time())
    }
}

impl<R: Real> Run for Linear<R> {
    fn start(request: &Request) -> Result<Self, JobError> {
        let (parameters, start) = rounded(request);
        start.check()?;
        let pendulum = Pendulum::new(&parameters.cast())?;
        let oscillations = SmallOscillations::new(Modes::new(&parameters.cast())?, &start);
        Ok(Self { oscillations, pendulum, dt: request.dt, steps: 0 })
    }

    fn advance(&mut self, steps: u32) {
        self.steps = self.steps.wrapping_add(steps);
    }

    fn state(&self) -> State<f64> {
        self.pendulum.to_state(&self.motion().cast())
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        let Motion { a1, a2, w1, w2 } = self.motion();
        [a1, a2, w1, w2].map(R::bits).into_iter().for_each(feed);
    }
}

/// The directions of the rods at every step: what a scene draws.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    linear: Linear<f32>,
    directions: [Direction<f32>; 2],
}

impl Run for Drawn {
    fn start(request: &Request) -> Result<Self, JobError> {
        let linear = Linear::start(request)?;
        Ok(Self { linear, directions: linear.oscillations.directions(0.0) })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.linear.advance(1);
            self.directions = self.linear.oscillations.directions(self.linear.time());
        }
    }

    fn state(&self) -> State<f64> {
        self.linear.state()
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.directions.iter().flatten().for_each(|x| feed(x.bits()));
    }
}
