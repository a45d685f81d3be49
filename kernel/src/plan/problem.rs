//! The problem to plan, and small perturbations of it.

use super::cost::{Budget, Costs};
use crate::error::{Error, Parameter};
use crate::pendulum::{Motion, Parameters, State};
use crate::table::{Method, Numbers};

/// The mass ratio m2/m1 above which bob 2 counts as heavy.
const HEAVY_BOB_2: f64 = 4.0;

/// A pendulum and its start, the frames that show it, and the tolerance.
///
/// The fields are not checked until a [`Search`](super::Search) starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// The masses, lengths and gravity.
    pub pendulum: Parameters<f64>,
    /// The angles, rad, and angular velocities, rad/s, at the start.
    pub start: Motion<f64>,
    /// The largest allowed distance of a bob from its exact position, m; more than 0. It applies to
    /// both bobs, and to the position of bob 2 relative to bob 1.
    pub tolerance: f64,
    /// The duration of the motion, s; more than 0, and at most (2^32 - 1)/`rate`. It is rounded to
    /// the nearest whole number of frames, at least one.
    pub duration: f64,
    /// The number of frames per second; at least 1.
    pub rate: u16,
}

impl Problem {
    /// Checks the problem, the costs and the budgets.
    ///
    /// Refuses a start that is not finite; a tolerance, duration, rate, price or budget that is
    /// NaN, infinite, zero or negative; and more frames than a `u32` can count, by
    /// [`Error::TooLarge`] with the longest duration, s. The error names the first of these. The
    /// pendulum is checked by the functions that use it.
    pub(super) fn check(&self, costs: &Costs, budget: &Budget) -> Result<(), Error> {
        self.start.check()?;

        // The prices and budgets, each with the parameter that an error names.
        let prices = Method::DRAWN
            .iter()
            .filter_map(|&method| Some((Parameter::Price(method), costs.step(method)?)));
        let others = [
            (Parameter::Price(Method::Rk4Fixed32), costs.fixed32_unlike),
            (Parameter::Cost, costs.preparation),
        ];
        let in_f64 = |(parameter, value)| (parameter, f64::from(value));
        let costs = prices.chain(others).map(in_f64);
        let budgets = [
            (Parameter::FrameBudget, budget.frame),
            (Parameter::PlanningBudget, budget.planning),
        ]
        .map(in_f64);

        // Check in this order; the error names the first value that is refused.
        let shown = [
            (Parameter::Tolerance, self.tolerance),
            (Parameter::Duration, self.duration),
        ];
        let rate = [(Parameter::Rate, f64::from(self.rate))];
        let all = shown.into_iter().chain(rate).chain(costs).chain(budgets);
        for (parameter, value) in all {
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if value <= 0.0 {
                return Err(Error::NotPositive { parameter, value });
            }
        }

        // The number of frames must fit a `u32`.
        let parameter = Parameter::Duration;
        let value = self.duration;
        let limit = f64::from(u32::MAX) / f64::from(self.rate);
        if value > limit {
            Err(Error::TooLarge {
                parameter,
                value,
                limit,
            })
        } else {
            Ok(())
        }
    }

    /// Returns the number of frames after the one at the start: the duration times the rate,
    /// rounded to the nearest integer (half to even). It is limited to the range from 1 to
    /// 2^32 - 1; a NaN gives 1.
    #[doc(hidden)] // For the firmware's budgets, and for proofs.
    #[must_use]
    pub fn frames(&self) -> u32 {
        let frames = libm::rint(self.duration * f64::from(self.rate)) as u32;
        if frames == 0 { 1 } else { frames }
    }

    /// Returns true if bob 2 is so heavy, relative to bob 1, that it drives rod 1 very fast for
    /// moments: if m2/m1 is above 4. The masses are not checked; NaN gives false.
    pub(super) fn has_heavy_bob_2(&self) -> bool {
        self.pendulum.m2 > HEAVY_BOB_2 * self.pendulum.m1
    }

