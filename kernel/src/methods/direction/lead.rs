//! What keeps the time of a motion whose steps are a little longer than dt.

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
        Self { each: ((step - dt) / step * STEP) as u64 }
    }

    /// How many steps to make for the next `steps`, with which the count becomes `count`; not beyond the end of a block.
    #[inline(always)]
    pub fn made(self, steps: u32, count: u64) -> u32 {
        if count as u32 % BLOCK == 0 { steps - u32::from(self.is_left_out(count)) } else { steps }
    }

    /// Whether the last step of the block that ends at `count` is left out: within the block the lead exceeded half a step.
    #[inline(always)]
    pub fn is_left_out(self, count: u64) -> bool {
        let after = count.wrapping_mul(self.each) as i64;
        after < i64::MIN + (self.each * u64::from(BLOCK)) as i64
    }

    /// By how many steps the motion is ahead at `count`: half a step at most, and what a block adds to it.
    #[inline(never)] // cold: once in flash
    pub fn ahead(self, count: u64) -> f64 {
        let within = count % u64::from(BLOCK);
        let before = (count - within).wrapping_mul(self.each) as i64;
        (before as f64 + within as f64 * self.each as f64) / STEP
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps made as a form makes them, and the lead by sums.
    #[test]
    fn the_motion_is_never_more_than_half_a_step_ahead_and_the_lead_says_how_far() {
        for longer in [0.0, 1e-16, 1.9e-6, 3e-4, 0.01] {
            let (step, lead) = (1.0 + longer, Lead::new(1.0 + longer, 1.0));
            let (mut count, mut made) = (0_u64, 0_u64);
            for call in 0..200_000_u32 {
                let steps = (call % 7 + 1).min(BLOCK - count as u32 % BLOCK);
                count += u64::from(steps);
                made += u64::from(lead.made(steps, count));
                let ahead = (made as f64 * step - count as f64) / step;
                assert!((ahead - lead.ahead(count)).abs() < 1e-9, "{longer} after {count}: {ahead}");
                assert!(ahead.abs() <= 0.5 + f64::from(BLOCK) * longer, "{longer} after {count}: {ahead}");
            }
            assert_eq!(made < count, longer > 1e-6, "{longer}");
        }
    }

    /// Where rounding leaves a step a little short, nothing is left out and nothing is told.
    #[test]
    fn a_step_that_is_short_by_a_rounding_counts_as_dt() {
        let lead = Lead::new(1.0 - f64::EPSILON, 1.0);
        assert_eq!((lead.made(32, 1 << 63), lead.ahead(u64::MAX)), (32, 0.0));
    }
}
