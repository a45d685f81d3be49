//! The exact motion, enclosed step by step in a set that is proved to contain it.
//!
//! The set is a midpoint and segments about it, which the derivatives with respect to the start
//! turn and stretch (R. Lohner, "Enclosing the solutions of ordinary initial and boundary value
//! problems", 1987). A sum of segments replaces his single parallelepiped (W. Kuehn, "Rigorously
//! computed orbits of dynamical systems without the wrapping effect", 1998).
//!
//! No bound is an estimate. Each one is documented with its theorem, and includes all roundings.

mod equations;
mod fixed;
mod start;

use std::array::from_fn;
use std::sync::atomic::{AtomicUsize, Ordering};

pub use equations::Equations;
use equations::{STARTS, discs};
pub use fixed::Fixed;
pub use fixed::up;
use fixed::{MOST_TERMS, ULP};
pub use start::{Start, fastest_rate, sin_cos};

/// The number of steps whose errors are collected in a box before it becomes segments.
const STEPS: u32 = 64;
/// The largest number of segments. Beyond it, a box replaces all segments except the six of the
/// start.
const SEGMENTS: usize = 6 * 2048;
const MOST_HALVINGS: i32 = 24;

#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    pub terms: usize,
    pub tangents: usize,
    /// The distance from the midpoint for a difference quotient in place of a derivative, relative
    /// to the radius of the disc.
    pub offset: f64,
    /// The factors of the allowances, all 1 except in tests that remove one: for the roundings of
    /// the midpoint, the remainder of its series, the errors of the derivatives, and the roundings
    /// of the segments.
    pub allowances: [f64; 4],
}

impl Default for Fineness {
    fn default() -> Self {
        Self {
            terms: MOST_TERMS,
            tangents: 10,
            offset: 1.0 / (1_u64 << 56) as f64,
            allowances: [1.0; 4],
        }
    }
}

/// An enclosure of the true (sin a1, cos a1, S, C, P1, P2). S and C are the sine and cosine of a1 -
/// a2; P1 and P2 are the scaled momenta of [`Equations`].
///
/// These are at middle + the sum of y_k segment_k + d, where |y_k| <= 1 and |d_i| <= about_i.
#[derive(Clone, Debug)]
pub struct Enclosure {
    pub equations: Equations,
    pub frame: (i32, u16),
    middle: [Fixed; 6],
    /// The first six belong to the start.
    segments: Vec<[f64; 6]>,
    start: [f64; 6],
    about: [f64; 6],
    steps: u32,
    fineness: Fineness,
}

impl Enclosure {
    pub fn new(
        equations: Equations,
        frame: (i32, u16),
        start: [Fixed; 6],
        fineness: Fineness,
    ) -> Self {
        // No segment has the length zero.
        let about = start.map(|x| x.radius() + ULP);
        let middle = start.map(Fixed::middle);
        let segments = Vec::new();
        let mut set = Self {
            equations,
            frame,
            middle,
            segments,
            start: about,
            about,
            steps: 0,
            fineness,
        };
        set.settle();
        set
    }

    pub fn hull(&self) -> [Fixed; 6] {
        let extent = self.extent(0);
        from_fn(|i| self.middle[i].wider(extent[i]))
    }

    fn extent(&self, left_out: usize) -> [f64; 6] {
        let add = |sum: [f64; 6], segment: &[f64; 6]| from_fn(|i| sum[i] + segment[i].abs());
        self.segments[left_out..]
            .iter()
            .fold(self.about, add)
            .map(up)
    }

    /// Returns the approximate growth of a small error of the start, for information only.
    pub fn growth(&self) -> f64 {
        let of = |i: usize| {
            self.segments
                .iter()
                .zip(self.start)
                .map(|(x, start)| x[i].abs() / start)
                .sum()
        };
        (0..6).map(of).fold(0.0, f64::max)
    }

    pub fn directions(&self) -> [[Fixed; 2]; 2] {
        let [sin1, cos1, s, c, ..] = self.hull();
        [[sin1, cos1], [sin1 * c - cos1 * s, cos1 * c + sin1 * s]]
    }

    /// Advances by a frame, in pieces of 1 to 2^-24 frames, as large as can be enclosed. Returns
    /// `None` if the set has become too large to be followed. It must not be used any more then.
    pub fn advance(&mut self) -> Option<()> {
        self.advance_unless(&AtomicUsize::new(0))
    }

