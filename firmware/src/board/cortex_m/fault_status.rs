//! The registers that tell why a fault was taken: CFSR, HFSR, MMFAR and BFAR. A Cortex-M0+ has none of them.

/// What they read, zeros where there are none; if `clears`, HFSR forgets it.
#[cfg(not(armv6m))]
pub fn read(clears: bool) -> [u32; 4] {
    // SAFETY: it is always there, and nothing else uses these registers.
    let control = unsafe { &*cortex_m::peripheral::SCB::PTR };
    if clears {
        // SAFETY: writing the bits back only clears them.
        unsafe { control.hfsr.modify(|bits| bits) };
    }
    [control.cfsr.read(), control.hfsr.read(), control.mmfar.read(), control.bfar.read()]
}

#[cfg(armv6m)]
pub fn read(_: bool) -> [u32; 4] {
    [0; 4]
}
