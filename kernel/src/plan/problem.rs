//! What is planned.

use super::error::{PlanError, Quantity, check_positive};
use crate::params::Parameters;
use crate::real::Real;
use crate::state::{Motion, State};

/// A pendulum, its start, how it is shown, and how wrong that may be.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Problem {
    /// Masses, lengths and gravity.
    pub pendulum: Parameters<f64>,
    /// Angles and angular velocities at the start.
    pub start: Motion<f64>,
    /// How far either bob, and bob 2 as seen from bob 1, may be from where the exact motion has it, m.
    pub tolerance: f64,
    /// How long it is shown, s.
    pub duration: f64,
    /// Frames per second.
    pub rate: u16,
}

impl Problem {
    /// Refuses NaN and infinite values, and a tolerance, duration or rate that is not positive.
    ///
    /// The pendulum is checked where it is used.
    pub fn check(&self) -> Result<(), PlanError> {
        self.start.check()?;
        check_positive(Quantity::Tolerance, &[self.tolerance])?;
        check_positive(Quantity::Duration, &[self.duration])?;
        check_positive(Quantity::Rate, &[self.rate.into()])?;
        let limit = f64::from(u32::MAX) / f64::from(self.rate);
        if self.duration > limit {
            return Err(PlanError::TooLarge { quantity: Quantity::Duration, value: self.duration, limit });
        }
        Ok(())
    }

    /// Frames shown after the one at the start, at least one.
    #[must_use]
    #[inline(never)] // once in flash
    pub fn frames(&self) -> u32 {
        let frames = libm::rint(self.duration * f64::from(self.rate)) as u32;
        if frames == 0 { 1 } else { frames }
    }

    /// The time of frame `frame`, s.
    #[must_use]
    pub fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.rate)
    }

    /// The lengths of the rods over the tolerance: so measured, a bob may be off by 1.
    pub(super) fn rods(&self) -> [f32; 2] {
        let Parameters { l1, l2, .. } = self.pendulum;
        [l1, l2].map(|l| (l / self.tolerance) as f32)
    }

    /// The pendulum and its start, which is at `start`, in the arithmetic `R`, some numbers off by a rounding.
    #[inline(never)] // once in flash
    pub(super) fn rounded<R: Real>(&self, start: &State<f64>, perturbation: Perturbation) -> (Parameters<R>, State<R>) {
        let &State { a1, a2, p1, p2 } = start;
        let Parameters { m1, m2, l1, l2, g } = self.pendulum;
        let off = |value: f64, by: f64| R::from_f64(value + value * (by * R::EPSILON.to_f64()));
        let [first, second] = match perturbation {
            Perturbation::None => [0.0, 0.0],
            Perturbation::Alike => [HALF_ULP, HALF_ULP],
            Perturbation::Opposite => [HALF_ULP, -HALF_ULP],
        };
        let parameters = Parameters {
            m1: R::from_f64(m1),
            m2: off(m2, first),
            l1: R::from_f64(l1),
            l2: off(l2, second),
            g: off(g, second),
        };
        let state = State { a1: off(a1, first), a2: off(a2, second), p1: off(p1, second), p2: off(p2, first) };
        (parameters, state)
    }
}

/// Half an epsilon, and a little more: in `f64`, which holds the given numbers themselves, just half of one rounds back to
/// them.
const HALF_ULP: f64 = 0.5 + 1.0 / 1024.0;

/// Which numbers of a problem are half an ulp off before they are rounded, and in which direction.
#[derive(Clone, Copy, Debug)]
pub(super) enum Perturbation {
    /// None.
    None,
    /// All but m1 and l1, the same way.
    Alike,
    /// The same ones, half of them the other way.
    Opposite,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that need rounding in `f32` and none in `f64`, and the powers of two that equal rods and masses are.
    fn every_perturbation_is_another_problem<R: Real>() {
        for one in [1.0, 0.7] {
            let pendulum = Parameters::equal_rods(one, one, 9.81);
            let start = State { a1: 2.0 * one, a2: one, p1: -one, p2: 0.3 };
            let problem =
                Problem { pendulum, start: Motion::at_rest(0.0, 0.0), tolerance: 0.1, duration: 1.0, rate: 60 };
            let numbers = |perturbation| {
                let (Parameters { m2, g, .. }, state) = problem.rounded::<R>(&start, perturbation);
                let [a1, a2, p1, p2] = <[R; 4]>::from(state);
                [m2, g, a1, a2, p1, p2].map(R::to_f64)
            };
            let [own, alike, opposite] = [Perturbation::None, Perturbation::Alike, Perturbation::Opposite].map(numbers);
            assert!(own != alike && own != opposite && alike != opposite, "{own:?} {alike:?} {opposite:?}");
            for (own, beside) in own.into_iter().zip(alike).chain(own.into_iter().zip(opposite)) {
                assert!((beside - own).abs() <= own.abs() * R::EPSILON.to_f64(), "{own} {beside}");
            }
        }
    }

    #[test]
    fn every_perturbation_is_another_problem_in_both_precisions() {
        every_perturbation_is_another_problem::<f32>();
        every_perturbation_is_another_problem::<f64>();
    }
}