    /// Returns the time of frame `frame` since the start, s. Frame 0 is the start. A rate of 0
    /// gives infinity, or NaN for frame 0.
    pub(super) fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.rate)
    }

    /// Returns the pendulum and `start` with their numbers changed by a perturbation, times the
    /// rounding error of `method`: 2^-23 in `f32`, 2^-29 in 32 bits of fixed point, and otherwise
    /// 2^-52. Both are relative to each number, so that 0 stays 0. m1 and l1 are not changed.
    /// Nothing is checked.
    pub(super) fn perturbed(
        &self,
        start: &State<f64>,
        [by_g, by_l2, by_m2, by_a1]: Perturbation,
        method: Method,
    ) -> (Parameters<f64>, State<f64>) {
        // Changes are relative to the number, in rounding errors of the method.
        let epsilon = epsilon(method);
        let off = |value: f64, by: f64| value + value * (by * epsilon);
        let (Parameters { m2, l2, g, .. }, &State { a1, a2, p1, p2 }) = (self.pendulum, start);

        // Three factors change a parameter and a coordinate each; `by_a1` changes only a1.
        let parameters = Parameters {
            m2: off(m2, by_m2),
            l2: off(l2, by_l2),
            g: off(g, by_g),
            ..self.pendulum
        };
        (
            parameters,
            State {
                a1: off(a1, by_a1),
                a2: off(a2, by_m2),
                p1: off(p1, by_g),
                p2: off(p2, by_l2),
            },
        )
    }
}

/// Returns the relative rounding error, epsilon, of an input of `method`: that of `f32` or `f64`,
/// 2^-29 in 32 bits of fixed point, and that of `f64` in 64 bits of fixed point.
fn epsilon(method: Method) -> f64 {
    match method.numbers() {
        Numbers::F32 | Numbers::CompensatedF32 => f32::EPSILON.into(),
        Numbers::Fixed32 => 1.0 / f64::from(1_u32 << 29),
        Numbers::F64 | Numbers::CompensatedF64 | Numbers::Fixed64 => f64::EPSILON,
    }
}

/// The size of a perturbation, in epsilons: slightly more than one.
///
/// It is more than one, so that the rounded number always changes. In `f64`, half an epsilon would
/// round back to the given number. Rounding changes a number by at most half an epsilon, but the
/// errors of all numbers add up at random.
const OFF: f64 = 1.0 + 1.0 / 1024.0;
const _: () = assert!(OFF > 1.0);

/// The changes of the numbers of a problem before they are rounded, in epsilons: of g and p1, of l2
/// and p2, of m2 and a2, and of a1.
///
/// A motion depends on quotients of these numbers, a fast one on g/l2 or m2 g/l2, so that two
/// changes may cancel. If one perturbation does not change a quotient, another one does.
pub(super) type Perturbation = [f64; 4];

/// The perturbation that changes nothing.
pub(super) const NONE: Perturbation = [0.0; 4];

