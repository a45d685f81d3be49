//! Steps of any even order, for any system of first-order equations, from one number and no table.

use crate::error::{Error, Parameter};
use crate::numbers::{Lanes, Real, Scalar};

/// The most rows a step may have: order 16.
pub const ROWS: usize = 8;

/// W. B. Gragg's extrapolation of order 2 K (1965; `[Hairer I]`, II.9, his smoothing step left out).
///
/// Row n = 2, 4 .. 2 K goes through the step with n modified midpoints. Where it ends is off by a series in the even powers
/// of 1/n, so that the sum of all ends with the weights w_n, the product over the other rows m of n^2/(n^2 - m^2), is off
/// by order 2 K only. K^2 + 1 evaluations, one sum to each; 4 N numbers of stack.
///
/// The orders 6, 8, 12 and 16 are measured by the repository's tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolation<R> {
    /// K.
    pub(super) rows: usize,
    /// 1/(n/2), the share of the step between every second midpoint.
    shares: [Factor<R>; ROWS],
    /// w_n.
    weights: [Factor<R>; ROWS],
}

/// A factor of any size: w_n reaches 51, more than every kind of number holds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Factor<R> {
    whole: i32,
    rest: R,
}

impl<R: Scalar> Factor<R> {
    fn new(value: f64) -> Self {
        let (whole, rest) = R::split(value);
        Self { whole, rest }
    }

    #[inline(always)]
    fn times(&self, number: R) -> R {
        let product = number * self.rest;
        if self.whole == 0 {
            product
        } else {
            product + number.times(self.whole)
        }
    }
}

/// What is stepped: `L` rows side by side.
pub(crate) trait System<R, const L: usize, const N: usize> {
    /// From now on lane l is in row `rows[l]`, n/2 - 1.
    fn turn_to(&mut self, rows: [usize; L]);
    /// 2H/n f in each lane's row, H being the step.
    fn slope(&mut self, at: &[Lanes<R, L>; N]) -> [Lanes<R, L>; N];
}

/// What a lane goes through.
#[derive(Clone, Copy, PartialEq)]
enum Turn {
    /// The slope where the step starts.
    Start,
    Row(usize),
    Done,
}

impl Turn {
    fn stages(self) -> usize {
        match self {
            Turn::Start => 1,
            Turn::Row(row) => 2 * row + 1,
            Turn::Done => usize::MAX,
        }
    }
}

/// n/2 of a row.
fn half(row: usize) -> f64 {
    (row + 1) as f64
}

/// w_n of one of `rows` rows.
#[inline(never)]
fn weight(row: usize, rows: usize) -> f64 {
    let square = half(row) * half(row);
    let others = (0..rows).filter(|&other| other != row).map(half);
    others.map(|m| square / (square - m * m)).product()
}

impl<R: Scalar> Extrapolation<R> {
    /// Prepares steps of `order` 2, 4 .. 16; refuses any other.
    #[inline(never)]
    pub fn new(order: u32) -> Result<Self, Error> {
        let rows = order as usize / 2;
        if order % 2 == 1 || !(1..=ROWS).contains(&rows) {
            return Err(Error::OutOfRange {
                parameter: Parameter::Order,
                value: f64::from(order),
            });
        }
        let mut method = Self {
            rows,
            shares: [Factor::new(0.0); ROWS],
            weights: [Factor::new(0.0); ROWS],
        };
        for (row, (share, of_end)) in method
            .shares
            .iter_mut()
            .zip(&mut method.weights)
            .enumerate()
        {
            *share = Factor::new(1.0 / half(row));
            if row < rows {
                *of_end = Factor::new(weight(row, rows));
            }
        }
        Ok(method)
    }

    /// How many of a row's slopes add up to where a step ends: n/2 by its weight.
    pub(crate) fn slopes(&self, row: usize) -> f64 {
        weight(row, self.rows) * half(row)
    }

    /// The row that a `lane` of `L` goes through after so many others, the long ones first; then there and back, so that
    /// all end at about the same time.
    fn turn<const L: usize>(&self, lane: usize, before: usize) -> Turn {
        let place = if before % 2 == 0 { lane } else { L - 1 - lane };
        (self.rows.checked_sub(1 + before * L + place)).map_or(Turn::Done, Turn::Row)
    }