    pub fn advance_unless(&mut self, stopped: &AtomicUsize) -> Option<()> {
        let mut left = vec![0];
        while let Some(halvings) = left.pop() {
            (stopped.load(Ordering::Relaxed) == 0).then_some(())?;
            if self.step(halvings).is_none() {
                left.extend([(halvings < MOST_HALVINGS).then_some(halvings + 1)?; 2]);
            }
        }
        Some(())
    }

    /// Advances by 2^-`halvings` frames.
    ///
    /// A motion that starts at m + e, where m is the midpoint, ends at F(m + e). F is the sum of a
    /// series up to any order, and a remainder.
    ///
    /// Theorem (Cauchy's estimate on the disc m + s e, |s| <= 1/t, `share` being t): |F(m + e) -
    /// F(m) - F'(m) e| <= B t^2/(1 - t) if F is within B of m there, as every sum of the series is;
    /// and if F is at most b, |F(m + e) - F(m)| <= b t/(1 - t). The first inequality for one
    /// coordinate, e being `offset`, bounds the error of the difference quotient that replaces the
    /// derivative. In time, the coefficient of t^k is at most the disc's radius times `time`^-k,
    /// and the remainder of a series beyond an order is at most `tail` times the radius.
    fn step(&mut self, halvings: i32) -> Option<()> {
        let (unit, rate) = self.frame;
        let step = Fixed::fraction(1, rate.into(), unit - halvings);
        let extent = self.extent(0);
        extent.iter().all(|&extent| extent < 1.0).then_some(())?;

        let (time, radii) = discs(&self.equations, &self.middle, &extent, step)?;
        let Fineness {
            terms,
            tangents,
            offset,
            allowances: [rounding, rest, bend, turn],
        } = self.fineness;

        // The midpoint at the end, by a series of the order that is needed.
        let tail = |order: usize| up((0..order).fold(1.0 / (time - 1.0), |power, _| power / time));
        let ends = |order: usize| radii.iter().all(|radius| radius * tail(order) < ULP);
        let order = (1..terms - 1)
            .find(|&order| ends(order))
            .unwrap_or(terms - 1);
        let low = order.min(tangents);
        let z = self.equations.series(&self.middle, order, step);
        let end = z.each_ref().map(|z| sum(z));
        let short = z.each_ref().map(|z| sum(&z[..=low]));

        // The derivatives `v` with respect to the start, by difference quotients.
        let off = radii.map(|radius| (offset * radius).log2().floor().exp2());
        let columns: [[Fixed; 6]; 6] = from_fn(|j| {
            let mut start = self.middle;
            start[j] = start[j] + Fixed::of(off[j]);
            let moved = self.equations.series(&start, low, step);
            from_fn(|i| sum(&moved[i]) - short[i])
        });
        let v: [[f64; 6]; 6] = from_fn(|i| from_fn(|j| columns[j][i].about() / off[j]));

        // The allowances for everything that is left out.
        let share = (0..6)
            .map(|i| up(extent[i] / (STARTS * radii[i])))
            .fold(0.0, f64::max);

        // The last term is for six quotients, each with an error of no more than twice this.
        let lacking = bend * share / (1.0 - share) * (share + tail(low) + 12.0 * offset / STARTS);

        // Higham, (3.5): a sum of six products is rounded by at most 7 u, u = 2^-53, times the sum
        // of their sizes. One u is for v.
        let rounded = |i: usize, j: usize| {
            columns[j][i].radius() / off[j] + 5.0 * f64::EPSILON * v[i][j].abs()
        };

        // The new box: the old one, moved, and the allowances.
        let about = from_fn(|i| {
            let moved = (0..6)
                .map(|j| v[i][j].abs() * self.about[j] + turn * rounded(i, j) * extent[j])
                .sum::<f64>();
            up(rounding * end[i].radius() + radii[i] * (rest * tail(order) + lacking) + moved)
        });
        about
            .iter()
            .all(|radius| radius.is_finite())
            .then_some(())?;

        for segment in &mut self.segments {
            *segment = v.map(|row| row.iter().zip(*segment).map(|(x, y)| x * y).sum());
        }
        self.middle = end.map(Fixed::middle);
        self.about = about;
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS) {
            self.settle();
        }
        Some(())
    }

    fn settle(&mut self) {
        if self.segments.len() >= SEGMENTS {
            self.about = self.extent(6);
            self.segments.truncate(6);
        }
        let about = std::mem::take(&mut self.about);
        self.segments.extend(
            (0..6).map(|i| -> [f64; 6] { from_fn(|j| if i == j { about[i] } else { 0.0 }) }),
        );
    }
}

fn sum(terms: &[Fixed]) -> Fixed {
    terms
        .iter()
        .rev()
        .fold(Fixed::ZERO, |sum, &term| sum + term)
}
