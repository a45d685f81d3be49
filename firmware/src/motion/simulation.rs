//! The motion itself, apart from any frame of it, and what its energy has become.

use double_pendulum::plan::{PlannedRun, Stepping};
use double_pendulum::{Error, Method, Parameter, Pendulum, State};

use crate::config::Processor;
use crate::graphics::HEIGHT;
use crate::motion::Settings;

/// What a motion may be computed by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resources {
    /// What steps cost, and what may be spent.
    pub processor: Processor,
    /// The method that is asked for; `None` leaves it to the plan.
    pub method: Option<Method>,
}

/// A pendulum in motion since its last restart.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub energy: Energy,
    /// The motion, to be read: only [`tick`](Self::tick) advances it.
    pub motion: PlannedRun,
    /// True if a frame pays for no method that resolves the motion. Then `motion` is only a pose.
    pub is_too_fast: bool,
}

impl Simulation {
    /// Creates a simulation at its start, computed by the requested method or, without one, by
    /// [`Stepping::initial`].
    ///
    /// # Errors
    ///
    /// Refuses settings that describe no pendulum, and a motion that the requested method refuses.
    pub fn new(
        settings: &Settings,
        &Resources {
            ref processor,
            method,
        }: &Resources,
    ) -> Result<Self, Error> {
        let (pendulum, _) = settings.start()?;
        let problem = settings.problem(HEIGHT as f32);
        let initial = match method {
            Some(method) => Some(affordable(Stepping::of(&problem, method)?, processor)?),
            None => Stepping::initial(&problem, &processor.costs, processor.frame)?,
        };
        let stepping = match initial {
            Some(stepping) => stepping,
            None => Stepping::of(&problem, Method::Rk4F32Direction)?,
        };
        pendulum.check_step(1.0 / (f64::from(problem.rate) * f64::from(stepping.steps)))?;
        Ok(Self {
            energy: Energy::new(settings)?,
            motion: settings.run(0.0, stepping)?,
            is_too_fast: initial.is_none(),
        })
    }

    #[inline(never)] // one copy
    pub fn tick(&mut self) {
        // A motion that is lost is seen by its state.
        let _is_lost = self.motion.advance(1);
    }
}

/// Refuses a method and step count that cost more than a frame may. Frames would come late, and
/// with enough steps the watchdog would reset the board.
fn affordable(stepping: Stepping, processor: &Processor) -> Result<Stepping, Error> {
    let cost = processor.costs.of_frame(stepping);
    if cost > processor.frame {
        return Err(Error::TooLarge {
            parameter: Parameter::Cost,
            value: cost.into(),
            limit: processor.frame.into(),
        });
    }
    Ok(stepping)
}

/// A motion by another stepping, from the start until it has caught up: after a number of ticks that depends only on what the
/// stepping costs.
#[derive(Clone, Debug)]
pub struct CatchingUp {
    motion: PlannedRun,
    /// Frames in a tick.
    most: u32,
}

impl CatchingUp {
    pub fn new(
        settings: &Settings,
        stepping: Stepping,
        processor: &Processor,
    ) -> Result<Self, Error> {
        let frame = processor.costs.of_frame(stepping).max(processor.piece());
        let affordable = (processor.look_ahead / frame) as u32;
        // With fewer frames in a tick nothing catches up.
        Ok(Self {
            motion: settings.run(0.0, stepping)?,
            most: affordable.max(2),
        })
    }

    /// Makes a tick's frames; whether it has caught up with `simulation`, which then goes on as this.
    pub fn tick(&mut self, simulation: &mut Simulation) -> bool {
        for _ in 0..self.most {
            if self.motion.frame() < simulation.motion.frame() {
                let _is_lost = self.motion.advance(1);
            }
        }
        let is_there = self.motion.frame() == simulation.motion.frame();
        if is_there {
            simulation.motion = self.motion;
        }
        is_there
    }
}

/// The energy of a motion at its start, to compare its later energy with.
///
/// Energies are in `f64` and above that of hanging at rest, K = E - Emin, a sum of terms none of
/// which is negative. So the error of a motion in 64 bits is known to a few roundings of `f64`,
/// however small its swings are.
#[derive(Clone, Debug)]
pub struct Energy {
    pendulum: Pendulum<f64>,
    /// K at the start, J.
    start: f64,
}

impl Energy {
    /// Returns the energy of the start that `settings` describe.
    ///
    /// # Errors
    ///
    /// Refuses settings that describe no pendulum.
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        let pendulum = Pendulum::new(&settings.parameters.cast())?;
        let start = pendulum.energy_above_rest(&pendulum.to_state(&settings.motion().cast()));
        Ok(Self { pendulum, start })
    }

    /// Returns (E - E0)/(E0 - Emin) of the motion as it is computed, not as its numbers are
    /// rounded for the report; 0 if the start is hanging at rest, which a motion never leaves.
    pub fn error(&self, motion: &PlannedRun) -> f32 {
        self.relative(motion.energy_above_rest(&self.pendulum))
    }

    /// Returns the same of a motion that is in this state now.
    pub fn error_of_state(&self, state: &State<f32>) -> f32 {
        self.relative(self.pendulum.energy_above_rest(&state.cast()))
    }

    fn relative(&self, energy: f64) -> f32 {
        if self.start > 0.0 {
            ((energy - self.start) / self.start) as f32
        } else {
            0.0
        }
    }

    /// Returns the energy E, J, that has this [`error`](Self::error).
    pub fn of_error(&self, error: f32) -> f32 {
        let above_rest = self.start + f64::from(error) * self.start;
        (self.pendulum.least_energy() + above_rest) as f32
    }
}