/// Perturbations that increase two of the four factors and decrease the others, in three
/// combinations.
pub(super) const PERTURBATIONS: [Perturbation; 3] = [
    [OFF, OFF, -OFF, -OFF],
    [OFF, -OFF, OFF, -OFF],
    [OFF, -OFF, -OFF, OFF],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Bob 2 is heavy if it has more than 4 times the mass of bob 1, in any unit of mass.
    #[test]
    fn bob_2_is_heavy_above_a_mass_ratio_of_4() {
        for m1 in [0.25, 1.0, 16.0] {
            let is_heavy = |m2| {
                let problem = Problem {
                    pendulum: Parameters {
                        m1,
                        m2,
                        ..Parameters::equal_rods(1.0, 1.0, 9.81)
                    },
                    start: Motion::at_rest(0.0, 0.0),
                    tolerance: 0.1,
                    duration: 1.0,
                    rate: 60,
                };
                problem.has_heavy_bob_2()
            };
            assert!(!is_heavy(4.0 * m1) && is_heavy(4.001 * m1), "{m1} kg");
        }
    }

    /// A motion may have up to 2^32 - 1 frames: at one frame per second it may take as many
    /// seconds, but not one more.
    #[test]
    fn longest_motion_has_all_frames_that_a_u32_can_count() {
        let most = f64::from(u32::MAX);
        let check = |duration| {
            let problem = Problem {
                pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
                start: Motion::at_rest(0.0, 0.0),
                tolerance: 0.1,
                duration,
                rate: 1,
            };
            let budget = Budget {
                frame: 1.0,
                planning: 1.0,
            };
            problem.check(&Costs::CORTEX_M3, &budget)
        };
        assert_eq!(check(most), Ok(()));
        let too_large = Error::TooLarge {
            parameter: Parameter::Duration,
            value: most + 1.0,
            limit: most,
        };
        assert_eq!(check(most + 1.0), Err(too_large));
    }

    /// Each of the three perturbations must increase or decrease the magnitudes of m2, l2, g, both
    /// angles and both momenta as its factors do, by at most two epsilons of the method. For
    /// methods in `f32` all numbers are rounded to `f32` first.
    ///
    /// The size 0.7 makes numbers that need rounding in `f32` but not in `f64`. The size 1.0 makes
    /// rods and masses that are powers of two.
    #[test]
    fn perturbations_change_every_number_by_at_most_two_epsilons_in_every_method() {
        for (&method, one) in Method::DRAWN
            .iter()
            .flat_map(|method| [(method, 1.0), (method, 0.7)])
        {
            let problem = Problem {
                pendulum: Parameters::equal_rods(one, one, 9.81),
                start: Motion::at_rest(0.0, 0.0),
                tolerance: 0.1,
                duration: 1.0,
                rate: 60,
            };

            // The numbers to compare, as the method rounds them.
            let numbers = |perturbation| {
                let start = State {
                    a1: 2.0 * one,
                    a2: one,
                    p1: -one,
                    p2: 0.3,
                };

                // Methods in single precision see the numbers as `f32`.
                let (Parameters { m2, l2, g, .. }, state) =
                    problem.perturbed(&start, perturbation, method);
                let [a1, a2, p1, p2] = <[f64; 4]>::from(state);
                [m2, l2, g, a1, a2, p1, p2].map(|x| {
                    if method.is_single() {
                        f64::from(x as f32)
                    } else {
                        x
                    }
                })
            };

            // Each magnitude must change in the direction of its factor, by two epsilons at most.
            for perturbation in PERTURBATIONS {
                let [by_g, by_l2, by_m2, by_a1] = perturbation;
                let factors = [by_m2, by_l2, by_g, by_a1, by_m2, by_g, by_l2];
                let all = numbers(NONE).into_iter().zip(numbers(perturbation));
                for ((own, beside), factor) in all.zip(factors) {
                    let change = (beside - own) / own;
                    assert!(
                        change * factor > 0.0 && change.abs() <= 2.0 * epsilon(method),
                        "{method}, {perturbation:?}: {own} {beside}"
                    );
                }
            }
        }
    }

    /// Every perturbation increases two of its four factors and decreases two. For every two
    /// factors, some perturbation changes both in the same direction, and some in opposite
    /// directions.
    #[test]
    fn every_two_factors_change_alike_and_oppositely() {
        for changes in PERTURBATIONS {
            assert_eq!(changes.into_iter().sum::<f64>(), 0.0, "{changes:?}");
        }
        for i in 0..4 {
            for j in 0..i {
                let has = |ratio| {
                    let mut all = PERTURBATIONS.iter();
                    all.any(|changes| changes[i] != 0.0 && changes[i] == ratio * changes[j])
                };
                assert!(has(1.0) && has(-1.0), "{i}, {j}");
            }
        }
    }
}
