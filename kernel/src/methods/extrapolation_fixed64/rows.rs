//! The rows of an extrapolation in 64-bit fixed point: their constants, their equations with every
//! shift, and the guard of their ranges.

use core::cell::Cell;

use super::errors::Moments;
use crate::error::Error;
use crate::methods::extrapolation::{ROWS, half_substeps, rows, weight};
use crate::methods::scaling::{Scaling, Shifts};
use crate::numbers::fixed::{Q64, nearest, scaled};

/// The number of bits by which a stored direction is halved. Momenta and rates are stored as they
/// are.
pub(super) const DIRECTION_SHIFT: u32 = 3;
/// The factor of a stored direction.
pub(super) const EIGHTH: f64 = 1.0 / (1_u32 << DIRECTION_SHIFT) as f64;

/// The least common multiple of all n/2: the share 2/n of the step is a whole number of parts.
const PARTS: i64 = 840;

const SHARE: f64 = (1 << 27) as f64;

/// Rows with a smaller weight than this do not compensate for the roundings of other rows.
const LEAST: f64 = 0.01;

/// Returns the longest unit of time, s, up to `longest` s, such that a step of `dt` s is a whole
/// number of [`PARTS`] in the format [`SHARE`].
pub(super) fn unit_of_time(longest: f64, dt: f64) -> f64 {
    let unit = dt * SHARE / PARTS as f64;
    unit / libm::ceil(libm::fabs(unit) / longest)
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rows {
    count: usize,
    shares: [Factor; ROWS],
    weights: [Factor; ROWS],
    shifts: Shifts,
    /// An eighth of nu/sigma ([`Scaling::norm`]).
    norm: Q64,
    /// A 64th of m, divided by 2^[`Shifts::inverse`].
    inertia: Q64,
    rows: [Row; ROWS],
}

/// The step of one row. Its constants are rounded so that each row compensates for the rounding of
/// the rows before it. Where rates are high, gravity has few digits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    /// The share 2/n of the step, in 2^-27 units of time.
    share: i32,
    gravity: [Q64; 2],
}

/// A factor of any size; the weights reach 51, which no [`Q64`] holds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Factor {
    whole: i32,
    rest: Q64,
}

impl Factor {
    const ZERO: Self = Self {
        whole: 0,
        rest: Q64(0),
    };

    fn new(value: f64) -> Self {
        let whole = libm::floor(value + 0.5); // The rest may be -1/2, but not 1/2.
        Self {
            whole: whole as i32,
            rest: Q64::from_f64(value - whole),
        }
    }

    #[inline(always)] // `slope`, `times`, `restored`: +10 % cycles on an M3 without.
    fn times(&self, number: Q64) -> Q64 {
        let product = number * self.rest;
        if self.whole == 0 {
            product
        } else {
            product + number.times(self.whole)
        }
    }
}

impl Rows {
    /// Prepares steps of `dt` s of the order `order`, which it may refuse. The unit of time of
    /// `scaling` must be one that [`unit_of_time`] returned for the same `dt`.
    pub fn new(order: u32, scaling: &Scaling, dt: f64) -> Result<Self, Error> {
        let count = rows(order)?;
        let mut shares = [Factor::ZERO; ROWS];
        let mut weights = [Factor::ZERO; ROWS];
        for row in 0..ROWS {
            shares[row] = Factor::new(1.0 / half_substeps(row));
            if row < count {
                weights[row] = Factor::new(weight(row, count));
            }
        }

        let shifts = scaling.shifts;
        let [gravity1, gravity2] = scaling.gravity;
        let step = dt / scaling.time;
        let share = nearest(step * SHARE) as i64;
        let whole =
            [8.0 * step * gravity1, 4.0 * step * gravity2].map(|gravity| Q64::from_f64(gravity).0);
        // The longest row first, so that the others compensate for its roundings.
        let mut rows = [Row {
            share: 0,
            gravity: [Q64(0); 2],
        }; ROWS];
        let mut errors = [0.0; 2];
        for (index, row) in rows.iter_mut().enumerate().take(count).rev() {
            let parts = index as i64 + 1;
            let slopes = slopes(index, count);
            row.share = (share / parts) as i32;
            for ((whole, gravity), error) in whole.iter().zip(&mut row.gravity).zip(&mut errors) {
                let exact = whole.rem_euclid(parts) as f64 / parts as f64;
                let rounded = nearest(if libm::fabs(slopes) > LEAST {
                    exact - *error / slopes
                } else {
                    exact
                });
                *error += slopes * (rounded - exact);
                *gravity = Q64(whole.div_euclid(parts) + rounded as i64);
            }
        }

        let inertia = scaled(scaling.inertia, -(shifts.inverse as i32));
        Ok(Self {
            count,
            shares,
            weights,
            shifts,
            norm: Q64::from_f64(scaling.norm * EIGHTH),
            inertia: Q64::from_f64(inertia * EIGHTH * EIGHTH),
            rows,
        })
    }

    pub fn norm(&self) -> Q64 {
        self.norm
    }

