//! Shadows: motions close to another one, which measure the growth of its small errors.
//!
//! An error that arises in a run is carried on by the motion. In a chaotic motion it grows
//! exponentially. Its direction in phase space soon becomes that of fastest growth, and its growth
//! does not depend on its initial size. The distance of a shadow grows in the same way.
//!
//! A shadow may be computed in 32 bits and in coarse steps. Its distance is kept between 2^-16 and
//! 2^-6 rad, where its own errors are negligible: at a larger distance it is drawn back along the
//! line to the motion.
//!
//! Four shadows are started. Each differs from the motion in a single number of the state. An error
//! of any direction is a linear combination of these differences. The farthest shadow therefore
//! grows at least half as much as any error. When one shadow has grown by 1000, all shadows that
//! have grown point in the direction of growth, and only the farthest is kept. A smaller growth
//! does not prove this: even without any instability, a push moves a bob by more and more every
//! second.
//!
//! With a heavy bob 2 no growth proves it, and all four are kept. Rod 1 is then so light that any
//! push moves it far at once. The farthest shadow may lack the direction in which errors grow
//! later: in some motions these became 200 times as large as it showed.
//!
//! Let G(t) be the growth of the farthest shadow since the start. An error e that arises at time s
//! has the size e G(t)/G(s) at time t. The rounding errors of different frames are independent, so
//! that the squares of e/G(s) add up.

use super::candidate::{distance, greater};
use super::cost::Stepping;
use super::problem::Problem;
use super::run::Directions;
use super::trial::Run;
use crate::error::Error;
use crate::methods::any::DrawnMotion32;
use crate::pendulum::{Parameters, State};

/// The initial distance of a shadow, rad.
const NEAR: f64 = 1.0 / (1 << 16) as f64;
/// The largest distance of a shadow, rad. Beyond it the shadow is drawn back.
const FAR: f32 = 1.0 / (1 << 6) as f32;
/// The factor on the distance when a shadow is drawn back.
const BACK: f32 = 1.0 / (1 << 10) as f32;
/// The growth after which only the farthest shadow is kept, unless bob 2 is heavy.
const ALIGNED: f32 = 1000.0;

/// The rounding error of a run in 64 bits, rad: of its start, of each radian of phase at the
/// fastest rate of the energy, and of each step. They are added within a frame, and as squares from
/// frame to frame.
///
/// The values are measured. With 12 steps per frame the errors of 60 motions from high starts came
/// to at most 0.4 of the bound; the median was 0.04. Test `plan_study` checks the bound against the
/// exact motion.
const ROUNDING: [f32; 3] = [2.4e-16, 3.2e-16, 6.4e-17];

/// A motion close to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shadow {
    run: Run<DrawnMotion32>,
    /// True if the shadow must be drawn back.
    is_far: bool,
    /// The product of the factors 1/[`BACK`] of all times that the shadow was drawn back.
    drawn_back: f32,
}

/// Four motions close to another one. Later only the farthest may be kept.
///
/// For each frame, [`prepare`](Self::prepare) is called until it returns false, all
/// [`runs`](Self::runs) are advanced to the frame, and it is [compared](Self::compare).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadows {
    shadows: [Shadow; 4],
    /// The index of the shadow that is kept; `None` while all four are kept.
    kept: Option<usize>,
    /// The growth after which only the farthest shadow is kept.
    aligned: f32,
    /// True after the first frame has been compared.
    has_begun: bool,
    /// The largest growth of a distance since the start, rad per radian at the start.
    growth: f32,
    /// The largest growth of a distance of the bobs since the start, in units of the tolerance per
    /// radian at the start.
    shown: f32,
    /// The root of the sum of the squares of all rounding errors since the start, each divided by
    /// the growth when it arose, rad.
    roundings: f32,
    /// The fastest rate that the energy allows, rad/s.
    rate: f64,
    /// The rounding error of one frame, rad.
    of_frame: f32,
}

impl Shadows {
    /// Creates the shadows of a motion in 64 bits that makes `steps` steps per frame. The shadows
    /// themselves are computed by `stepping`.
    ///
    /// No motion is prepared yet. A pendulum that is refused counts as one that cannot move; it is
    /// reported by [`prepare`](Self::prepare). So are a `stepping` that is not in 32 bits and one
    /// with 0 steps.
    pub fn new(stepping: Stepping, problem: &Problem, steps: u32) -> Self {
        // The fastest rate advances a phase by a radian in four admissible steps.
        let rate = super::cost::admissible_step(problem).map_or(0.0, |step| 0.25 / step);
        let [of_start, of_radian, of_step] = ROUNDING;

        // The unit of the rate of rod 2 is coarser if rod 2 is shorter. The power is measured, as
        // the bounds are.
        let Parameters { l1, l2, .. } = problem.pendulum;
        let short = if l2 < l1 { (l1 / l2) as f32 } else { 1.0 };
        let coarser = short * short * short;
        Self {
            shadows: [Shadow {
                run: Run::new(stepping),
                is_far: false,
                drawn_back: 1.0,
            }; 4],
            kept: None,
            aligned: if problem.has_heavy_bob_2() {
                f32::INFINITY
            } else {
                ALIGNED
            },
            has_begun: false,
            growth: 1.0,
            shown: 0.0,
            roundings: of_start,
            rate,
            of_frame: (of_radian * (rate / f64::from(problem.rate)) as f32
                + of_step * steps as f32)
                * coarser,
        }
    }

    /// Returns the shadows that are still needed: all four, or the one that is kept. Some may not
    /// be prepared yet, or may have diverged.
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<DrawnMotion32>> {
        self.needed().map(|(_, shadow)| &mut shadow.run)
    }

