//! What is planned.

use super::cost::{Budget, Costs};
use crate::error::{Error, Parameter};
use crate::pendulum::{Motion, Parameters, State};
use crate::table::{Method, Numbers};

/// A pendulum, its start, how it is shown, and how wrong that may be.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Refuses NaN and infinite values; a tolerance, duration, rate, cost or budget that is not positive; and more frames than can be
    /// counted. The pendulum is checked where it is used.
    pub(super) fn check(&self, costs: &Costs, budget: &Budget) -> Result<(), Error> {
        self.start.check()?;
        let Costs {
            closed_form,
            direction_plain,
            direction,
            fixed32,
            fixed64,
            preparation,
        } = *costs;
        let of = |parameter| move |value: f32| (parameter, f64::from(value));
        let costs = [
            closed_form,
            direction_plain,
            direction,
            fixed32,
            fixed64,
            preparation,
        ]
        .map(of(Parameter::Cost));
        let budgets = [budget.frame, budget.planning].map(of(Parameter::Budget));
        let shown = [
            (Parameter::Tolerance, self.tolerance),
            (Parameter::Duration, self.duration),
        ];
        let rate = [(Parameter::Rate, f64::from(self.rate))];
        for &(parameter, value) in [&shown[..], &rate, &costs, &budgets].into_iter().flatten() {
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if value <= 0.0 {
                return Err(Error::NotPositive { parameter, value });
            }
        }
        let (parameter, value, limit) = (
            Parameter::Duration,
            self.duration,
            f64::from(u32::MAX) / f64::from(self.rate),
        );
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

    /// Frames shown after the one at the start, at least one.
    #[inline(never)] // one copy
    #[doc(hidden)]
    #[must_use]
    pub fn frames(&self) -> u32 {
        let frames = libm::rint(self.duration * f64::from(self.rate)) as u32;
        if frames == 0 { 1 } else { frames }
    }

    /// The time of frame `frame`, s.
    #[doc(hidden)]
    #[must_use]
    pub fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.rate)
    }

    /// The pendulum and its start, which is at `start`, some numbers off by what `method` may round them by.
    #[inline(never)]
    pub(super) fn perturbed(
        &self,
        start: &State<f64>,
        [by_g, by_l2, by_m2, by_a1]: Perturbation,
        method: Method,
    ) -> (Parameters<f64>, State<f64>) {
        let epsilon = epsilon(method);
        let off = |value: f64, by: f64| value + value * (by * epsilon);
        let (Parameters { m2, l2, g, .. }, &State { a1, a2, p1, p2 }) = (self.pendulum, start);
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

/// By what share of itself a number given to `method` may be off.
fn epsilon(method: Method) -> f64 {
    match method.numbers() {
        Numbers::F32 | Numbers::CompensatedF32 => f32::EPSILON.into(),
        Numbers::Fixed32 => 1.0 / f64::from(1_u32 << 29),
        Numbers::F64 | Numbers::CompensatedF64 | Numbers::Fixed64 => f64::EPSILON,
    }
}

/// An epsilon, and a little more: in `f64` just half of one would round back to the given number. Rounding takes half of one at
/// most, but the errors of all the numbers come together as chance has it.
const OFF: f64 = 1.0 + 1.0 / 1024.0;

/// By how much the numbers of a problem are off before they are rounded, in epsilons: g and p1, l2 and p2, m2 and a2, a1.
///
/// What a motion does goes by quotients of these, as a fast one by g/l2 or m2 g/l2, and two errors may make up for each other.
/// What one of the perturbations leaves as it is, another alters.
pub(super) type Perturbation = [f64; 4];

/// Nothing is off.
pub(super) const NONE: Perturbation = [0.0; 4];

/// One half of the numbers off one way, the other half the other way: three such halves.
pub(super) const PERTURBATIONS: [Perturbation; 3] = [
    [OFF, OFF, -OFF, -OFF],
    [OFF, -OFF, OFF, -OFF],
    [OFF, -OFF, -OFF, OFF],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that need rounding in `f32` and none in `f64`, and the powers of two that equal rods and masses are.
    #[test]
    fn every_perturbation_is_another_problem_to_every_method() {
        for (&method, one) in Method::DRAWN
            .iter()
            .flat_map(|method| [(method, 1.0), (method, 0.7)])
        {
            let (pendulum, motion) = (
                Parameters::equal_rods(one, one, 9.81),
                Motion::at_rest(0.0, 0.0),
            );
            let problem = Problem {
                pendulum,
                start: motion,
                tolerance: 0.1,
                duration: 1.0,
                rate: 60,
            };
            let numbers = |perturbation| {
                let start = State {
                    a1: 2.0 * one,
                    a2: one,
                    p1: -one,
                    p2: 0.3,
                };
                let (Parameters { m2, g, .. }, state) =
                    problem.perturbed(&start, perturbation, method);
                let [a1, a2, p1, p2] = <[f64; 4]>::from(state);
                [m2, g, a1, a2, p1, p2].map(|x| {
                    if method.is_single() {
                        f64::from(x as f32)
                    } else {
                        x
                    }
                })
            };
            let all = [NONE, PERTURBATIONS[0], PERTURBATIONS[1], PERTURBATIONS[2]].map(numbers);
            for (i, other) in all.iter().enumerate() {
                assert!(!all[..i].contains(other), "{method}: {all:?}");
                for (own, beside) in all[0].into_iter().zip(other) {
                    assert!(
                        (beside - own).abs() <= 2.0 * own.abs() * epsilon(method),
                        "{method}: {own} {beside}"
                    );
                }
            }
        }
    }
}
