//! Bytes as the numbers a target wants; where they end, zeros follow.

/// What is left of an input.
pub struct Input<'a>(pub &'a [u8]);

impl Input<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let length = N.min(self.0.len());
        let (now, rest) = self.0.split_at(length);
        bytes[..length].copy_from_slice(now);
        self.0 = rest;
        bytes
    }

    /// One byte.
    pub fn byte(&mut self) -> u8 {
        u8::from_le_bytes(self.take())
    }

    /// Any bit pattern.
    pub fn number(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    /// Any bit patterns.
    pub fn numbers<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.number())
    }
}
