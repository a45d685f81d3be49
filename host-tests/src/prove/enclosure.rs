//! The set that the true motion is in, step by step (R. Lohner, "Enclosing the solutions of ordinary initial and boundary value
//! problems", 1987).

use std::array::from_fn;

use super::axes::{IDENTITY, Matrix, defect, orthonormal};
use super::ball::{Ball, largest, up};
use super::discs::Discs;
use super::equations::{Constants, series};
use super::fixed::{Fixed, MOST_TERMS, ULP};
use super::number::Number;
use super::tangents::Tangents;

/// The finest step: a unit of time by two to the power of this.
const MOST_HALVINGS: u32 = 20;

/// How fine the arithmetic is.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// The most terms of the midpoint's power series, up to 48.
    pub terms: usize,
    /// The highest power kept of the derivatives' power series.
    pub tangents: usize,
    /// Axes are rounded to multiples of this.
    pub axes: f64,
    /// What each allowance is multiplied by, 1 but in a test that takes one away: for roundings of the midpoint, the rest of its series, the
    /// rest of the derivatives' series, axes not quite at right angles.
    pub allowances: [f64; 4],
}

impl Default for Fineness {
    fn default() -> Self {
        Self { terms: MOST_TERMS, tangents: 12, axes: 0.0, allowances: [1.0; 4] }
    }
}

/// The set has grown too large to be followed, or its numbers too large for the arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the set that the motion is in has grown too large, or its numbers too large for the arithmetic")]
pub struct Lost;

/// The true (sin a1, cos a1, S, C, P1, P2) is at middle + axes y, where |y_i| <= radii_i.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    constants: Constants<Fixed>,
    unit: i32,
    middle: [Fixed; 6],
    axes: Matrix<f64>,
    radii: [f64; 6],
    fineness: Fineness,
}

impl Enclosure {
    /// From anywhere in `start`; a unit of time is a frame by two to the power of `unit`.
    pub fn new(constants: Constants<Fixed>, unit: i32, start: [Fixed; 6], fineness: Fineness) -> Self {
        let parts = start.map(Fixed::split);
        let (middle, radii) = (parts.map(|(middle, _)| middle), parts.map(|(_, radius)| radius));
        Self { constants, unit, middle, axes: IDENTITY, radii, fineness }
    }

    /// The smallest box about the set: (sin a1, cos a1, S, C, P1, P2).
    pub fn hull(&self) -> [Fixed; 6] {
        let extent = self.extent();
        from_fn(|i| self.middle[i].wider(extent[i]))
    }

    /// How far each number may be from its middle.
    pub fn extent(&self) -> [f64; 6] {
        self.axes.map(|row| up(row.iter().zip(self.radii).map(|(x, radius)| x.abs() * radius).sum::<f64>()))
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
        let moved =
            v.map(|row| from_fn(|j| (0..6).fold(Ball::ZERO, |sum, l| sum + row[l] * Ball::exact(self.axes[l][j]))));
        let change = largest(self.extent().iter().zip(&discs.discs).map(|(extent, disc)| up(extent / disc.radius)));
        let [.., rest, _] = self.fineness.allowances;
        let rest = rest * discs.tangents_tail(&rough, order, halvings) * change;
        let added = from_fn(|i| up(missed[i] + discs.discs[i].radius * rest));

        let (axes, radii) = self.turned(&moved, &added);
        if !radii.iter().all(|radius| radius.is_finite()) {
            return None;
        }
        (self.middle, self.axes, self.radii) = (middle, axes, radii);
        Some(())
    }

    /// Where the midpoint is after a step, and how far from there it may be.
    fn moved_middle(&self, discs: &Discs, halvings: u32) -> ([Fixed; 6], [f64; 6]) {
        let Fineness { terms, allowances: [rounding, rest, ..], .. } = self.fineness;
        let order = (1..terms - 1).find(|&order| (0..6).all(|i| discs.tail(i, order) < ULP)).unwrap_or(terms - 1);
        let z = series(&self.constants, &self.middle, order, halvings);
        let ends = z.map(|z| z.into_iter().rev().fold(Fixed::ZERO, |sum, term| sum + term).split());
        (ends.map(|(end, _)| end), from_fn(|i| up(rounding * ends[i].1 + rest * discs.tail(i, order))))
    }

    /// New axes Q, and radii about them of all that is `moved` y + d, |d_i| <= `added`_i.
    ///
    /// Theorem (Neumann's series): with E = I - Q'Q and |E| <= e < 1 in the largest row sum, Q^-1 = (I - E)^-1 Q', so that
    /// |Q^-1 w - Q'w| <= e/(1 - e) |Q'w|.
    fn turned(&self, moved: &Matrix<Ball>, added: &[f64; 6]) -> (Matrix<f64>, [f64; 6]) {
        let Fineness { axes: coarseness, allowances: [.., allowance], .. } = self.fineness;
        let mut axes = orthonormal(moved, &self.radii);
        if coarseness > 0.0 {
            axes = axes.map(|row| row.map(|x| (x / coarseness).round() * coarseness));
        }
        let mut missing = defect(&axes);
        if !(missing < 0.5) {
            (axes, missing) = (IDENTITY, 0.0);
        }
        let along: [f64; 6] = from_fn(|i| {
            let turned = |j: usize| (0..6).fold(Ball::ZERO, |sum, l| sum + Ball::exact(axes[l][i]) * moved[l][j]);
            up((0..6).map(|j| turned(j).size() * self.radii[j] + axes[j][i].abs() * added[j]).sum::<f64>())
        });
        let more = allowance * missing / (1.0 - missing) * largest(along.into_iter());
        (axes, along.map(|radius| up(radius + more)))
    }
}
