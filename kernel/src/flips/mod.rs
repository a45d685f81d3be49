//! When a rod first turns over: the map of flips.
//!
//! A start from rest is two angles, so all starts of a pendulum are a square, and the time of the first turn-over is a
//! picture of it (J. S. Heyl, "The double pendulum fractal", 2008). A rod turns over when its angle passes plus or minus pi.
//! Where the energy forbids that ([`Pendulum::cannot_turn_over`]) no step is made.
//!
//! ```
//! use double_pendulum::{DirectionF32Plain, Parameters};
//! use double_pendulum::flips::{Flip, Flips, step_size};
//!
//! let pendulum = Parameters::equal_rods(1.0_f32, 1.0, 9.81);
//! let dt = step_size(&pendulum)?;
//! let map = Flips::<DirectionF32Plain>::new(&pendulum, dt, (10.0 / dt) as u32)?;
//! assert_eq!(map.of(0.5, 1.0)?, Flip::Never);
//! assert!(matches!(map.of(2.0, 2.5)?, Flip::After(time) if (time - 4.0).abs() < 0.05));
//! # Ok::<(), double_pendulum::Error>(())
//! ```

mod lanes;
mod side_by_side;

use crate::error::Error;
use crate::methods::Form;
use crate::methods::run::turns_over;
use crate::numbers::Real;
use crate::pendulum::{Parameters, Pendulum, State};

/// When a rod first turns over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flip<R> {
    /// Never: there is not the energy for it.
    Never,
    /// So long after the start, s.
    After(R),
    /// Not within the time it was waited for.
    Later,
}

/// A pendulum, a step and how many of them to wait for: configuration for any number of starts.
///
/// The passage is seen by the signs of sine and cosine after each step, its time is interpolated between two steps,
/// linearly in the sine. The cost is that of the form's step and some 15 operations. How many starts are judged right with steps of
/// [`step_size`] the repository's tests assert: of equal rods and bobs 99.9 % within 10 sqrt(l/g), in any arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flips<F: Form> {
    pendulum: Pendulum<F::Real>,
    /// The motion from straight up, which has the most energy.
    highest: F,
    dt: F::Real,
    steps: u32,
}

/// A motion that has not turned over yet.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Falling<F: Form> {
    motion: F,
    /// The sides of the rods after the last step ([`Form::sides`]).
    sides: [[i32; 2]; 2],
    #[doc(hidden)]
    pub steps: u32,
}

/// The longest step, s, that resolves what a pendulum does wherever it is let go: twice the
/// [admissible](Pendulum::admissible_step) one from straight up, and with a light bob 2 what [`Fixed32`] takes.
///
/// Refuses what [`Pendulum::new`] refuses, and no gravity, with which nothing moves.
///
/// [`Fixed32`]: crate::Fixed32
pub fn step_size<R: Real>(parameters: &Parameters<R>) -> Result<f64, Error> {
    /// Half a turn of the elbow's greatest rate takes nine such steps.
    const BEND: f64 = 0.36;
    let pendulum = Pendulum::new(parameters)?;
    let highest = State::at_rest(R::PI, R::PI);
    let resolved = pendulum.admissible_step(&highest)?.twice();
    let bent = R::from_f64(BEND) / pendulum.bounds(&highest).elbow;
    Ok((if bent < resolved { bent } else { resolved }).to_f64())
}

impl<F: Form> Flips<F> {
    /// With steps of `dt` s, at most `steps` of them for each start.
    ///
    /// Refuses what the form refuses, of parameters, steps and the energy of the highest start.
    pub fn new(parameters: &Parameters<F::Real>, dt: f64, steps: u32) -> Result<Self, Error> {
        let highest = F::new(
            &parameters.cast(),
            &State::at_rest(F::Real::PI, F::Real::PI).cast(),
            dt,
        )?;
        Ok(Self {
            pendulum: Pendulum::new(parameters)?,
            highest,
            dt: F::Real::from_f64(dt),
            steps,
        })
    }

    /// The motion let go at the angles `a1`, `a2`, rad; none if it never turns over.
    ///
    /// Refuses angles that are not finite.
    #[doc(hidden)]
    pub fn start(&self, a1: F::Real, a2: F::Real) -> Result<Option<Falling<F>>, Error> {
        let state = State::at_rest(a1, a2);
        state.check()?;
        if self.pendulum.cannot_turn_over(&state) {
            return Ok(None);
        }
        let motion = self.highest.started(&state.cast())?;
        Ok(Some(Falling {
            motion,
            sides: motion.sides(),
            steps: 0,
        }))
    }

    /// Makes at most `steps` steps; what is known after them.
    #[inline]
    #[doc(hidden)]
    pub fn advance(&self, falling: &mut Falling<F>, steps: u32) -> Option<Flip<F::Real>> {
        for _ in 0..steps {
            if falling.steps >= self.steps {
                return Some(Flip::Later);
            }
            falling.motion.advance_one();
            let before = core::mem::replace(&mut falling.sides, falling.motion.sides());
            if passes(&before, &falling.sides) < 0 {
                return Some(self.passage(falling.steps, before, falling.sides));
            }
            falling.steps += 1;
        }
        None
    }

    /// What becomes of the motion let go at the angles `a1`, `a2`, rad.
    ///
    /// Refuses angles that are not finite.
    pub fn of(&self, a1: F::Real, a2: F::Real) -> Result<Flip<F::Real>, Error> {
        let Some(mut falling) = self.start(a1, a2)? else {
            return Ok(Flip::Never);
        };
        Ok(self.advance(&mut falling, u32::MAX).unwrap_or(Flip::Later))
    }

    /// Returns the time of the passage between the sides `before` and `after`, of which `before` are
    /// those after `steps` steps.
    fn passage(&self, steps: u32, before: [[i32; 2]; 2], after: [[i32; 2]; 2]) -> Flip<F::Real> {
        // The share of the step until a rod passes, by linear interpolation of its sine.
        let share = |rod: usize| {
            let [from, _] = before[rod];
            let [to, cos] = after[rod];
            if turns_over([from, to, cos]) < 0 {
                let [from, to] = [from, to].map(F::side_value);
                from / (from - to)
            } else {
                F::Real::ONE
            }
        };
        let upper = share(0);
        let lower = share(1);
        let share = if lower < upper { lower } else { upper };
        Flip::After((F::Real::from_f64(steps.into()) + share) * self.dt)
    }
}

/// Returns a negative number if a rod has passed straight up between the two.
#[inline(always)]
fn passes(before: &[[i32; 2]; 2], after: &[[i32; 2]; 2]) -> i32 {
    let [[upper_before, _], [lower_before, _]] = *before;
    let [[upper_after, upper_cos], [lower_after, lower_cos]] = *after;
    turns_over([upper_before, upper_after, upper_cos])
        | turns_over([lower_before, lower_after, lower_cos])
}
