//! The constants of the equations in the units of the step, the way there and back, and what keeps the time.

use crate::bounds::check_step;
use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::directions::{Coefficients, Same, increments, state_of};
use crate::pendulum::{Parameters, State};

/// How far a step of the classical method goes, tau: (k1 + 2 k2 + 2 k3 + k4) times a third as rounded; tau is half a step.
pub(crate) fn classical_step<R: Real>() -> f64 {
    6.0 * R::from_f64(1.0 / 3.0).to_f64()
}

/// How the units of the step translate to SI. In `f64`; used at input and output only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// tau, s.
    time: f64,
    /// P per p, s/(kg m^2).
    pub momentum: f64,
    /// What a step truly advances, tau, ...
    step: f64,
    /// ... which is a little more than dt, for its constants are rounded.
    pub lead: Lead,
}

/// Checks and prepares a pendulum and a step of `dt` seconds, which goes `step` tau; a negative one runs backwards.
pub(crate) fn prepare<R: Real>(
    parameters: &Parameters<R>,
    dt: f64,
    step: f64,
) -> Result<(Coefficients<R>, Scale), Error> {
    parameters.check()?;
    check_step::<R>(dt)?;
    let Parameters { m1, m2, l1, l2, g } = parameters.cast::<f64>();
    let norm = l1 / l2;
    let [inertia, total] = [m1, m1 + m2].map(|mass| mass / m2 * norm * norm);

    let unit = dt / libm::rint(step);
    let wished = unit * unit * g / l1;
    let gravity2 = factor_above::<R>(wished, total);
    let gravity = [R::from_f64(total * gravity2.to_f64()), gravity2];
    let time = if g == 0.0 {
        unit
    } else {
        unit * libm::sqrt(gravity2.to_f64() / wished)
    };

    let coefficients = Coefficients {
        norm: R::from_f64(norm),
        inertia: R::from_f64(inertia),
        gravity,
    };
    let scale = Scale {
        time,
        momentum: time / (m2 * l2 * l2),
        step,
        lead: Lead::new(time * step, dt),
    };
    let in_range = |constant: R| constant.is_normal() && (R::ONE / constant).is_normal();
    let gravity_in_range = g == 0.0 || coefficients.gravity.into_iter().all(R::is_normal);
    if [coefficients.norm, coefficients.inertia, R::from_f64(total)]
        .into_iter()
        .all(in_range)
        && gravity_in_range
    {
        Ok((coefficients, scale))
    } else {
        Err(parameters.out_of_range())
    }
}

/// Of the first 32 numbers from `value` upwards, 1 ulp apart, the one whose product with `factor` loses least by rounding.
///
/// G2 may be a little too large, for that only lengthens the unit of time, which is known. The ratio of G1 to it may not be
/// off: where bob 1 is light, the fast oscillation goes by the small difference of G1 and nu^2 G2.
fn factor_above<R: Real>(value: f64, factor: f64) -> R {
    let lost = |candidate: R| {
        let exact = candidate.to_f64() * factor;
        (R::from_f64(exact).to_f64() - exact).abs()
    };
    let nearest = R::from_f64(value);
    let ulp = nearest * R::EPSILON;
    let least = if nearest.to_f64() < value {
        nearest + ulp
    } else {
        nearest
    };
    let candidates = (0..32_i32).map(|i| least + R::from_f64(f64::from(i)) * ulp);
    let (best, _) = candidates
        .map(|candidate| (candidate, lost(candidate)))
        .fold((least, f64::INFINITY), |best, other| {
            if other.1 < best.1 { other } else { best }
        });
    best
}

impl Scale {
    /// Refuses momenta that are too large for `R` in these units.
    pub fn check<R: Real>(&self, momenta: [f64; 2]) -> Result<(), Error> {
        let is_too_large = |(_, p): &(Parameter, f64)| !R::from_f64(*p).is_finite();
        match [Parameter::P1, Parameter::P2]
            .into_iter()
            .zip(momenta)
            .find(is_too_large)
        {
            Some((parameter, p)) => Err(Error::OutOfRange {
                parameter,
                value: p / self.momentum,
            }),
            None => Ok(()),
        }
    }