    /// Returns the shadows that are still needed, with their indices.
    fn needed(&mut self) -> impl Iterator<Item = (usize, &mut Shadow)> {
        let kept = self.kept;
        let shadows = self.shadows.iter_mut().enumerate();
        shadows.filter(move |(number, _)| kept.is_none_or(|kept| kept == *number))
    }

    /// Returns true after the first frame has been compared. Until then shadows are prepared at the
    /// start of the motion. From then on, they are drawn back to the motion at the present frame.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Returns true if a shadow must be drawn back by [`prepare`](Self::prepare). Shadows that are
    /// not prepared yet do not count.
    pub fn must_prepare(&mut self) -> bool {
        self.needed().any(|(_, shadow)| shadow.is_far)
    }

    /// Prepares one shadow close to a motion in the state `motion`, or draws one back to it. The
    /// state is that of the fine run at the same frame, in SI units.
    ///
    /// Returns true if it has done either, and false if there is nothing to do. `problem` must be
    /// that of [`new`](Self::new); this is not checked.
    ///
    /// # Errors
    ///
    /// Returns the error of the method if it refuses the shadow on both sides of the motion. A
    /// `motion` that is not finite is refused. The shadows are unchanged then.
    pub fn prepare(&mut self, problem: &Problem, motion: &State<f64>) -> Result<bool, Error> {
        // Select a shadow that is too far away or not yet prepared.
        let rate = self.rate;
        let mut shadows = self.needed();
        let Some((number, shadow)) =
            shadows.find(|(_, shadow)| shadow.is_far || shadow.run.motion.is_none())
        else {
            return Ok(false);
        };

        // Compute its difference from the motion.
        let by = match &shadow.run.motion {
            Some(shadow) => {
                let factor = f64::from(BACK);
                difference(&shadow.state(), motion).map(|by| by * factor)
            }
            None => {
                let mut by = [0.0; 4];
                by[number % 4] = NEAR * scales(&problem.pendulum, rate)[number % 4];
                by
            }
        };

        // Create it on one side of the motion or, if the method refuses that, on the other.
        let Stepping { method, steps } = shadow.run.stepping;
        let dt = 1.0 / (f64::from(problem.rate) * f64::from(steps));
        let prepared = |sign: f64| {
            let [a1, a2, p1, p2] = <[f64; 4]>::from(*motion);
            let [by1, by2, by3, by4] = by.map(|by| sign * by);
            let state = State {
                a1: a1 + by1,
                a2: a2 + by2,
                p1: p1 + by3,
                p2: p2 + by4,
            };
            DrawnMotion32::new(method, &problem.pendulum, &state, dt)
        };
        shadow.run.motion = Some(prepared(1.0).or_else(|_| prepared(-1.0))?);

        if shadow.is_far {
            shadow.is_far = false;
            shadow.drawn_back /= BACK;
        }
        Ok(true)
    }

    /// Compares the shadows with the frame `motion`, the directions of the fine run. Every frame
    /// after the start must be compared once, in order, because rounding errors add up. All steps
    /// towards it must have been made. Neither is checked. A shadow that is not prepared counts as
    /// diverged.
    ///
    /// Returns the largest rounding error that is expected of the motion in 64 bits, with the steps
    /// given to [`new`](Self::new), in units of the tolerance. `rods` are the lengths of the rods
    /// in the same unit. The result is NaN if the error is unknown: once a shadow that is still
    /// needed, or the motion itself, has diverged.
    pub fn compare(&mut self, rods: [f32; 2], motion: &Directions) -> f32 {
        self.has_begun = true;

        // Find the farthest shadow.
        let mut farthest = 0;
        let mut growth = 0.0;
        let mut shown = 0.0;
        for (number, shadow) in self.needed() {
            let frame = shadow.run.frame();
            let off = distance([1.0; 2], &frame, motion);
            shadow.is_far = off > FAR;

            let drawn_back = shadow.drawn_back / NEAR as f32;
            if off * drawn_back > growth {
                farthest = number;
            }
            growth = greater(off * drawn_back, growth);
            shown = greater(distance(rods, &frame, motion) * drawn_back, shown);
        }

        // Keep only that, once it has grown enough.
        if growth >= self.aligned {
            self.kept = Some(farthest);
        }

        // Update the growth.
        self.growth = greater(growth, self.growth);
        self.shown = greater(shown, self.shown);

        // Add the rounding error of this frame.
        let of_frame = self.of_frame / self.growth;
        self.roundings = libm::sqrtf(self.roundings * self.roundings + of_frame * of_frame);
        self.shown * self.roundings
    }
}

/// Returns the units of the numbers of a state, in the order a1, a2, p1, p2: 1 rad, and the
/// momenta, kg m^2/s, of rods that turn at half the fastest `rate`, rad/s.
fn scales(&Parameters { m1, m2, l1, l2, .. }: &Parameters<f64>, rate: f64) -> [f64; 4] {
    let half = 0.5 * rate;
    [1.0, 1.0, (m1 + m2) * l1 * l1 * half, m2 * l2 * l2 * half]
}

/// Returns `one` - `other` in the order a1, a2, p1, p2, with angles between -pi and pi.
fn difference(one: &State<f64>, other: &State<f64>) -> [f64; 4] {
    const TURN: f64 = 2.0 * core::f64::consts::PI;
    let turned = |angle: f64| angle - TURN * libm::rint(angle / TURN);
    [
        turned(one.a1 - other.a1),
        turned(one.a2 - other.a2),
        one.p1 - other.p1,
        one.p2 - other.p2,
    ]
}
