//! The set that the true motion is in, step by step: a midpoint, and segments about it that the derivatives after the start turn and
//! stretch (R. Lohner, "Enclosing the solutions of ordinary initial and boundary value problems", 1987; a sum of segments in place of
//! his one parallelepiped: W. Kuehn, "Rigorously computed orbits of dynamical systems without the wrapping effect", 1998).

use std::array::from_fn;

use super::ball::{Ball, largest, up};
use super::discs::Discs;
use super::equations::{Constants, series};
use super::fixed::{Fixed, MOST_TERMS, ULP};
use super::number::Number;
use super::tangents::Tangents;

/// Row by row.
type Matrix<T> = [[T; 6]; 6];

/// Steps whose errors are kept in a box, before they become segments.
const STEPS: u32 = 8;
/// The most segments, before a box takes the place of all.
const SEGMENTS: usize = 6 * 2048;
/// The finest step: a unit of time by two to the power of this.
const MOST_HALVINGS: u32 = 20;

/// How fine the arithmetic is.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// The most terms of the midpoint's power series, up to 48.
    pub terms: usize,
    /// The highest power kept of the derivatives' power series.
    pub tangents: usize,
    /// What each allowance is multiplied by, 1 but in a test that takes one away: for roundings of the midpoint, the rest of its series,
    /// the rest of the derivatives' series, roundings of the segments.
    pub allowances: [f64; 4],
}

impl Default for Fineness {
    fn default() -> Self {
        Self { terms: MOST_TERMS, tangents: 12, allowances: [1.0; 4] }
    }
}

/// The set has grown too large to be followed, or its numbers too large for the arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the set that the motion is in has grown too large, or its numbers too large for the arithmetic")]
pub struct Lost;

/// The true (sin a1, cos a1, S, C, P1, P2) is at middle + A (the sum of y_k segment_k) + d, where |y_k| <= 1 and |d_i| <= about_i.
#[derive(Clone, Debug)]
pub struct Enclosure {
    constants: Constants<Fixed>,
    unit: i32,
    middle: [Fixed; 6],
    segments: Vec<[f64; 6]>,
    /// The sums of the segments' sizes.
    reach: [f64; 6],
    /// A: what the segments have been moved by since they were last written down.
    moved: Matrix<Ball>,
    /// The radii of the box about all that.
    about: [f64; 6],
    steps: u32,
    fineness: Fineness,
}

fn identity() -> Matrix<Ball> {
    from_fn(|i| from_fn(|j| Ball::exact(if i == j { 1.0 } else { 0.0 })))
}

impl Enclosure {
    /// From anywhere in `start`; a unit of time is a frame by two to the power of `unit`.
    pub fn new(constants: Constants<Fixed>, unit: i32, start: [Fixed; 6], fineness: Fineness) -> Self {
        let parts = start.map(Fixed::split);
        let (middle, about) = (parts.map(|(middle, _)| middle), parts.map(|(_, radius)| radius));
        let (segments, reach, moved) = (Vec::new(), [0.0; 6], identity());
        let mut set = Self { constants, unit, middle, segments, reach, moved, about, steps: 0, fineness };
        set.settle();
        set
    }

    /// The smallest box about the set: (sin a1, cos a1, S, C, P1, P2).
    pub fn hull(&self) -> [Fixed; 6] {
        let extent = self.extent();
        from_fn(|i| self.middle[i].wider(extent[i]))
    }

    /// How far each number may be from its middle.
    pub fn extent(&self) -> [f64; 6] {
        from_fn(|i| up(weighted(&self.moved[i], &self.reach) + self.about[i]))
    }

    /// The constants of the equations.
    pub fn constants(&self) -> &Constants<Fixed> {
        &self.constants
    }

    /// A unit of time is a frame by two to the power of this.
    pub fn unit(&self) -> i32 {
        self.unit
    }

    /// Moves on by a frame.
    pub fn advance(&mut self) -> Result<(), Lost> {
        let frame = self.unit.unsigned_abs();
        let (units, halvings) = if self.unit < 0 { (1 << frame, 0) } else { (1, frame) };
        (0..units).try_for_each(|_| self.advance_by(halvings))
    }

