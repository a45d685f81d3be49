//! What each method costs, what may be spent, and the methods and steps that it pays for.

use super::{PlannedRun, Problem};
use crate::error::{Error, Parameter};
use crate::pendulum::Pendulum;
use crate::table::Method;

/// The price list: what a step costs by each method, what a frame costs in closed form. In cycles, or in any other unit
/// that the [`Budget`] is given in, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// [`Method::ClosedFormF32`], for each frame.
    pub closed_form: f32,
    /// [`Method::Rk4F32DirectionPlain`].
    pub direction_plain: f32,
    /// [`Method::Rk4F32Direction`].
    pub direction: f32,
    /// [`Method::Rk4Fixed32`].
    pub fixed32: f32,
    /// [`Method::Extrapolation10Fixed64`].
    pub fixed64: f32,
    /// To prepare a motion by any of them.
    pub preparation: f32,
}

impl Costs {
    /// What a frame costs that is computed so; infinite for what no plan chooses from.
    #[inline(never)] // one copy
    #[doc(hidden)]
    #[must_use]
    pub fn of_frame(&self, Stepping { method, steps }: Stepping) -> f32 {
        let step = match method {
            Method::ClosedFormF32 => return self.closed_form,
            Method::Rk4F32DirectionPlain => self.direction_plain,
            Method::Rk4F32Direction => self.direction,
            Method::Rk4Fixed32 => self.fixed32,
            Method::Extrapolation10Fixed64 => self.fixed64,
            _ => f32::INFINITY,
        };
        step * steps as f32
    }
}

/// What may be spent, in the unit of the [`Costs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// On computing a frame.
    pub frame: f32,
    /// On planning.
    pub planning: f32,
}

/// How a motion is computed: a method, and how fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct Stepping {
    pub method: Method,
    /// Steps to a frame; of no meaning to the closed form, which has none.
    pub steps: u32,
}

/// At so many admissible steps or less in one, the roundings of [`Method::Extrapolation10Fixed64`] are what ends its horizon, not its steps.
pub(super) const RESOLVING: f64 = 2.1;

/// The first step looked at is no longer than this many admissible ones: the fastest rate that the energy allows turns a
/// radian in it. In longer steps two runs could miss alike what neither sees.
pub(super) const FIRST_STEP: f64 = 4.0;

/// Finer steps than this many to a frame are never tried.
pub(super) const MOST_STEPS: u32 = 1 << 16;

/// The fewest steps by `method` to a frame, of which there are `rate` in a second, that are no longer than `longest` s; in 32
/// bits a power of two, as the steps that refine them.
#[inline(never)] // one copy
pub(super) fn steps_to_frame(method: Method, rate: u16, longest: f64) -> u32 {
    let fewest = libm::ceil(1.0 / (longest * f64::from(rate)));
    let fewest = (fewest as u32).clamp(1, MOST_STEPS);
    if method == Method::Extrapolation10Fixed64 {
        fewest
    } else {
        fewest.next_power_of_two()
    }
}

/// The longest step that resolves every motion of the problem's energy, s.
///
/// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
#[inline(never)] // one copy
pub(super) fn admissible_step(problem: &Problem) -> Result<f64, Error> {
    let pendulum = Pendulum::new(&problem.pendulum)?;
    pendulum.admissible_step(&pendulum.to_state(&problem.start))
}

impl Stepping {
    /// What a motion may be shown by while nothing is known of it but its energy: [`Method::Extrapolation10Fixed64`] where
    /// `frame`, which a frame may cost, allows for it, in steps that resolve all there may be or, if those cost too much, the
    /// longest that are looked at; else by such steps in 32 bits, or as many as can be had.
    ///
    /// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
    #[doc(hidden)]
    pub fn lasting(problem: &Problem, costs: &Costs, frame: f32) -> Result<Self, Error> {
        let admissible = admissible_step(problem)?;
        for longest in [RESOLVING, FIRST_STEP] {
            if let Some(stepping) = Self::fixed64(problem, longest * admissible, costs, frame) {
                return Ok(stepping);
            }
        }
        let affordable = |method| {
            let mut steps = steps_to_frame(method, problem.rate, FIRST_STEP * admissible);
            while steps > 1 && costs.of_frame(Self { method, steps }) > frame {
                steps /= 2;
            }
            Self { method, steps }
        };
        let fixed = affordable(Method::Rk4Fixed32);
        let is_fixed = costs.fixed32 < costs.direction && fixed.check(problem).is_ok();
        Ok(if is_fixed {
            fixed
        } else {
            affordable(Method::Rk4F32Direction)
        })
    }

    /// By `method`, in the longest steps that resolve every motion of this energy. Refuses what [`lasting`](Self::lasting) refuses.
    #[doc(hidden)]
    pub fn of(problem: &Problem, method: Method) -> Result<Self, Error> {
        let admissible = admissible_step(problem)?;
        let longest = if method == Method::Extrapolation10Fixed64 {
            RESOLVING
        } else {
            FIRST_STEP
        };
        Ok(Self {
            method,
            steps: steps_to_frame(method, problem.rate, longest * admissible),
        })
    }

    /// By [`Method::Extrapolation10Fixed64`] in steps of `longest` s or less, as coarse as its numbers take, if they cost no more than `frame`.
    pub(super) fn fixed64(
        problem: &Problem,
        longest: f64,
        costs: &Costs,
        frame: f32,
    ) -> Option<Self> {
        let method = Method::Extrapolation10Fixed64;
        let mut stepping = Self {
            method,
            steps: steps_to_frame(method, problem.rate, longest),
        };
        while costs.of_frame(stepping) <= frame && stepping.steps < MOST_STEPS {
            match stepping.check(problem) {
                Ok(()) => return Some(stepping),
                Err(Error::TooLarge {
                    parameter: Parameter::Dt,
                    limit,
                    ..
                }) => {
                    stepping.steps =
                        steps_to_frame(method, problem.rate, limit).max(stepping.steps + 1);
                }
                Err(_) => return None,
            }
        }
        None
    }

    /// Refuses a motion that cannot be started so.
    #[inline(never)] // the motion stands on the stack
    fn check(self, problem: &Problem) -> Result<(), Error> {
        PlannedRun::new(problem, self).map(|_| ())
    }
}
