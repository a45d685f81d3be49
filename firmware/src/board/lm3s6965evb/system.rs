//! The system control: the clock, the power of the peripherals, and the watchdog.

use crate::board::cortex_m::watchdog::{self, FIRST, TwoStage};
use crate::board::register::{Device, Register};

/// The crystal, Hz.
const CRYSTAL: u32 = 8_000_000;
/// The processor's clock from the PLL, Hz: 400 MHz halved and divided by SYSDIV + 1 = 4.
const FULL_SPEED: u32 = 50_000_000;
/// The start-up time of the crystal, cycles of the internal oscillator. The vendor's own start-up
/// code waits this long (`SysCtlClockSet` of its driver library: 524,288 loops of 3 cycles). It is
/// 0.13 s at the oscillator's 12 MHz, whose tolerance is 30 %.
const CRYSTAL_START: u32 = 3 * 524_288;
/// The time that the vendor's code waits for a new source to take effect, cycles.
const CHANGE_OVER: u32 = 3 * 16;
/// The number of tries to wait for the PLL. It locks within 0.5 ms, which is 1,000 tries at 8 MHz
/// and at least 4 cycles a try.
const LOCK_TRIES: u32 = 10_000;

// SAFETY: system control of the data sheet, chapter 6; clocks and power cannot break memory safety.
const SYSTEM_CONTROL: Device = unsafe { Device::at(0x400F_E000) };
const DID0: Register = SYSTEM_CONTROL.register(0x000);
const DID1: Register = SYSTEM_CONTROL.register(0x004);
const LDOPCTL: Register = SYSTEM_CONTROL.register(0x034);
const RIS: Register = SYSTEM_CONTROL.register(0x050);
const RESC: Register = SYSTEM_CONTROL.register(0x05c);
const MISC: Register = SYSTEM_CONTROL.register(0x058);
const RCC: Register = SYSTEM_CONTROL.register(0x060);
const RCGC0: Register = SYSTEM_CONTROL.register(0x100);
const RCGC1: Register = SYSTEM_CONTROL.register(0x104);
const RCGC2: Register = SYSTEM_CONTROL.register(0x108);

/// The revision, of DID0.
const REVISION: u32 = 0xffff;
const REVISION_A2: u32 = 2;
/// The regulator's output, of LDOPCTL: 2.75 V.
const LDO_2_75_V: u32 = 0x1b;

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

/// Starts the clock and powers the peripherals. Before that an access to them is a fault. Returns
/// the frequency of the processor, Hz: if the PLL does not lock, the crystal's, slow but running.
///
/// First the crystal starts, which takes 0.13 s.
pub fn start() -> u32 {
    // An erratum of this revision: at the regulator's 2.5 V the chip may fail once the PLL runs.
    // The vendor's programs for this board begin with this setting (`REVISION_IS_A2`,
    // `SysCtlLDOSet`).
    if DID0.read() & REVISION == REVISION_A2 {
        LDOPCTL.write(LDO_2_75_V);
    }

    // Follow the data sheet, Initialization and Configuration: switch PLL and divider off, switch
    // to the crystal, start the PLL, wait for it, and switch over.
    RCC.modify(USE_DIVIDER, BYPASS);
    start_crystal();
    MISC.write(PLL_LOCKED); // clears an earlier lock
    RCC.modify(OSCILLATOR_SOURCE | CRYSTAL_FIELD | PLL_OFF, CRYSTAL_8_MHZ);
    cortex_m::asm::delay(CHANGE_OVER);
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

/// Switches the crystal's oscillator on, and waits until it is reliable. This chip has no flag for
/// that, and a processor that switches to it too early stops. It is off after every reset (in QEMU
/// it is on).
fn start_crystal() {
    if RCC.read() & MAIN_OSCILLATOR_OFF != 0 {
        RCC.modify(MAIN_OSCILLATOR_OFF, 0);
        cortex_m::asm::delay(CRYSTAL_START);
    }
}

/// Returns DID0 and DID1. The chip has no unique number.
pub fn chip() -> [u32; 4] {
    [DID0.read(), DID1.read(), 0, 0]
}

/// Returns true if the watchdog has caused a reset since the last call. The register accumulates
/// the causes, and the function clears them. In QEMU it always returns false.
pub fn reset_by_watchdog() -> bool {
    let causes = RESC.read();
    RESC.write(0);
    causes & WATCHDOG != 0
}

// SAFETY: the watchdog of the data sheet, chapter 11; without DMA it cannot break memory safety.
const WATCHDOG_TIMER: Device = unsafe { Device::at(0x4000_0000) };
const TEST: Register = WATCHDOG_TIMER.register(0x418);
const STALL: u32 = 1 << 8;
const CALL: u16 = FIRST + 18;

/// Starts the watchdog. It stops while a debugger halts the processor.
pub fn start_watchdog(hertz: u32) -> TwoStage {
    // The registers stay unlocked until the next feeding.
    watchdog::stall_by(|stalls| {
        watchdog::unlock(WATCHDOG_TIMER);
        TEST.write(if stalls { STALL } else { 0 });
    });
    TwoStage::start(WATCHDOG_TIMER, hertz, CALL)
}
