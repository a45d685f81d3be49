//! Shadows: motions close to another one, which measure by how much a small error of that one grows.
//!
//! An error that arises in a run is carried on by the motion. In a chaotic motion it grows
//! exponentially, soon along a single direction of the phase space, and whatever size it began with.
//! So does the distance of a shadow. A shadow may be computed in 32 bits and coarse steps, because it
//! is kept so far away, 2^-16 to 2^-6 rad, that its own errors hardly matter: a shadow that has gone
//! farther is drawn back along the line to the motion.
//!
//! Four shadows start, each off by one of the four numbers of the state. An error of any direction is
//! a sum of theirs, so that the farthest shadow grows at least half as much as any error. When one has
//! grown by 1000, all that have grown point along the direction of growth, and the farthest is kept.
//! A small growth says too little: without any instability a push moves a bob farther every second.
//!
//! With G(t) the growth of the farthest shadow since the start, an error e that arises at s is e
//! G(t)/G(s) at t. The roundings of different frames are independent, so that the squares of e/G(s)
//! add up.

use super::candidate::{distance, greater};
use super::cost::Stepping;
use super::problem::Problem;
use super::run::{Directions, SingleRun};
use super::trial::Run;
use crate::error::Error;
use crate::pendulum::{Parameters, State};

/// The distance at which a shadow starts, rad.
const NEAR: f64 = 1.0 / (1 << 16) as f64;
/// The distance at which a shadow is drawn back, rad, and by which factor.
const FAR: f32 = 1.0 / (1 << 6) as f32;
const BACK: f32 = 1.0 / (1 << 10) as f32;
/// The growth after which the farthest shadow is kept alone.
const ALIGNED: f32 = 1000.0;

/// The rounding error of a run in 64 bits, rad: of its start, for each radian that the fastest motion of
/// the energy turns, and of each step.
///
/// These are measured: with 12 steps per frame the errors of 60 motions from high starts came to at most
/// 0.4 of the bound, in the median to 0.04. Test `plan_study` holds the bound against the exact motion.
const ROUNDING: [f32; 3] = [2.4e-16, 3.2e-16, 6.4e-17];

/// Four motions close to another one, of which the farthest is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadows {
    runs: [Run<SingleRun>; 4],
    /// The shadow that is kept; `None` while all are.
    kept: Option<usize>,
    /// True if the one that is kept must be drawn back.
    is_far: bool,
    has_begun: bool,
    /// The growth of a shadow over the growth of its distance since it was last drawn back.
    drawn_back: f32,
    /// The greatest growth so far: of directions, rad, and of what is shown, in units of the
    /// tolerance. Each for a radian at the start.
    growth: f32,
    shown: f32,
    /// The root of the sum of squares of all roundings until now, each over the growth when it arose.
    roundings: f32,
    /// The fastest rate that the energy allows, rad/s, and the rounding error of a frame, rad.
    rate: f64,
    of_frame: f32,
}

impl Shadows {
    /// Creates the shadows of a motion in 64 bits that makes `steps` steps per frame.
    pub fn new(stepping: Stepping, problem: &Problem, steps: u32) -> Self {
        // An admissible step is a quarter of the time in which the fastest motion turns a radian.
        let rate = super::cost::admissible_step(problem).map_or(0.0, |step| 0.25 / step);
        let [of_start, of_radian, of_step] = ROUNDING;
        // The shorter rod 2, the coarser the unit of its rate. Measured, as the bounds are.
        let Parameters { l1, l2, .. } = problem.pendulum;
        let short = if l2 < l1 { (l1 / l2) as f32 } else { 1.0 };
        let coarser = short * short * short;
        Self {
            runs: [Run::new(stepping); 4],
            kept: None,
            is_far: false,
            has_begun: false,
            drawn_back: 1.0,
            growth: 1.0,
            shown: 0.0,
            roundings: of_start,
            rate,
            of_frame: (of_radian * (rate / f64::from(problem.rate)) as f32
                + of_step * steps as f32)
                * coarser,
        }
    }

