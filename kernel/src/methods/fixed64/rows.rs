//! The equations in the units of fixed point, in each row of an extrapolation, and the guard of their ranges.

use core::cell::Cell;

use crate::error::Error;
use crate::methods::extrapolation::{Extrapolation, ROWS, System};
use crate::methods::scaling::{Scaling, Shifts};
use crate::numbers::fixed::{Q64, nearest, scaled};
use crate::numbers::{Lanes, Scalar};
use crate::pendulum::directions::{Coefficients, Units, increments};

/// What a number of a direction is more than it stands for, as a power of two; momenta and rates are what they are.
pub(super) const EIGHTH: f64 = 0.125;

/// What all shares of a step are multiples of: those of all rows are whole numbers.
const PARTS: i64 = 840;

/// 1 as a share of a step in units of time.
const SHARE: f64 = (1 << 27) as f64;

/// The longest unit of time up to `longest` that has a whole number of parts in a step of `dt` s; it has the sign of `dt`.
pub(super) fn unit_of_time(longest: f64, dt: f64) -> f64 {
    let unit = dt * SHARE / PARTS as f64;
    unit / libm::ceil(libm::fabs(unit) / longest)
}

/// The constants of the equations in each row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rows {
    method: Extrapolation<Q64>,
    shifts: Shifts,
    /// nu by 8 and m by 64.
    coefficients: Coefficients<Q64>,
    rows: [Row; ROWS],
}

/// Rows with less weight than this do not make up for the others' roundings.
const LEAST: f64 = 0.01;

/// The share of a step between every second midpoint, and gravity times it: rounded so that the next row makes up for what the
/// one before has lost or gained, the step as a whole next to nothing. Where rates are high gravity has few digits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    share: i32,
    gravity: [Q64; 2],
}

impl Rows {
    pub fn new(order: u32, scaling: &Scaling, dt: f64) -> Result<Self, Error> {
        let Scaling {
            norm,
            inertia,
            gravity: [gravity1, gravity2],
            shifts,
            time,
            ..
        } = *scaling;
        let step = dt / time;
        let share = nearest(step * SHARE) as i64;
        let whole =
            [8.0 * step * gravity1, 4.0 * step * gravity2].map(|gravity| Q64::from_f64(gravity).0);
        let method = Extrapolation::<Q64>::new(order)?;
        let mut rows = [Row {
            share: 0,
            gravity: [Q64(0); 2],
        }; ROWS];
        let mut errors = [0.0; 2];
        for (index, row) in rows.iter_mut().enumerate().take(order as usize / 2).rev() {
            let (parts, slopes) = (index as i64 + 1, method.slopes(index));
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
        let inertia = scaled(inertia, -(shifts.inverse as i32));
        Ok(Self {
            method,
            shifts,
            coefficients: Coefficients {
                norm: Q64::from_f64(norm * EIGHTH),
                inertia: Q64::from_f64(inertia * EIGHTH * EIGHTH),
                gravity: [Q64(0); 2],
            },
            rows,
        })
    }

    /// What a step loses by rounding down, halves of 2^-64: in P1, and in all other quantities.
    ///
    /// One for each weighted difference of rows, and back for each torque of gravity on rod 1, which is taken away. All other
    /// products are made the middle of what they may have been. Small as these are, they would add up from step to step.
    pub fn floored(&self) -> [i16; 2] {
        let differences = self.method.rows as i16 - 1;
        let slopes: f64 = (0..self.method.rows)
            .map(|row| self.method.slopes(row))
            .sum();
        [differences - nearest(slopes) as i16, differences]
    }

    pub fn norm(&self) -> Q64 {
        self.coefficients.norm
    }

    /// Where a step from `z` ends; something else than 0 is left in `reach` if a quantity left its range on the way.
    pub fn end(&self, z: &[Q64; 6], reach: &Cell<u32>) -> [Q64; 6] {
        match self.shifts {
            Shifts::NONE => self.end_in::<false, false>(z, reach),
            Shifts {
                momentum: 0,
                inverse: _,
                upper: 0,
                lower: 0,
            } => self.end_in::<false, true>(z, reach),
            _ => self.end_in::<true, true>(z, reach),
        }
    }

    // one copy
    #[inline(never)]
    fn end_in<const UNLIKE: bool, const INVERSE: bool>(
        &self,
        z: &[Q64; 6],
        reach: &Cell<u32>,
    ) -> [Q64; 6] {
        let units = Fractions::<UNLIKE, INVERSE> {
            shifts: self.shifts,
            share: 0,
            reach,
        };
        self.method.end(
            &mut Stage {
                rows: self,
                coefficients: self.coefficients,
                units,
            },
            z,
        )
    }
}

/// A row's equations.
struct Stage<'a, const UNLIKE: bool, const INVERSE: bool> {
    rows: &'a Rows,
    coefficients: Coefficients<Q64>,
    units: Fractions<'a, UNLIKE, INVERSE>,
}