    /// Where a step from `origin` ends.
    #[inline(always)]
    pub(crate) fn end<const L: usize, const N: usize>(
        &self,
        system: &mut impl System<R, L, N>,
        origin: &[R; N],
    ) -> [R; N] {
        let [mut first, mut sum, mut reference] = [*origin; 3];
        let mut is_first_end = true;
        let (mut turns, mut before, mut left) = ([Turn::Start; L], [0; L], [1; L]);
        let [mut even, mut odd] = [origin.map(Lanes::splat); 2];
        let (mut behind, mut ahead) = (&mut even, &mut odd);
        system.turn_to([0; L]);
        while turns.iter().any(|&turn| turn != Turn::Done) {
            let stages = left.iter().fold(usize::MAX, |least, &left| least.min(left));
            for _ in 0..stages {
                let slope = system.slope(ahead);
                for i in 0..N {
                    behind[i] = behind[i] + slope[i];
                }
                core::mem::swap(&mut behind, &mut ahead);
            }
            for lane in 0..L {
                left[lane] -= stages;
                if left[lane] > 0 {
                    continue;
                }
                let end: [R; N] = core::array::from_fn(|i| ahead[i].0[lane]);
                match turns[lane] {
                    Turn::Row(_) if is_first_end => {
                        is_first_end = false;
                        (sum, reference) = (end, end);
                    }
                    // All weights sum to 1: small differences are weighted instead of the ends themselves.
                    Turn::Row(row) => {
                        for i in 0..N {
                            sum[i] = sum[i] + self.weights[row % ROWS].times(end[i] - reference[i]);
                        }
                    }
                    _ if lane == 0 => first = core::array::from_fn(|i| end[i] - origin[i]),
                    _ => {}
                }
                turns[lane] = self.turn::<L>(lane, before[lane]);
                before[lane] += 1;
                left[lane] = turns[lane].stages();
                if let Turn::Row(row) = turns[lane] {
                    for i in 0..N {
                        behind[i].0[lane] = origin[i];
                        ahead[i].0[lane] =
                            origin[i] + self.shares[row % ROWS].times(first[i]).half();
                    }
                }
            }
            system.turn_to(turns.map(|turn| {
                if let Turn::Row(row) = turn {
                    row % ROWS
                } else {
                    0
                }
            }));
        }
        sum
    }
}

/// Any system z' = f(z), one row at a time, on increments from where the step starts.
struct Any<'a, R, F, const N: usize> {
    f: F,
    z: &'a [R; N],
    dt: R,
    method: &'a Extrapolation<R>,
    share: R,
}

impl<R: Real, F: Fn(&[R; N]) -> [R; N], const N: usize> System<R, 1, N> for Any<'_, R, F, N> {
    #[inline(always)]
    fn turn_to(&mut self, [row]: [usize; 1]) {
        self.share = self.method.shares[row % ROWS].times(self.dt);
    }

    #[inline(always)]
    fn slope(&mut self, at: &[Lanes<R, 1>; N]) -> [Lanes<R, 1>; N] {
        let z = core::array::from_fn(|i| self.z[i] + at[i].0[0]);
        (self.f)(&z).map(|slope| Lanes([self.share * slope]))
    }
}

impl<R: Real> Extrapolation<R> {
    /// One step for z' = f(z): the state a time `dt` after `z`; a negative `dt` steps backwards.
    ///
    /// ```
    /// use double_pendulum::Extrapolation;
    ///
    /// let method = Extrapolation::new(12)?;
    /// let [x, y] = method.step(|&[x, y]| [y, -x], &[0.0_f64, 1.0], 0.5);
    /// assert!((x - 0.5_f64.sin()).abs().max((y - 0.5_f64.cos()).abs()) < 3e-14); // 2e-14 is the method's own
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    #[inline]
    pub fn step<const N: usize>(&self, f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        let change = self.end(
            &mut Any {
                f,
                z,
                dt,
                method: self,
                share: dt,
            },
            &[R::ZERO; N],
        );
        core::array::from_fn(|i| z[i] + change[i])
    }
}