    /// Returns the shadows that are still needed.
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<SingleRun>> {
        let kept = self.kept;
        let runs = self.runs.iter_mut().enumerate();
        runs.filter(move |(place, _)| kept.is_none_or(|kept| kept == *place))
            .map(|(_, run)| run)
    }

    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Returns true if [`prepare`](Self::prepare) has something to do.
    pub fn must_prepare(&self) -> bool {
        self.is_far
    }

    /// Prepares one shadow close to a motion in the state `motion`, or draws one back to it. Returns
    /// false if there is nothing to do.
    pub fn prepare(&mut self, problem: &Problem, motion: &State<f64>) -> Result<bool, Error> {
        let place = match self.kept {
            Some(place) if self.is_far => place,
            _ => match self.runs.iter().position(|run| run.motion.is_none()) {
                Some(place) if self.kept.is_none() => place,
                _ => return Ok(false),
            },
        };
        let run = &mut self.runs[place % 4];
        let by = match &run.motion {
            Some(shadow) => {
                let factor = f64::from(BACK);
                difference(&shadow.state(), motion).map(|by| by * factor)
            }
            None => {
                let mut by = [0.0; 4];
                by[place % 4] = NEAR * scales(&problem.pendulum, self.rate)[place % 4];
                by
            }
        };

        let Stepping { method, steps } = run.stepping;
        let per_second = f64::from(problem.rate) * f64::from(steps);
        let prepared = |sign: f64| {
            let [a1, a2, p1, p2] = <[f64; 4]>::from(*motion);
            let [by1, by2, by3, by4] = by.map(|by| sign * by);
            let state = State {
                a1: a1 + by1,
                a2: a2 + by2,
                p1: p1 + by3,
                p2: p2 + by4,
            };
            SingleRun::new(method, &(problem.pendulum, state), per_second)
        };
        run.motion = Some(prepared(1.0).or_else(|_| prepared(-1.0))?);
        if self.is_far {
            self.is_far = false;
            self.drawn_back /= BACK;
        }
        Ok(true)
    }

    /// Compares the shadows with the frame `motion`. Returns the rounding error that a run in 64 bits
    /// may have, in units of the tolerance, which `rods` are measured in; NaN if that is unknown.
    pub fn compare(&mut self, rods: [f32; 2], motion: &Directions) -> f32 {
        self.has_begun = true;
        let frames = self.runs.each_mut().map(Run::frame);
        let is_kept = |place: usize| self.kept.is_none_or(|kept| kept == place);
        let (mut farthest, mut largest, mut greatest_shown) = (0, 0.0, 0.0);
        for (place, frame) in frames
            .iter()
            .enumerate()
            .filter(|&(place, _)| is_kept(place))
        {
            let off = distance([1.0; 2], frame, motion);
            if off > largest || off.is_nan() {
                farthest = place;
                largest = off;
            }
            greatest_shown = greater(greatest_shown, distance(rods, frame, motion));
        }

        let growth = largest * self.drawn_back / NEAR as f32;
        let shown = greatest_shown * self.drawn_back / NEAR as f32;
        self.growth = greater(growth, self.growth);
        self.shown = greater(shown, self.shown);
        let of_frame = self.of_frame / self.growth;
        self.roundings = libm::sqrtf(self.roundings * self.roundings + of_frame * of_frame);

        if self.kept.is_none() && growth >= ALIGNED {
            self.kept = Some(farthest);
        }
        self.is_far = self.kept.is_some() && largest > FAR;
        self.shown * self.roundings
    }
}

/// Returns the units of the numbers of a state: radians, and momenta at which the rods turn at about
/// half the fastest rate.
fn scales(&Parameters { m1, m2, l1, l2, .. }: &Parameters<f64>, rate: f64) -> [f64; 4] {
    let half = 0.5 * rate;
    [1.0, 1.0, (m1 + m2) * l1 * l1 * half, m2 * l2 * l2 * half]
}

/// Returns `one` - `other`, the angles without whole turns.
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