impl<const UNLIKE: bool, const INVERSE: bool> System<Q64, 1, 6> for Stage<'_, UNLIKE, INVERSE> {
    #[inline(always)]
    fn turn_to(&mut self, [row]: [usize; 1]) {
        let row = &self.rows.rows[row % ROWS];
        (self.units.share, self.coefficients.gravity) = (row.share, row.gravity);
    }

    #[inline(always)]
    fn slope(&mut self, at: &[Lanes<Q64, 1>; 6]) -> [Lanes<Q64, 1>; 6] {
        let z = at.map(|Lanes([z])| z);
        // sines and cosines below 2, momenta below 1/4
        z.into_iter().for_each(|z| self.units.guard(z, 2));
        let inverse = self.units.inverse(self.coefficients.inertia, z[2] * z[2]);
        increments(&z, self.coefficients.rates(&self.units, &z, inverse))
            .map(|slope| Lanes([slope]))
    }
}

/// What products of fractions are short of the units of what they add to: directions are in eighths, u and v by the step in
/// quarters, r in quarters. The pendulum's own [`Shifts`] come on top: that of r where `INVERSE`, as with equal rods and a heavier
/// bob 2, the others where `UNLIKE`.
///
/// Each product that is shifted up is looked at before, so that neither the shift nor the sum behind it can overflow.
#[derive(Clone, Copy)]
struct Fractions<'a, const UNLIKE: bool, const INVERSE: bool> {
    shifts: Shifts,
    /// In parts.
    share: i32,
    reach: &'a Cell<u32>,
}

impl<const UNLIKE: bool, const INVERSE: bool> Fractions<'_, UNLIKE, INVERSE> {
    /// Notes if `number` is 2^-`places` or more.
    #[inline(always)]
    fn guard(&self, number: Q64, places: u32) {
        self.reach.set(self.reach.get() | number.reach(places));
    }

    #[inline(always)]
    fn down(&self, number: Q64, by: u32) -> Q64 {
        if UNLIKE { number.down(by) } else { number }
    }

    /// `number` times 2^`by`, which is to be below 2^-`places`.
    #[inline(always)]
    fn up(&self, number: Q64, by: u32, places: u32) -> Q64 {
        self.guard(number, by + places);
        number.up(by)
    }

    /// r of m + S^2.
    #[inline(always)]
    fn inverse(&self, inertia: Q64, square: Q64) -> Q64 {
        let denominator = inertia + self.down(square, self.shifts.momentum);
        if INVERSE {
            // from 2^-`inverse` on: made 1 to 8
            let more = self
                .shifts
                .inverse
                .min(denominator.0.leading_zeros().saturating_sub(4));
            Q64(denominator.0 << more)
                .inverse()
                .down(self.shifts.inverse - more)
        } else {
            denominator.inverse()
        }
    }
}

