//! The map of flips: the time of the first flip, for all starts from rest.
//!
//! A start from rest is given by two angles. All starts of a pendulum therefore fill a square, and
//! the time of the first flip is a picture of this square (J. S. Heyl, "The double pendulum
//! fractal", 2008). A rod turns over, or *flips*, when its angle passes plus or minus pi. Where the
//! energy forbids that ([`Pendulum::cannot_turn_over`]), no step is computed.
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

pub(crate) mod falling;
mod lanes;
mod side_by_side;

use crate::error::Error;
use crate::methods::Form;
use crate::methods::turns::turns_over;
use crate::numbers::{Real, RealOperations};
use crate::pendulum::{Parameters, Pendulum, State};
use falling::Falling;

/// The time of the first flip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flip<R> {
    /// The energy is too low for any flip.
    Never,
    /// A rod flips at this time after the start, s; never NaN. It is negative if the steps are.
    After(R),
    /// No rod flips within the computed steps.
    Later,
}

/// A pendulum, a step size and a number of steps, for any number of starts.
///
/// A flip is detected by the signs of sine and cosine after each step, and its time interpolated
/// linearly in the sine. Whole turns of a start do not matter. A rod that starts straight up has
/// not flipped yet.
///
/// In maps of equal rods and bobs up to 10 sqrt(l/g), in steps of [`step_size`], 99.9 % of the
/// starts that may turn over have their flip within one of 14 grey levels of that in far finer
/// steps, on a logarithmic scale of time, in any arithmetic (the repository's test `flips`).
///
/// The motions are not checked: in steps that are far too long, or after a motion has diverged, a
/// flip may be missed, or reported where no rod turns over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flips<F: Form> {
    pendulum: Pendulum<F::Real>,
    /// The motion from straight up, which has the largest energy.
    highest: F,
    dt: F::Real,
    steps: u32,
}

/// Returns the longest step, s, that is short enough for a map of flips.
///
/// It is twice the [admissible step](Pendulum::admissible_step) from straight up, which is accurate
/// enough to find flips, or shorter for a light bob 2, whose elbow must not bend by more than 0.36
/// rad in a step. Without gravity it is infinite, which [`Flips::new`] refuses.
///
/// # Errors
///
/// Refuses the parameters that [`Pendulum::new`] refuses, and those whose normal modes are out of
/// the range of `R`, by [`Error::OutOfRange`].
pub fn step_size<R: Real>(parameters: &Parameters<R>) -> Result<f64, Error> {
    /// The largest bend of the elbow in a step, rad. Half a turn takes nine steps.
    const BEND: f64 = 0.36;

    let pendulum = Pendulum::new(parameters)?;
    let highest = State::at_rest(R::PI, R::PI);
    let resolved = pendulum.admissible_step(&highest)?.twice();
    let bent = R::from_f64(BEND) / pendulum.bounds(&highest).elbow;
    Ok((if bent < resolved { bent } else { resolved }).to_f64())
}

impl<F: Form> Flips<F> {
    /// Creates a map with steps of `dt` s, backwards if negative, and at most `steps` steps for
    /// each start.
    ///
    /// # Errors
    ///
    /// Refuses the parameters that [`Pendulum::new`] refuses, and the parameters and steps that the
    /// method `F` refuses: those of [`Pendulum::run`], except that methods in floating point accept
    /// a step beyond the limit of stability.
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

    /// Returns the first flip of the motion that is released at rest at the angles `a1`, `a2`, rad.
    ///
    /// # Errors
    ///
    /// Refuses angles that are not finite, by [`Error::NotFinite`], and, by the closed form, a
    /// start from which an angle may exceed 2^31 - 1 turns, by [`Error::OutOfRange`].
    pub fn of(&self, a1: F::Real, a2: F::Real) -> Result<Flip<F::Real>, Error> {
        let Some(mut falling) = Falling::start(self, a1, a2)? else {
            return Ok(Flip::Never);
        };
        Ok(falling.advance(self, u32::MAX).unwrap_or(Flip::Later))
    }

