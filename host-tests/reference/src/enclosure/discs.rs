//! Where the solution may be in complex time: what bounds every remainder.

use std::array::from_fn;

use super::equations::Constants;
use super::fixed::{Fixed, up};

/// The share of the discs' radii within which solutions may start: a sixteenth.
pub const STARTS: f64 = 0.0625;
/// The least radius, and how many times an extent of the set it is: so [`Discs::share`] is at most 1/4.
const LEAST: [f64; 2] = [1.0 / 65_536.0, 64.0];
/// Times tried, in steps, and how often radii are made those that such a time needs, with a little to spare.
const TIMES: [f64; 5] = [24.0, 16.0, 12.0, 9.0, 7.0];
const TRIES: usize = 12;
/// The shortest time of use, in steps: it lets a power series of 48 terms end at 2^-116.
const SHORTEST: f64 = 6.0;

/// Discs that no solution leaves in complex times t, |t| <= `time`, if it starts within [`STARTS`] of their radii.
#[derive(Clone, Copy, Debug)]
pub struct Discs {
    /// About the midpoint.
    pub radii: [f64; 6],
    /// In steps.
    time: f64,
}

impl Discs {
    /// About `middle`, for the longest time found; none if that is too short.
    ///
    /// Theorem (Picard and Lindeloef for analytic equations; Hille, Ordinary Differential Equations in the Complex Domain, 2.3): if
    /// z0 + t f(B) is in the product of discs B for |t| <= T, one solution from z0 exists there, is analytic in t and z0, and stays in B. f
    /// has no pole in B, for else the radius of its inverse is infinite.
    pub fn about(constants: &Constants, middle: &[Fixed; 6], extent: &[f64; 6], step: Fixed) -> Option<Self> {
        let least = extent.map(|extent| LEAST[0].max(LEAST[1] * extent));
        let mut best = Self { radii: least, time: 0.0 };
        for time in TIMES {
            let mut radii = least;
            for _ in 0..TRIES {
                let slopes = constants.series(&from_fn(|i| middle[i].wider(radii[i])), 1, step).map(|z| z[1].size());
                // twice the share: what is rounded is far less
                let held = (0..6).map(|i| (1.0 - 2.0 * STARTS) * radii[i] / slopes[i]).fold(time, f64::min);
                if held > best.time {
                    best = Self { radii, time: held };
                }
                // a slope was infinite
                if held == 0.0 {
                    break;
                }
                radii = from_fn(|i| least[i].max(1.1 * time * slopes[i]));
            }
        }
        (best.time >= SHORTEST).then_some(best)
    }

    /// What a series has beyond `order` after a step, by the disc's radius, at most: time^-order/(time - 1).
    ///
    /// Theorem (Cauchy's estimate): the coefficient of t^k is at most the radius by `time`^-k, for k > 0.
    pub fn tail(&self, order: usize) -> f64 {
        up((0..order).fold(1.0 / (self.time - 1.0), |power, _| power / self.time))
    }

    /// The largest of `extent` as a share of how far off solutions may start.
    pub fn share(&self, extent: &[f64; 6]) -> f64 {
        (0..6).map(|i| up(extent[i] / (STARTS * self.radii[i]))).fold(0.0, f64::max)
    }
}
