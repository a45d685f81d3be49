//! The motion itself, apart from any frame of it, and what its energy has become.

use double_pendulum::plan::{PlannedRun, Stepping};
use double_pendulum::{Error, Method, Parameter, Pendulum, State};

use crate::config::Processor;
use crate::graphics::{HEIGHT, RodDirections};
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
    /// To be read: only [`tick`](Self::tick) moves it.
    pub motion: PlannedRun,
}

impl Simulation {
    /// At the start: by the method that is asked for, else by the stepping expected to stay right longest before anything is
    /// planned. The kernel's error if the pendulum is too quick for what may be spent.
    pub fn new(
        settings: &Settings,
        &Resources {
            ref processor,
            method,
        }: &Resources,
    ) -> Result<Self, Error> {
        let (pendulum, start) = settings.start()?;
        let problem = settings.problem(HEIGHT as f32);
        let stepping = match method {
            Some(method) => affordable(Stepping::of(&problem, method)?, processor)?,
            None => Stepping::lasting(&problem, &processor.costs, processor.frame)?,
        };
        pendulum.check_step(1.0 / (f64::from(problem.rate) * f64::from(stepping.steps)))?;
        let motion = settings.run(0.0, stepping)?;
        Ok(Self {
            energy: Energy::new(pendulum, motion.directions(), &start),
            motion,
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

/// The energy a motion started with, to hold what it has become against.
#[derive(Clone, Debug)]
pub struct Energy {
    pub pendulum: Pendulum<f32>,
    /// J.
    pub start: f32,
}

impl Energy {
    pub fn new(pendulum: Pendulum<f32>, directions: RodDirections, start: &State<f32>) -> Self {
        let start = pendulum.energy_at(directions, [start.p1, start.p2]);
        Self { pendulum, start }
    }

    /// (E - E0)/(E0 - Emin), with E0 the energy at the start and Emin that of hanging at rest; 0 if the start is
    /// hanging at rest, which it never leaves. Rods that point to these `directions` now have the momenta of `state`.
    pub fn error(&self, directions: RodDirections, state: &State<f32>) -> f32 {
        let energy = self.pendulum.energy_at(directions, [state.p1, state.p2]);
        let scale = self.start - self.pendulum.least_energy();
        if scale > 0.0 {
            (energy - self.start) / scale
        } else {
            0.0
        }
    }

    /// The energy, J, that has this [`error`](Self::error).
    pub fn of_error(&self, error: f32) -> f32 {
        self.start + error * (self.start - self.pendulum.least_energy())
    }
}