    /// Returns nu/sigma.
    pub fn norm_value(&self) -> f64 {
        self.norm.doubled(DIRECTION_SHIFT)
    }

    /// Returns the length of the step in units of time.
    pub fn step(&self) -> f64 {
        libm::fabs(f64::from(self.rows[0].share)) / SHARE
    }

    pub fn shifts(&self) -> Shifts {
        self.shifts
    }

    /// Returns the mean amounts that a step loses by rounding down, in halves of 2^-64: of P1, and
    /// of each other quantity. A negative amount is a gain.
    ///
    /// Every quantity loses one half in each weighted difference of two rows. P1 also gains one
    /// half in each torque of gravity on rod 1, which is rounded down and then subtracted. All
    /// other products are moved to the middle of the values that they may have had.
    pub fn rounded_down(&self) -> [i16; 2] {
        let differences = self.count as i16 - 1;
        let slopes: f64 = (0..self.count).map(|row| slopes(row, self.count)).sum();
        [differences - nearest(slopes) as i16, differences]
    }

    /// Returns the end of a step from `z`: sin a1, cos a1, S and C as eighths, P1, P2.
    ///
    /// Makes `reach` nonzero if a quantity at `z` or within the step exceeds its largest magnitude
    /// by a factor of 2 or more; the end is then meaningless.
    ///
    /// Compiled for three kinds of pendulum, because shifts by constants are cheaper: without
    /// shifts ([`Shifts::NONE`]), with a shift of r only (a heavier bob 2), and all others.
    ///
    /// If there are `moments`, adds those of the step, which must be of order 10.
    pub fn end(&self, z: &[Q64; 6], reach: &Cell<u32>, moments: Option<&mut Moments>) -> [Q64; 6] {
        match self.shifts {
            Shifts::NONE => self.end_in::<false, false>(z, reach, moments),
            Shifts {
                momentum: 0,
                inverse: _,
                upper: 0,
                lower: 0,
            } => self.end_in::<false, true>(z, reach, moments),
            _ => self.end_in::<true, true>(z, reach, moments),
        }
    }

    #[inline(never)] // Inlined, each order would have a copy.
    fn end_in<const UNLIKE: bool, const INVERSE: bool>(
        &self,
        origin: &[Q64; 6],
        reach: &Cell<u32>,
        mut moments: Option<&mut Moments>,
    ) -> [Q64; 6] {
        let equations = Equations::<UNLIKE, INVERSE> { rows: self, reach };
        let first = equations.slope(&self.rows[0], origin);

        let mut sum = *origin;
        let mut reference = *origin;
        for row in (0..self.count).rev() {
            let constants = &self.rows[row % ROWS];
            let share = &self.shares[row % ROWS];
            let mut even = *origin;
            // The case without a whole part is written out: 1.7 % fewer cycles on an M3.
            let mut odd = if share.whole == 0 {
                core::array::from_fn(|i| origin[i] + (first[i] * share.rest).half())
            } else {
                core::array::from_fn(|i| origin[i] + share.times(first[i]).half())
            };
            let mut before = &mut even;
            let mut last = &mut odd;
            for _ in 0..2 * row + 1 {
                let slope = equations.slope(constants, last);
                for i in 0..6 {
                    before[i] = before[i] + slope[i];
                }
                core::mem::swap(&mut before, &mut last);
            }

            // All weights sum to 1, so that the small differences from the first end can be
            // weighted.
            if row + 1 == self.count {
                sum = *last;
                reference = *last;
            } else {
                let weight = &self.weights[row % ROWS];
                let differences = core::array::from_fn(|i| weight.times(last[i] - reference[i]));
                for i in 0..6 {
                    sum[i] = sum[i] + differences[i];
                }
                if let Some(moments) = &mut moments {
                    moments.add(row, &differences);
                }
            }
        }
        sum
    }
}

/// Returns the weight of one slope of a row in the end of a step, summed over the row.
fn slopes(row: usize, rows: usize) -> f64 {
    weight(row, rows) * half_substeps(row)
}

/// The equations of motion.
///
/// Directions are stored as eighths, u and v over the share of the step as quarters, r as a
/// quarter. The [`Shifts`] of the pendulum come on top: that of r if `INVERSE`, and the others if
/// `UNLIKE`. Each product that is shifted up is checked before, so that neither the shift nor the
/// sum that follows can overflow.
struct Equations<'a, const UNLIKE: bool, const INVERSE: bool> {
    rows: &'a Rows,
    reach: &'a Cell<u32>,
}

