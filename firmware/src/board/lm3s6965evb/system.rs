//! System control: the clock and the power of the peripherals.

use crate::board::register::Register;

/// Frequency of the board's crystal, Hz.
const CRYSTAL: u32 = 8_000_000;
/// The PLL's 400 MHz halved and divided by SYSDIV + 1 = 4, Hz.
const FULL_SPEED: u32 = 50_000_000;
/// The PLL locks within 0.5 ms; at 8 MHz and at least 4 cycles a try that is 1,000 tries.
const LOCK_TRIES: u32 = 10_000;

// SAFETY: system control registers of the data sheet, chapter 6; clocks and power cannot break memory safety.
const RIS: Register = unsafe { Register::at(0x400F_E050) };
const RESC: Register = unsafe { Register::at(0x400F_E05C) };
const RCC: Register = unsafe { Register::at(0x400F_E060) };
const RCGC0: Register = unsafe { Register::at(0x400F_E100) };
const RCGC1: Register = unsafe { Register::at(0x400F_E104) };
const RCGC2: Register = unsafe { Register::at(0x400F_E108) };

const WATCHDOG: u32 = 1 << 3;
const MAIN_OSCILLATOR_OFF: u32 = 1 << 0;
const OSCILLATOR_SOURCE: u32 = 0b11 << 4;
const CRYSTAL_FIELD: u32 = 0xF << 6;
const CRYSTAL_8_MHZ: u32 = 0xE << 6;
const BYPASS: u32 = 1 << 11;
const PLL_OFF: u32 = 1 << 13 | 1 << 12;
const USE_DIVIDER: u32 = 1 << 22;
const DIVIDER_FIELD: u32 = 0xF << 23;
const DIVIDE_BY_4: u32 = 3 << 23;
const PLL_LOCKED: u32 = 1 << 6;

/// Starts the clock and powers the peripherals; the processor's clock in Hz. With a PLL that does not lock that is the
/// crystal's: slow, but alive.
pub fn start() -> u32 {
    // As the data sheet says in 6.1.4.5: run from the crystal, start the PLL, wait for it, change over.
    RCC.modify(USE_DIVIDER, BYPASS);
    RCC.modify(MAIN_OSCILLATOR_OFF, 0);
    RCC.modify(OSCILLATOR_SOURCE | CRYSTAL_FIELD, CRYSTAL_8_MHZ);
    RCC.modify(PLL_OFF, 0);
    let hertz = if RIS.wait(PLL_LOCKED, PLL_LOCKED, LOCK_TRIES) {
        RCC.modify(DIVIDER_FIELD, DIVIDE_BY_4 | USE_DIVIDER);
        RCC.modify(BYPASS, 0);
        FULL_SPEED
    } else {
        CRYSTAL
    };
    RCGC0.modify(0, WATCHDOG);
    RCGC1.modify(0, 1 << 4 | 1 << 0); // SSI0, UART0
    RCGC2.modify(0, 0b111101); // ports A, C, D, E, F
    let _ = RCGC2.read(); // A peripheral may be used three cycles after its clock is on.
    cortex_m::asm::delay(8);
    hertz
}

/// Whether the watchdog caused the last reset. To be asked once: the register adds up the causes. QEMU's never says so.
pub fn reset_by_watchdog() -> bool {
    let causes = RESC.read();
    RESC.write(0);
    causes & WATCHDOG != 0
}
