//! The excess of a step over dt.

/// The number of steps after which the lengths of the directions are restored, and the lead is
/// compared with half a step.
pub(crate) const BLOCK: u32 = 32;

/// The excess of a step over dt, because the constants of the equations are rounded.
///
/// When a motion would be half a step or more ahead of the time, the last step of a block is left
/// out. The motion is then about half a step behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lead {
    /// The lead of each step in multiples of 2^-64 of a step. A wrapping product with the number of
    /// steps is the lead beyond whole steps.
    each: u64,
}

const STEP: f64 = (1_u128 << 64) as f64;

impl Lead {
    /// Returns the lead of steps of length `step` instead of `dt`, below 1/64 of a step. A step
    /// that is shorter than `dt`, as a rounding can make it, counts as exact.
    pub fn new(step: f64, dt: f64) -> Self {
        Self {
            each: ((step - dt) / step * STEP) as u64,
        }
    }

    /// Returns the number of steps to compute for the next `steps` steps, within a block, after
    /// which `count` steps have passed since the start: `steps`, or one less.
    pub fn made(self, steps: u32, count: u64) -> u32 {
        if count as u32 % BLOCK == 0 {
            steps - u32::from(self.is_left_out(count))
        } else {
            steps
        }
    }

    /// Returns true if the last step of the block that ends at `count` steps since the start is
    /// left out.
    pub fn is_left_out(self, count: u64) -> bool {
        let after = count.wrapping_mul(self.each) as i64;
        after < i64::MIN + (self.each * u64::from(BLOCK)) as i64
    }

    /// Returns the motion's lead over the exact time at `count` steps since the start, in steps;
    /// negative if the motion is behind. It is at most half a step, plus the lead of one block.
    pub fn ahead(self, count: u64) -> f64 {
        let within = count % u64::from(BLOCK);
        let before = (count - within).wrapping_mul(self.each) as i64;
        (before as f64 + within as f64 * self.each as f64) / STEP
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The steps are too long by up to 1 %, in calls of 1 to 7 steps. The lead must be their sum
    /// less the time, and steps must be left out for the three largest excesses only.
    #[test]
    fn motion_is_at_most_half_a_step_ahead() {
        for longer in [-f64::EPSILON, 0.0, 1e-16, 1.9e-6, 3e-4, 0.01] {
            let step = 1.0 + longer;
            let lead = Lead::new(step, 1.0);
            let mut count = 0_u64;
            let mut made = 0_u64;
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

            // In this time only the three largest excesses add up to half a step.
            assert_eq!(made < count, longer > 1e-6, "{longer}");
        }
    }

    /// Steps that are too long by 1/128 reach half a step after 64 steps, and one and a half after
    /// 192.
    #[test]
    fn one_step_is_left_out_for_each_step_of_lead() {
        let lead = Lead::new(1.0, 127.0 / 128.0);
        let left_out = [32, 64, 96, 128, 160, 192].map(|count| lead.is_left_out(count));
        assert_eq!(left_out, [false, true, false, false, false, true]);
    }
}
