//! The end: panics and faults are reported in plain text on the debugger's standard error, then the run fails.
//!
//! Plain text there, and not a defmt log, because a crash may come in the middle of a log line, and because it shall be
//! readable without any tool. Without a debugger there is nobody to tell: the board stops.

use core::arch::naked_asm;
use core::fmt::{Display, Write};
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::SCB;
use cortex_m_rt::ExceptionFrame;
use cortex_m_semihosting::{debug, hio};

use crate::fault::Fault;

/// A call to the debugger, `bkpt 0xAB`, and its length in bytes.
const DEBUGGER_CALL: (u16, u32) = (0xBEAB, 2);

/// Set once a call to the debugger was not answered.
static ALONE: AtomicBool = AtomicBool::new(false);
/// Set once a crash is being reported: a crash of the report itself is not.
static CRASHED: AtomicBool = AtomicBool::new(false);

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    crash(&format_args!("PANIC: {info}"))
}

/// Every fault ends here, since none has a handler of its own. Passes on the registers stacked by the processor;
/// cortex-m-rt's own trampoline is of no use because it cannot return.
///
/// # Safety
///
/// Only the processor may call it, through the vector table.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() {
    naked_asm!(
        "tst lr, #4", // EXC_RETURN tells which stack was in use.
        "ite eq",
        "mrseq r0, msp",
        "mrsne r0, psp",
        "b {hard_fault}",
        hard_fault = sym hard_fault,
    )
}

extern "C" fn hard_fault(frame: &mut ExceptionFrame) {
    // SAFETY: the System Control Block is always there; nothing else uses it in a fault handler of highest priority.
    let scb = unsafe { &*SCB::PTR };
    let (cfsr, hfsr, bfar) = (scb.cfsr.read(), scb.hfsr.read(), scb.bfar.read());
    // A breakpoint is the one fault that leaves CFSR clear. (It also sets HFSR.DEBUGEVT, but not in QEMU.)
    if cfsr == 0 && step_over_debugger_call(frame) {
        // SAFETY: writing the bits back only clears them.
        unsafe { scb.hfsr.write(hfsr) };
        return;
    }
    crash(&Fault { pc: frame.pc(), lr: frame.lr(), xpsr: frame.xpsr(), cfsr, hfsr, bfar })
}

/// A call to the debugger with no debugger there fails as if it had answered -1, so that an image with logs runs
/// without one, too. Whether this was such a call.
fn step_over_debugger_call(frame: &mut ExceptionFrame) -> bool {
    // SAFETY: with CFSR clear the processor has fetched the instruction at this even address.
    let instruction = unsafe { (frame.pc() as *const u16).read_volatile() };
    let is_call = instruction == DEBUGGER_CALL.0;
    if is_call {
        ALONE.store(true, Ordering::Relaxed);
        // SAFETY: a debugger's answer changes just these: the result and the place to go on.
        unsafe {
            frame.set_r0(u32::MAX);
            frame.set_pc(frame.pc().wrapping_add(DEBUGGER_CALL.1));
        }
    }
    is_call
}

fn crash(report: &dyn Display) -> ! {
    cortex_m::interrupt::disable();
    if !ALONE.load(Ordering::Relaxed) {
        if !CRASHED.swap(true, Ordering::Relaxed)
            && let Ok(mut stderr) = hio::hstderr()
        {
            let _ = writeln!(stderr, "{report}");
        }
        debug::exit(debug::EXIT_FAILURE);
    }
    loop {
        cortex_m::asm::wfi();
    }
}
