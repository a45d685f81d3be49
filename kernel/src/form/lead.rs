//! What keeps the time of a motion whose steps are a little longer than dt.

/// Steps from one look at the lead to the next; lengths are restored as often.
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
