//! Where the solution may be in complex time: what bounds every remainder.

use super::ball::{Ball, largest, up};
use super::equations::{Constants, series};
use super::tangents::Tangents;

/// How often a radius is made larger before a shorter time is tried, and by how much more than was missing.
const TRIES: usize = 50;
const GROWTH: f64 = 1.04;
/// Times tried, in steps, the longest first. The shortest lets a power series of 48 terms end at 2^-116.
const TIMES: [f64; 7] = [24.0, 16.0, 12.0, 10.0, 8.0, 7.0, 6.0];

/// Discs that no solution leaves in complex times t, |t| <= `time`, whichever of a set it starts from.
#[derive(Clone, Copy, Debug)]
pub struct Discs {
    /// One for each number.
    pub discs: [Ball; 6],
    /// In steps.
    pub time: f64,
}

impl Discs {
    /// About the set `hull`, for the longest time found; none if that is shorter than all of [`TIMES`].
    ///
    /// Theorem (Picard and Lindeloef for analytic equations; Hille, Ordinary Differential Equations in the Complex Domain, 2.3): if
    /// z0 + t f(B) is in the product of discs B for |t| <= T, one solution from z0 exists there, is analytic, and stays in B. f has no pole in
    /// B, for else the radius of its inverse is infinite.
    pub fn around(constants: &Constants<Ball>, hull: &[Ball; 6], halvings: u32) -> Option<Self> {
        TIMES.iter().find_map(|&time| Self::within(constants, hull, halvings, time))
    }

    fn within(constants: &Constants<Ball>, hull: &[Ball; 6], halvings: u32, time: f64) -> Option<Self> {
        let mut discs = *hull;
        for _ in 0..TRIES {
            let mut fits = true;
            let slopes = series(constants, &discs, 1, halvings);
            for ((disc, slope), start) in discs.iter_mut().zip(&slopes).zip(hull) {
                let needed = up(start.radius + time * slope[1].size());
                // NaN does not hold either
                let holds = needed <= disc.radius;
                if !holds {
                    (fits, disc.radius) = (false, needed * GROWTH);
                }
            }
            if !discs.iter().all(|disc| disc.radius.is_finite()) {
                return None;
            }
            if fits {
                return Some(Self { discs, time });
            }
        }
        None
    }

    /// What number `index` of the series has beyond `order` after a step, at most.
    ///
    /// Theorem (Cauchy's estimate): the coefficient of t^k is at most the disc's radius by `time`^-k, for k > 0.
    pub fn tail(&self, index: usize, order: usize) -> f64 {
        up(self.discs[index].radius * geometric(self.time, order))
    }

    /// What the derivatives after the start have beyond `order` after a step makes of a change of the start by `change`, relative to the discs'
    /// radii, at most: so measured, too.
    ///
    /// Theorem (Gronwall): in any norm the solution V of V' = Df V, V(0) = I has |V(t)| <= exp(L |t|) where |Df| <= L; here the norm is the largest
    /// component over its disc's radius, L the largest row sum of |Df| over the discs. Then Cauchy's estimate as above, on the best circle.
    pub fn tangents_tail(&self, constants: &Constants<Ball>, order: usize, halvings: u32) -> f64 {
        let start = Tangents::variables(&self.discs);
        let slopes = series(&constants.map(Tangents::constant), &start, 1, halvings);
        let row = |i: usize| {
            let sum = (0..6).map(|j| slopes[i][1].1[j].size() * self.discs[j].radius).sum::<f64>();
            up(sum / self.discs[i].radius)
        };
        let rate = largest((0..6).map(row));
        let circles = (4..=16).map(|part| self.time * f64::from(part) / 16.0).filter(|&time| time > 1.0);
        circles.map(|time| up(exponential(up(rate * time)) * geometric(time, order))).fold(f64::INFINITY, f64::min)
    }
}

/// The sum of time^-k over k > `order`, at most: time^-order/(time - 1).
fn geometric(time: f64, order: usize) -> f64 {
    up((0..order).fold(1.0 / (time - 1.0), |power, _| power / time))
}

/// exp x at most, for x >= 0: exp y <= 1/(1 - y) for y < 1, and x is 512 of these; infinite beyond.
fn exponential(x: f64) -> f64 {
    let root = 1.0 / (1.0 - x / 512.0);
    if x < 256.0 { up((0..9).fold(root, |power, _| power * power)) } else { f64::INFINITY }
}
