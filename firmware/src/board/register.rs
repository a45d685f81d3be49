//! Devices and their registers.

/// A device: 4 KiB of addresses with its registers.
#[derive(Clone, Copy, Debug)]
pub struct Device(usize);

impl Device {
    /// Returns the device whose registers begin at `base`.
    ///
    /// # Safety
    ///
    /// The 4 KiB from `base`, a multiple of 4, must be the registers of a device, all of 32 bits.
    /// No value written to them may break memory safety: no DMA addresses, no memory protection.
    pub const unsafe fn at(base: usize) -> Self {
        Self(base)
    }

    /// The offset is in bytes.
    pub const fn register(self, offset: usize) -> Register {
        Register(self.0 + (offset & 0xffc))
    }
}

/// On most chips an access to a device without power is a fault.
#[derive(Clone, Copy, Debug)]
pub struct Register(usize);

impl Register {
    pub fn read(self) -> u32 {
        // SAFETY: by the contract of [`Device::at`] this is a register; any 32-bit pattern is a
        // `u32`.
        unsafe { (self.0 as *const u32).read_volatile() }
    }

    pub fn write(self, value: u32) {
        // SAFETY: by the contract of [`Device::at`] this is a register whose writes do not break
        // memory safety.
        unsafe { (self.0 as *mut u32).write_volatile(value) }
    }

    /// Clears the bits of `clear`, then sets those of `set`. It is not atomic.
    pub fn modify(self, clear: u32, set: u32) {
        self.write((self.read() & !clear) | set);
    }

    /// Reads until the bits of `mask` are `wanted`, at most `tries` times. Returns true if they
    /// are.
    pub fn wait(self, mask: u32, wanted: u32, tries: u32) -> bool {
        (0..tries).any(|_| self.read() & mask == wanted)
    }
}
