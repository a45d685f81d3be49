//! A device register.

/// A 32-bit device register at a fixed address.
#[derive(Clone, Copy, Debug)]
pub struct Register(usize);

impl Register {
    /// The register at `address`.
    ///
    /// # Safety
    ///
    /// `address` must be that of a 32-bit device register, and no value written to it may break memory safety: no DMA
    /// addresses, no memory protection.
    pub const unsafe fn at(address: usize) -> Self {
        Self(address)
    }

    /// What it reads.
    #[inline]
    pub fn read(self) -> u32 {
        // SAFETY: `at`'s caller promised a device register; any 32-bit pattern is a `u32`.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    /// Writes it.
    #[inline]
    pub fn write(self, value: u32) {
        // SAFETY: `at`'s caller promised a device register whose writes do not break memory safety.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }

    /// Clears the bits of `clear`, then sets those of `set`.
    #[inline]
    pub fn modify(self, clear: u32, set: u32) {
        self.write((self.read() & !clear) | set);
    }

    /// Reads until the bits of `mask` read `wanted`, at most `tries` times; whether they did.
    #[inline]
    pub fn wait(self, mask: u32, wanted: u32, tries: u32) -> bool {
        (0..tries).any(|_| self.read() & mask == wanted)
    }
}
