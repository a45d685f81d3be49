//! The motion that a plan computes.

use super::{Problem, Stepping};
use crate::error::Error;
use crate::methods::any::{Motion32, Motion64};
use crate::methods::{Advance, DrawnMotion, FormOperations};
use crate::pendulum::{Direction, Pendulum, State};
use crate::table::Method;

/// The directions of both rods for drawing: `[[sin a1, cos a1], [sin a2, cos a2]]`.
pub(super) type Directions = [Direction<f32>; 2];

/// A motion in progress, frame by frame, by the method of a plan.
///
/// It is bit-identical to the motion that the search has measured. After [`advance`](Self::advance)
/// has returned an error, directions, states and energies are meaningless, and may look valid.
///
/// Whole turns are not counted: a picture does not show them, and in `f32` on a Cortex-M4F the count
/// takes nearly as long as a step. [`Run`](crate::Run) counts them on request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedRun {
    stepping: Stepping,
    rate: u16,
    /// The number of frames since the start.
    frame: u64,
    motion: DrawnMotion,
}

impl PlannedRun {
    /// Creates the motion of `problem` at its start, by the method and the steps per frame of the
    /// [`Stepping`]. A step count of 0 counts as 1, and so does any step count of the closed form.
    /// The tolerance and the duration are not used.
    ///
    /// # Errors
    ///
    /// Refuses a start that is not finite, the inputs that [`Pendulum::new`] and [`Pendulum::run`]
    /// refuse, for the closed form a pendulum without normal modes, and methods that are not in
    /// [`Method::DRAWN`]. A rate of 0 is refused as a step that is not finite. Unlike
    /// [`Pendulum::run`], it accepts steps beyond the limit of stability, except by
    /// [`Method::Rk4Fixed32`]. [`Method::Extrapolation10Fixed64`] refuses steps beyond the limit of
    /// [`Fixed64`](crate::Fixed64) only. For a step that is too long, [`Error::TooLarge`] contains
    /// the longest, s.
    #[inline(never)] // Counted by its name, as the price of a preparation.
    pub fn new(
        &Problem {
            pendulum,
            start,
            rate,
            ..
        }: &Problem,
        stepping: Stepping,
    ) -> Result<Self, Error> {
        start.check()?;

        // A frame has at least one step; the closed form computes it in exactly one.
        let is_closed = stepping.method == Method::ClosedFormF32;
        let steps = if stepping.steps == 0 || is_closed {
            1
        } else {
            stepping.steps
        };

        // The steps divide the time of a frame equally.
        let state = Pendulum::new(&pendulum)?.to_state(&start);
        let stepping = Stepping { steps, ..stepping };
        let motion = DrawnMotion::new(stepping.method, &pendulum, &state, stepping.dt(rate))?;
        Ok(Self {
            stepping,
            rate,
            frame: 0,
            motion,
        })
    }

    /// Returns the method and its number of steps per frame, which is at least 1, and always 1 for
    /// the closed form.
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        self.stepping
    }

    /// Advances the motion by `frames` frames; 0 only checks it.
    ///
    /// # Errors
    ///
    /// Returns [`Error::Diverged`] if the motion has left the finite numbers, or the range of its
    /// fixed point. Every later call then returns it, too. The call does not end early, and all
    /// frames are counted. [`Method::Rk4Fixed32`] tests its range after every 32 steps since the
    /// start, so that the error may come up to 32 steps late.
    ///
    /// Unlike [`Run::advance`](crate::Run::advance), it checks no energy in `f32`: a motion whose
    /// numbers are finite but meaningless is accepted.
    pub fn advance(&mut self, frames: u32) -> Result<(), Error> {
        for _ in 0..frames {
            self.motion.advance(self.stepping.steps);
        }

        self.frame += u64::from(frames);
        self.motion.check()
    }

    /// Returns the number of frames since the start.
    #[doc(hidden)] // For the firmware's reports.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// Returns the time since the start, s: the number of frames divided by the rate.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.frame as f64 / f64::from(self.rate)
    }

    /// Returns the directions of both rods: `[[sin a1, cos a1], [sin a2, cos a2]]`. Their lengths
    /// are 1 up to the errors of the method, which reach 4e-4 by the closed form.
    ///
    /// By RK4 in `f32` they may be up to half a step ahead of the [`time`](Self::time), or behind
    /// it.
    #[must_use]
    pub fn directions(&self) -> [Direction<f32>; 2] {
        self.motion.directions()
    }

    /// Returns the canonical state in SI units, rounded to `f32`, at the time of the
    /// [`directions`](Self::directions), with angles in [-pi, pi]. A momentum beyond the range of
    /// `f32` is infinite.
    ///
    /// This is enough for a picture, and costs far less than [`state`](Self::state) on a processor
    /// whose `f64` is software.
    #[must_use]
    pub fn rounded_state(&self) -> State<f32> {
        let [a1, a2] = self.directions().map(|[s, c]| libm::atan2f(s, c));
        let [p1, p2] = self.motion.momenta();
        State { a1, a2, p1, p2 }
    }

    /// Returns the energy above rest, J, of the motion as it is carried: nothing is rounded to
    /// `f32`. It is that at the time of the [`directions`](Self::directions). `pendulum` must be
    /// the pendulum of the problem; another one gives a wrong energy.
    #[doc(hidden)] // For the firmware's reports.
    #[must_use]
    pub fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        self.motion.energy_above_rest(pendulum)
    }

    /// Returns the canonical state in SI units at the [`time`](Self::time), with all digits that
    /// the method carries. The angles are within [-pi, pi], except by the closed form.
    #[must_use]
    pub fn state(&self) -> State<f64> {
        self.motion.state()
    }
}