impl<const UNLIKE: bool, const INVERSE: bool> Units<Q64> for Fractions<'_, UNLIKE, INVERSE> {
    /// Below 1/4, so that P1 - C P2 is below 1/2.
    #[inline(always)]
    fn momentum(&self, product: Q64) -> Q64 {
        self.down(self.up(product, 3, 2), self.shifts.momentum)
    }
    /// Below 1/4.
    #[inline(always)]
    fn rate(&self, momentum: Q64, inverse: Q64) -> Q64 {
        let more = if INVERSE { self.shifts.inverse } else { 0 };
        self.up(momentum * inverse, 2 + more, 2)
    }
    /// Below 1/4, so that v is below 1/2.
    #[inline(always)]
    fn swing(&self, product: Q64) -> Q64 {
        self.up(product, 3, 2)
    }
    /// By the share of the step, below 1.
    #[inline(always)]
    fn paced(&self, u: Q64) -> Q64 {
        self.up(u.times_word(self.share), 3, 2)
    }
    /// u by the step is below 1/4, and v below 1/2.
    #[inline(always)]
    fn force(&self, u: Q64, v: Q64, s: Q64) -> Q64 {
        self.up(u * v, 4, 2) * s
    }
    #[inline(always)]
    fn turns(&self, [u, v]: [Q64; 2]) -> [Q64; 2] {
        // Where rod 2 is long, v by the step is in range only as the rate of a2 that it stands for.
        let (v, lower) = (
            v.times_word(self.share),
            if UNLIKE { self.shifts.lower } else { 0 },
        );
        [
            self.down(u, self.shifts.upper),
            if lower < 3 {
                self.up(v, 3 - lower, 2)
            } else {
                v.down(lower - 3)
            },
        ]
    }
    /// Below 1/8, as is the other torque on each momentum: together with that, which was below 1/4, below 1/2.
    #[inline(always)]
    fn forces(&self, force: Q64) -> [Q64; 2] {
        let force = self.up(force, 1, 3);
        let Shifts {
            upper,
            momentum,
            lower,
            ..
        } = self.shifts;
        [self.down(force, upper + momentum), self.down(force, lower)]
    }
    #[inline(always)]
    fn lower(&self, sine: Q64) -> Q64 {
        // the difference of two that were rounded down: it is the middle already
        self.guard(sine, 5);
        sine.times(8)
    }
    #[inline(always)]
    fn weight(&self, torque: Q64) -> Q64 {
        torque.up(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::methods::Fixed64;
    use crate::numbers::Scalar;
    use crate::pendulum::{Motion, Parameters, Pendulum};

    /// Whether a step from `z` is said to leave the range, C being 1 by 8 and S 0 unless said.
    fn leaves(z: [f64; 6]) -> Result<bool, Error> {
        let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
        let dt = 1.0 / 64.0;
        let bounds = Bounds::new(&parameters, 50.0);
        let seconds = Scaling::in_seconds(&parameters)?;
        let [by_rates, by_torques] = seconds.longest(&bounds, [0.125, 1.0 / 256.0]);
        let scaling = seconds.in_unit(unit_of_time(libm::fmin(by_rates, by_torques), dt));
        let reach = Cell::new(0);
        Rows::new(2, &scaling, dt)?.end(&z.map(Q64::from_f64), &reach);
        Ok(reach.get() != 0)
    }

    #[test]
    fn every_quantity_that_leaves_its_range_is_noted() -> Result<(), Error> {
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
        // each momentum has room, u has not
        assert!(leaves([0.0, 0.125, 0.0, 0.125, 0.24, -0.24])?);
        // C P2 has not
        assert!(leaves([0.0, 0.125, 0.0, 0.24, 0.24, 0.2])?);
        Ok(())
    }

    /// v counts 32 times, and more than a radian of it in a step is no more than 1/32.
    #[test]
    fn a_light_bob_on_a_long_rod_is_in_range() -> Result<(), Error> {
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
