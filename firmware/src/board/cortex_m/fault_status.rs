//! The registers that tell why a fault was taken: CFSR, HFSR, MMFAR and BFAR. A Cortex-M0+ has none of them.

/// What they read; zeros where there are none.
#[cfg(not(armv6m))]
pub fn read() -> [u32; 4] {
    let control = control();
    [control.cfsr.read(), control.hfsr.read(), control.mmfar.read(), control.bfar.read()]
}

/// Forgets what HFSR says.
#[cfg(not(armv6m))]
pub fn clear() {
    let hfsr = &control().hfsr;
    // SAFETY: writing the bits back only clears them.
    unsafe { hfsr.write(hfsr.read()) };
}

#[cfg(not(armv6m))]
fn control() -> &'static cortex_m::peripheral::scb::RegisterBlock {
    // SAFETY: it is always there, and nothing else uses these registers.
    unsafe { &*cortex_m::peripheral::SCB::PTR }
}

#[cfg(armv6m)]
pub fn read() -> [u32; 4] {
    [0; 4]
}

#[cfg(armv6m)]
pub fn clear() {}