/// A motion in a race, which is advanced from frame to frame, a few steps at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run<M> {
    pub stepping: Stepping,
    /// The number of steps since the last frame.
    made: u32,
    /// The motion; `None` until it is prepared.
    pub motion: Option<M>,
}

impl Run<Motion32> {
    /// Prepares the motion of a problem at `start`.
    pub fn prepare(&mut self, problem: &Problem, start: &State<f64>) -> Result<(), Error> {
        let dt = self.stepping.dt(problem.rate);
        let method = self.stepping.method;
        self.motion = Some(Motion32::new(method, &problem.pendulum, start, dt)?);
        Ok(())
    }
}

impl Run<Motion64> {
    /// Prepares the motion of a problem at `start`.
    pub fn prepare(&mut self, problem: &Problem, start: &State<f64>) -> Result<(), Error> {
        let dt = self.stepping.dt(problem.rate);
        self.motion = Some(FormOperations::new(&problem.pendulum, start, dt)?);
        Ok(())
    }
}

impl<M: Advance> Run<M> {
    /// Creates a run whose motion is not prepared yet.
    pub fn new(stepping: Stepping) -> Self {
        Self {
            stepping,
            made: 0,
            motion: None,
        }
    }

    /// Takes steps towards the next frame, at `price` each, for the caller to make: as many as the
    /// rest of `cost` pays for after `spent`, but at least one if nothing is spent yet. Returns
    /// their number.
    pub fn take(&mut self, price: f32, cost: f32, spent: f32) -> u32 {
        let affordable = ((cost - spent) / price) as u32;
        let least = u32::from(spent == 0.0);
        let steps = (self.stepping.steps - self.made).min(affordable.max(least));
        self.made += steps;
        steps
    }

    /// Makes the steps that [`take`](Self::take) returns, and returns their cost.
    pub fn advance(&mut self, price: f32, cost: f32, spent: f32) -> f32 {
        let steps = self.take(price, cost, spent);
        if let Some(motion) = &mut self.motion {
            motion.advance(steps);
        }
        price * steps as f32
    }

    /// Returns true if the motion has arrived at the next frame.
    pub fn is_there(&self) -> bool {
        self.made == self.stepping.steps
    }

    /// Returns the directions in the frame, and begins the next one. They are NaN if the motion has
    /// diverged.
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        let motion = self.motion.as_ref().filter(|motion| motion.check().is_ok());
        motion.map_or([[f32::NAN; 2]; 2], Advance::directions)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Parameters};

    /// At three frames per second, a motion of 300 rad/s in one step per frame leaves the finite
    /// numbers of `f32` within 10,000 frames. That is reported then and by every later call.
    #[test]
    fn diverged_motion_is_reported_for_ever() -> Result<(), Error> {
        let problem = Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
            start: Motion {
                a1: 3.0,
                a2: 1.0,
                w1: 300.0,
                w2: -300.0,
            },
            tolerance: 0.01,
            duration: 1e4,
            rate: 3,
        };
        for method in [Method::Rk4F32DirectionPlain, Method::Rk4F32Direction] {
            let mut run = PlannedRun::new(&problem, Stepping { method, steps: 1 })?;
            let lost = (0..10_000).find_map(|_| run.advance(1).err());
            for error in [lost, run.advance(0).err(), run.advance(1).err()] {
                assert!(matches!(error, Some(Error::Diverged { .. })), "{error:?}");
            }
        }
        Ok(())
    }
}