    /// The state in SI units at the time told after `count` steps, of a motion that is at `z`, and `lost` more.
    ///
    /// The motion is ahead of that time by a part of a step. It is taken back over it by four stages, of which each starts
    /// from the slope of the one before: of order 4 in small oscillations and of order 2 in others.
    #[must_use]
    #[inline(never)] // cold, and never inlined, to avoid a second copy
    pub fn state<R: Real>(
        &self,
        coefficients: &Coefficients<R>,
        z: &[R; 6],
        lost: [R; 6],
        count: u64,
    ) -> State<f64> {
        let span = R::from_f64(-self.lead.ahead(count) * self.step);
        let mut change = [R::ZERO; 6];
        for share in [0.25, 1.0 / 3.0, 0.5, 1.0] {
            let at: [R; 6] = core::array::from_fn(|i| z[i] + change[i]);
            let inverse = R::ONE / coefficients.denominator(at[2]);
            let slopes = increments(&at, coefficients.rates(&Same, &at, inverse));
            change = slopes.map(|slope| slope * (span * R::from_f64(share)));
        }
        // Of a motion about to leave the finite numbers there is nothing to take back.
        if !change.into_iter().all(R::is_finite) {
            change = [R::ZERO; 6];
        }
        let exact = core::array::from_fn(|i| z[i].to_f64() + (lost[i] + change[i]).to_f64());
        state_of(exact, [self.momentum; 2])
    }
}

/// Steps from one look at the lead to the next; the direction form restores lengths as often.
pub(crate) const BLOCK: u32 = 32;

/// By how much a step is longer than dt, in steps: rounded constants alter the unit of time, never to a shorter one.
///
/// When a motion would be more than half a step ahead of the time told, the last step of a block is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lead {
    /// In 2^-64 of a step, so that a product with the count, wrapped, is the lead beyond whole steps.
    each: u64,
}

/// A step in the units of a [`Lead`].
const STEP: f64 = (1_u128 << 64) as f64;

impl Lead {
    /// Of steps of `step` instead of `dt`, in any unit; none where rounding leaves the step a little short.
    pub fn new(step: f64, dt: f64) -> Self {
        Self {
            each: ((step - dt) / step * STEP) as u64,
        }
    }

    /// How many steps to make for the next `steps`, with which the count becomes `count`; not beyond the end of a block.
    #[inline(always)]
    pub fn made(self, steps: u32, count: u64) -> u32 {
        if count as u32 % BLOCK == 0 {
            steps - u32::from(self.is_left_out(count))
        } else {
            steps
        }
    }

    /// Whether the last step of the block that ends at `count` is left out: within the block the lead exceeded half a step.
    #[inline(always)]
    pub fn is_left_out(self, count: u64) -> bool {
        let after = count.wrapping_mul(self.each) as i64;
        after < i64::MIN + (self.each * u64::from(BLOCK)) as i64
    }

    /// By how many steps the motion is ahead at `count`: half a step at most, and what a block adds to it.
    #[inline(never)] // cold, and never inlined, to avoid a second copy
    pub fn ahead(self, count: u64) -> f64 {
        let within = count % u64::from(BLOCK);
        let before = (count - within).wrapping_mul(self.each) as i64;
        (before as f64 + within as f64 * self.each as f64) / STEP
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps made as a form makes them, and the lead by sums; a step that is short by a rounding counts as dt.
    #[test]
    fn the_motion_is_never_more_than_half_a_step_ahead_and_the_lead_says_how_far() {
        for longer in [-f64::EPSILON, 0.0, 1e-16, 1.9e-6, 3e-4, 0.01] {
            let (step, lead) = (1.0 + longer, Lead::new(1.0 + longer, 1.0));
            let (mut count, mut made) = (0_u64, 0_u64);
            for call in 0..200_000_u32 {
                let steps = (call % 7 + 1).min(BLOCK - count as u32 % BLOCK);
                count += u64::from(steps);
                made += u64::from(lead.made(steps, count));
                let ahead = (made as f64 * step - count as f64) / step;
                assert!(
                    (ahead - lead.ahead(count)).abs() < 1e-9,
                    "{longer} after {count}: {ahead}"
                );
                assert!(
                    ahead.abs() <= 0.5 + f64::from(BLOCK) * longer,
                    "{longer} after {count}: {ahead}"
                );
            }
            assert_eq!(made < count, longer > 1e-6, "{longer}");
        }
    }
}