    /// By 2^-`halvings` units of time, in one step or more.
    fn advance_by(&mut self, halvings: u32) -> Result<(), Lost> {
        if halvings > MOST_HALVINGS {
            return Err(Lost);
        }
        if self.step(halvings).is_none() {
            self.advance_by(halvings + 1)?;
            self.advance_by(halvings + 1)?;
        }
        Ok(())
    }

    /// Theorem (mean value): what starts at e from the middle ends at V e from where that ends, V being among the derivatives after the
    /// start from all starts in the hull.
    fn step(&mut self, halvings: u32) -> Option<()> {
        let hull = self.hull().map(Fixed::ball);
        let rough = self.constants.map(Fixed::ball);
        let discs = Discs::around(&rough, &hull, halvings)?;
        let (middle, missed) = self.moved_middle(&discs, halvings);

        let order = self.fineness.tangents;
        let z = series(&rough.map(Tangents::constant), &Tangents::variables(&hull), order, halvings);
        let v = z.map(|z| z.into_iter().rev().fold(Tangents::ZERO, |sum, term| sum + term).1);
        let change = largest(self.extent().iter().zip(&discs.discs).map(|(extent, disc)| up(extent / disc.radius)));
        let [.., rest, _] = self.fineness.allowances;
        let rest = rest * discs.tangents_tail(&rough, order, halvings) * change;
        let about: [f64; 6] = from_fn(|i| up(missed[i] + discs.discs[i].radius * rest + weighted(&v[i], &self.about)));
        if !about.iter().all(|radius| radius.is_finite()) {
            return None;
        }
        self.moved = v.map(|row| from_fn(|j| (0..6).fold(Ball::ZERO, |sum, l| sum + row[l] * self.moved[l][j])));
        (self.middle, self.about, self.steps) = (middle, about, self.steps + 1);
        if self.steps.is_multiple_of(STEPS) {
            self.settle();
        }
        Some(())
    }

    /// Writes down where the segments have moved to, and makes the box to segments along the axes.
    ///
    /// Theorem (Higham, (3.5)): a sum of six products is rounded by at most 7 u times the sum of their sizes.
    fn settle(&mut self) {
        if self.segments.len() >= SEGMENTS {
            self.about = self.extent();
            self.segments.clear();
        } else {
            let [.., allowance] = self.fineness.allowances;
            let rounding =
                self.moved.map(|row| row.map(|x| Ball::exact(x.radius + 4.0 * f64::EPSILON * x.middle.abs())));
            self.about = from_fn(|i| up(self.about[i] + allowance * weighted(&rounding[i], &self.reach)));
            let moved = self.moved.map(|row| row.map(|x| x.middle));
            for segment in &mut self.segments {
                *segment = moved.map(|row| row.iter().zip(*segment).map(|(x, y)| x * y).sum());
            }
        }
        let about = self.about;
        self.segments.extend((0..6).map(|i| -> [f64; 6] { from_fn(|j| if i == j { about[i] } else { 0.0 }) }));
        let add = |sum: [f64; 6], segment: &[f64; 6]| from_fn(|i| sum[i] + segment[i].abs());
        // up to 3 2^12 sums
        self.reach = self.segments.iter().fold([0.0; 6], add).map(|sum| up(up(up(up(sum)))));
        (self.moved, self.about) = (identity(), [0.0; 6]);
    }

    /// Where the midpoint is after a step, and how far from there it may be.
    fn moved_middle(&self, discs: &Discs, halvings: u32) -> ([Fixed; 6], [f64; 6]) {
        let Fineness { terms, allowances: [rounding, rest, ..], .. } = self.fineness;
        let order = (1..terms - 1).find(|&order| (0..6).all(|i| discs.tail(i, order) < ULP)).unwrap_or(terms - 1);
        let z = series(&self.constants, &self.middle, order, halvings);
        let ends = z.map(|z| z.into_iter().rev().fold(Fixed::ZERO, |sum, term| sum + term).split());
        (ends.map(|(end, _)| end), from_fn(|i| up(rounding * ends[i].1 + rest * discs.tail(i, order))))
    }
}

/// A row of a matrix by a box's radii, at most.
fn weighted(row: &[Ball; 6], radii: &[f64; 6]) -> f64 {
    up(row.iter().zip(radii).map(|(x, radius)| x.size() * radius).sum::<f64>())
}