impl<const UNLIKE: bool, const INVERSE: bool> Equations<'_, UNLIKE, INVERSE> {
    #[inline(always)] // `slope`, `times`, `restored`: +10 % cycles on an M3 without.
    fn slope(&self, row: &Row, z: &[Q64; 6]) -> [Q64; 6] {
        // Sines and cosines are below 2, momenta below 1/4.
        for &z in z {
            self.guard(z, 2);
        }
        let [sin1, cos1, s, c, p1, p2] = *z;
        let [gravity1, gravity2] = row.gravity;
        let shifts = &self.rows.shifts;

        // The angular rates u and v. C P2 is below 1/4, so that P1 - C P2 is below 1/2; u and C u
        // are below 1/4, so that v is below 1/2.
        let r = self.inverse(s * s);
        let c_p2 = self.down(self.up(c * p2, 3, 2), shifts.momentum);
        let more = if INVERSE { shifts.inverse } else { 0 };
        let u = self.up((p1 - c_p2) * r, 2 + more, 2);
        let v = p2 - self.up(c * u, 3, 2);

        // From here on, u is over the share of the step: below 1.
        let u = self.up(u.times_word(row.share), 3, 2);

        // The force F = u v S. It is below 1/8, as is the torque of gravity on each momentum: their
        // sum, added to a momentum below 1/4, is below 1/2.
        let force = self.up(self.up(u * v, 4, 2) * s, 1, 3);
        let force1 = self.down(force, shifts.upper + shifts.momentum);
        let force2 = self.down(force, shifts.lower);

        // The difference of two products that were rounded down is already in the middle.
        let nu_sin2 = sin1 * c - cos1 * s;
        self.guard(nu_sin2, 5);
        let weight2 = (gravity2 * nu_sin2.times(8)).up(1);

        // Where rod 2 is long, v over the share of the step is in range only as the rate of a2.
        let v = v.times_word(row.share);
        let lower = if UNLIKE { shifts.lower } else { 0 };
        let v = if lower < 3 {
            self.up(v, 3 - lower, 2)
        } else {
            v.down(lower - 3)
        };
        let u = self.down(u, shifts.upper);
        let w = u - v;
        [
            (cos1 * u).up(2),
            -(sin1 * u).up(2),
            (c * w).up(2),
            -(s * w).up(2),
            -(gravity1 * sin1) - force1,
            force2 - weight2,
        ]
    }

    #[inline]
    fn inverse(&self, square: Q64) -> Q64 {
        let shifts = &self.rows.shifts;
        let denominator = self.rows.inertia + self.down(square, shifts.momentum);
        if INVERSE {
            // The denominator can be as small as 2^-inverse. It is shifted to between 1 and 8.
            let zeros = denominator.0.leading_zeros();
            let more = shifts.inverse.min(zeros.saturating_sub(4));
            Q64(denominator.0 << more)
                .inverse()
                .down(shifts.inverse - more)
        } else {
            denominator.inverse()
        }
    }

    fn guard(&self, number: Q64, places: u32) {
        self.reach.set(self.reach.get() | number.reach(places));
    }

    fn down(&self, number: Q64, by: u32) -> Q64 {
        if UNLIKE { number.down(by) } else { number }
    }

    fn up(&self, number: Q64, by: u32, places: u32) -> Q64 {
        self.guard(number, by + places);
        number.up(by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::methods::Fixed64;
    use crate::pendulum::{Motion, Parameters, Pendulum};

    /// Returns true if a step from `z` reports that a quantity left its range.
    fn leaves(z: [f64; 6]) -> Result<bool, Error> {
        let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
        let dt = 1.0 / 64.0;
        let bounds = Bounds::new(&parameters, 50.0);
        let seconds = Scaling::in_seconds(&parameters)?;
        let [by_rates, by_torques] = seconds.longest(&bounds, [0.125, 1.0 / 256.0]);
        let scaling = seconds.in_unit(unit_of_time(libm::fmin(by_rates, by_torques), dt));
        let reach = Cell::new(0);
        Rows::new(2, &scaling, dt)?.end(&z.map(Q64::from_f64), &reach, None);
        Ok(reach.get() != 0)
    }

    #[test]
    fn each_quantity_out_of_range_is_reported() -> Result<(), Error> {
        assert!(!leaves([0.0, 0.125, 0.0, 0.125, 0.1, 0.1])?);
        for (i, beyond) in [
            (0, 0.26),
            (1, -0.26),
            (2, 0.26),
            (3, -0.26),
            (4, 0.26),
            (5, -0.26),
        ] {
            let mut z = [0.0, 0.125, 0.0, 0.125, 0.0, 0.0];
            z[i] = beyond;
            assert!(leaves(z)?, "{i}");
        }
        // Each momentum is in range, but u is not.
        assert!(leaves([0.0, 0.125, 0.0, 0.125, 0.24, -0.24])?);
        assert!(leaves([0.0, 0.125, 0.0, 0.24, 0.24, 0.2])?);
        Ok(())
    }

    /// The stored number of v is 32 times the rate of a2 here, so that only its change over a step
    /// is in range.
    #[test]
    fn light_bob_on_long_rod_stays_in_range() -> Result<(), Error> {
        let parameters = Parameters {
            m1: 1.0,
            m2: 0.017,
            l1: 1.0,
            l2: 33.0,
            g: 9.81,
        };
        let start = Motion {
            a1: 0.8,
            a2: 1.1,
            w1: 9.2,
            w2: 3.8,
        };
        let pendulum = Pendulum::new(&parameters)?;
        pendulum
            .run::<Fixed64<10>>(&pendulum.to_state(&start), 1.0 / 120.0)?
            .advance(240)
    }
}