    fn passage(&self, steps: u32, before: [[i32; 2]; 2], after: [[i32; 2]; 2]) -> Flip<F::Real> {
        let share = |rod: usize| {
            let [from, _] = before[rod];
            let [to, cos] = after[rod];
            if turns_over([from, to, cos]) < 0 {
                let [from, to] = [from, to].map(F::side_value);
                let share = from / (from - to);
                // A motion that has diverged passes at the end of the step.
                if share < F::Real::ONE {
                    share
                } else {
                    F::Real::ONE
                }
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

/// Returns a negative number if a rod has passed straight up: if its sine has changed its sign
/// while its cosine is negative.
fn passes(before: &[[i32; 2]; 2], after: &[[i32; 2]; 2]) -> i32 {
    let [[upper_before, _], [lower_before, _]] = *before;
    let [[upper_after, upper_cos], [lower_after, lower_cos]] = *after;
    turns_over([upper_before, upper_after, upper_cos])
        | turns_over([lower_before, lower_after, lower_cos])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::{DirectionF32Plain, FormVisitor, HamiltonF32};
    use crate::table::Method;

    struct FirstFlip;

    impl FormVisitor for FirstFlip {
        type Output = Result<Option<f64>, Error>;

        fn visit<F: Form>(self) -> Self::Output {
            let parameters = Parameters::equal_rods(1.0, 1.0, 9.81).cast();
            let map = Flips::<F>::new(&parameters, 1.0 / 256.0, 2560)?;
            let flip = map.of(F::Real::from_f64(2.0), F::Real::from_f64(2.5))?;
            Ok(match flip {
                Flip::After(time) => Some(time.to_f64()),
                Flip::Never | Flip::Later => None,
            })
        }
    }

    #[test]
    fn passage_of_one_rod_or_both_is_reported() {
        let [before, after] = [[1, -1], [-1, -1]];
        for (upper, lower, is_passage) in [
            (before, before, false),
            (after, before, true),
            (before, after, true),
            (after, after, true),
            ([-1, 1], [-1, 1], false),
        ] {
            let passes = passes(&[before; 2], &[upper, lower]);
            assert_eq!(passes < 0, is_passage, "{upper:?}, {lower:?}");
        }
    }

    /// In steps that are far too long a motion diverges, and may have any result, but no time that
    /// is not a number.
    #[test]
    fn time_of_a_flip_is_a_number() -> Result<(), Error> {
        let parameters = Parameters::equal_rods(1.0_f32, 1.0, 9.81);
        let mut count = 0;
        for dt in [1.0, 10.0, 1e3, 1e6, 1e9] {
            let direction = Flips::<DirectionF32Plain>::new(&parameters, dt, 100)?;
            let angles = Flips::<HamiltonF32>::new(&parameters, dt, 100)?;
            for i in 0_u16..400 {
                let a1 = f32::from(i % 20) * 0.3 - 3.0;
                let a2 = f32::from(i / 20) * 0.3 - 3.0;
                for flip in [direction.of(a1, a2)?, angles.of(a1, a2)?] {
                    if let Flip::After(time) = flip {
                        assert!(!time.is_nan(), "{a1} {a2} in steps of {dt} s");
                        count += 1;
                    }
                }
            }
        }
        assert!(count > 100, "{count}");
        Ok(())
    }

    /// Every method, in any arithmetic, finds the same first flip to a millisecond. Only the closed
    /// form does not, because it is linear.
    #[test]
    fn every_method_finds_the_same_first_flip() -> Result<(), Error> {
        const BY_RK4_F64: f64 = 4.0153;
        for &method in Method::ALL {
            let Some(flip) = method.visit(FirstFlip) else {
                continue;
            };
            let is_linear = method.order() == 0;
            let is_right = flip?.is_some_and(|time| (time - BY_RK4_F64).abs() < 1e-3);
            assert_eq!(is_right, !is_linear, "{method}: {flip:?}");
        }
        Ok(())
    }
}
