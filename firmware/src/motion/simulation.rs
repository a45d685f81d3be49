//! The simulation of the motion of a scene, and the error of its energy.

use double_pendulum::plan::{Costs, PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Method, Parameter, Pendulum, State};

use crate::config::{Processor, TICK_RATE};
use crate::graphics::Format;
use crate::motion::Settings;

/// The processor and the method for computing a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resources {
    /// The price list and the budgets, processor cycles.
    pub processor: Processor,
    /// The requested method; `None` leaves the choice to the plan.
    pub method: Option<Method>,
    /// The format of the panel.
    pub format: Format,
}

/// A motion in progress. A tick is 1/60 s of it.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The energy at the start.
    pub energy: Energy,
    /// The motion. It is for reading only; [`tick`](Self::tick) advances it.
    pub motion: PlannedRun,
    /// True if no method that resolves the motion is within the budget of a frame. Then `motion` is
    /// only the pose at the start, and must not be advanced. It is never true with a requested
    /// method.
    pub is_too_fast: bool,
}

impl Simulation {
    /// Creates a simulation at its start, computed by the requested method with the step count of
    /// [`Stepping::of`] or, without one, by [`Stepping::initial`]. The steps of a requested RK4
    /// method may be too long to resolve the motion. Without a requested method, a motion that is
    /// only too fast is no error, but sets [`is_too_fast`](Self::is_too_fast).
    ///
    /// # Errors
    ///
    /// Refuses settings that describe no pendulum or no finite start, a motion that the method
    /// refuses, and a step that is unstable for small oscillations ([`Pendulum::check_step`]).
    /// Returns [`Error::TooLarge`] with [`Parameter::Cost`] if the requested method costs more than
    /// the budget of a frame, or is not in [`Method::DRAWN`].
    pub fn new(
        settings: &Settings,
        &Resources {
            ref processor,
            method,
            format,
        }: &Resources,
    ) -> Result<Self, Error> {
        let (pendulum, _) = settings.start()?;
        let problem = settings.problem(format.height.into());
        let initial = match method {
            Some(method) => {
                let stepping = Stepping::of(&problem, method)?;
                Some(affordable(stepping, &problem, processor)?)
            }
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

    /// Advances the motion by one tick, 1/60 s. It must not be [too fast](Self::is_too_fast), which
    /// is not checked. A motion that diverges is not reported here; numbers of its state are then
    /// not finite, by `rk4-fixed32` up to 32 steps late, and stay so, but its directions may look
    /// valid.
    pub fn tick(&mut self) {
        // A motion that has diverged is detected by its state.
        let _is_lost = self.motion.advance(1);
    }

    /// Returns the cost of a tick by these prices.
    pub fn cost(&self, costs: &Costs) -> f32 {
        costs.of_frame(self.motion.stepping())
    }

    /// Returns the number of frames, 1/60 s each, since the start of the scene.
    pub fn frame(&self) -> u64 {
        self.motion.frame()
    }
}

/// Refuses a method and step count that cost more than a frame may. Frames would come late, and
/// with enough steps the watchdog would reset the board.
fn affordable(
    stepping: Stepping,
    problem: &Problem,
    processor: &Processor,
) -> Result<Stepping, Error> {
    let costs = processor.costs.for_pendulum(&problem.pendulum);
    let cost = costs.of_frame(stepping);
    if cost > processor.frame {
        return Err(Error::TooLarge {
            parameter: Parameter::Cost,
            value: cost.into(),
            limit: processor.frame.into(),
        });
    }
    Ok(stepping)
}

/// A motion by another method and step count that starts again and catches up with the motion that
/// is shown.
///
/// The number of ticks that it takes depends only on prices and on the number of frames to catch up,
/// so it is the same on every board of a processor class.
#[derive(Clone, Debug)]
pub struct CatchingUp {
    motion: PlannedRun,
    /// The cost of a frame.
    cost: f32,
}

impl CatchingUp {
    /// Creates the motion of `settings` at its start, by `stepping`.
    ///
    /// # Errors
    ///
    /// Refuses what [`Settings::run`] refuses.
    pub fn new(
        settings: &Settings,
        stepping: Stepping,
        processor: &Processor,
    ) -> Result<Self, Error> {
        let costs = processor.costs.for_pendulum(&settings.parameters.cast());
        Ok(Self {
            motion: settings.run(0.0, stepping)?,
            cost: costs.of_frame(stepping).max(processor.piece()),
        })
    }

    /// Returns the number of frames of 1/60 s that `cycles` pay for in a tick of the clock in which
    /// the motion that is shown advances by `due`. With fewer than one more it would never catch up.
    fn frames(&self, due: u32, cycles: f32) -> u32 {
        ((cycles / self.cost) as u32).max(due + 1)
    }

    /// Returns the method and step count.
    pub fn stepping(&self) -> Stepping {
        self.motion.stepping()
    }

    /// Returns the time, s since the start of the scene, when the motion has caught up that starts
    /// in tick `ticks` of the scene, if all ticks are like this one. It may be a few ticks later.
    pub fn arrival(&self, ticks: u64, due: u32, cycles: f32) -> f64 {
        let frames = self.frames(due, cycles);
        ticks as f64 / f64::from(TICK_RATE) * f64::from(frames) / f64::from(frames - due)
    }

    /// Advances by the frames of a tick of the clock that `cycles` pay for, in which `simulation`
    /// has advanced by `due`, but not beyond `simulation`. Returns true if it has caught up with it.
    /// Then `simulation` continues with this motion. A motion that diverges is not reported here.
    /// Not checked: both motions have the same settings.
    pub fn tick(&mut self, simulation: &mut Simulation, due: u32, cycles: f32) -> bool {
        for _ in 0..self.frames(due, cycles) {
            if self.motion.frame() < simulation.frame() {
                let _is_lost = self.motion.advance(1);
            }
        }

        let is_there = self.motion.frame() == simulation.frame();
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
    /// Computes the energy of the start that `settings` describe.
    ///
    /// Angles and velocities that are not finite are accepted. The energy at the start is then NaN
    /// or infinite, and [`error`](Self::error) returns 0 or NaN, respectively.
    ///
    /// # Errors
    ///
    /// Refuses masses, lengths and gravity that [`Pendulum::new`] refuses.
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        let pendulum = Pendulum::new(&settings.parameters)?;
        let start = pendulum.energy_above_rest(&pendulum.to_state(&settings.motion()));
        Ok(Self { pendulum, start })
    }

    /// Returns the relative energy error (E - E0)/(E0 - Emin) of the motion now, from its own
    /// numbers, before they are rounded for the report. E0 is the energy at the start, and Emin
    /// that of hanging at rest. Returns 0 if the start is hanging at rest, which a motion never
    /// leaves, or if E0 is NaN. Otherwise the error of a diverged motion is not finite, by
    /// `rk4-fixed32` up to 32 steps late. Not checked: `motion` is of the same pendulum.
    pub fn error(&self, motion: &PlannedRun) -> f32 {
        self.relative(motion.energy_above_rest(&self.pendulum))
    }

    /// Returns the same relative error of a motion that is in this state, in SI units (rad, kg
    /// m^2/s), now. It is 0 if the start is hanging at rest or its energy is NaN, and otherwise not
    /// finite for a state that is not finite.
    pub fn error_of_state(&self, state: &State<f32>) -> f32 {
        self.relative(self.pendulum.energy_above_rest(&state.cast()))
    }

    /// Returns the relative error of an energy above rest, J.
    fn relative(&self, energy: f64) -> f32 {
        if self.start > 0.0 {
            ((energy - self.start) / self.start) as f32
        } else {
            0.0
        }
    }

    /// Returns the energy E, J, that has this relative [`error`](Self::error), (E - E0)/(E0 -
    /// Emin). The potential is zero at the pivot. An error or an E0 that is not finite gives an
    /// energy that is not finite, and so does an energy out of the range of `f32`. If the start is
    /// hanging at rest, every finite error gives Emin.
    pub fn of_error(&self, error: f32) -> f32 {
        let above_rest = self.start + f64::from(error) * self.start;
        (self.pendulum.least_energy() + above_rest) as f32
    }
}
