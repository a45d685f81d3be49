//! The end: panics and faults are reported in plain text on the debugger's standard error, then the run fails.
//!
//! Plain text there, and not a defmt log, because a crash may come in the middle of a log line, and because it must be
//! readable without any tool. Without a debugger the board keeps why it crashed and restarts,
//! and the next run tells. A program that hangs is reported when the watchdog first calls; if it goes on after all,
//! nothing else comes of it, if not, the watchdog resets the board.
//!
//! # A debugger that has gone
//!
//! A debugger that is there answers a call at once; one that is not is recognised by the call's fault, or on a chip by the
//! processor's debug mode being off (C_DEBUGEN). A probe that was unplugged without switching that off looks as if it were
//! there, and the processor halts in the call for good: only a probe or a loss of power takes it out of debug mode, the program
//! cannot. So the watchdog, which stands still while a debugger halts the processor, no longer does so from the first word of
//! a report on, and resets the board. Whoever wants to look at a crashed board at leisure sets a breakpoint where the report
//! begins, at `crash`. A log line that goes by such a call waits for a gone probe, too, with the watchdog standing still: the
//! LM3S6965's does until it loses power; the STM32F405's log is in memory and waits for no one.

use core::arch::naked_asm;
use core::cell::UnsafeCell;
use core::fmt::{Display, Write};
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::{DCB, SCB};
use cortex_m::register::msp;
use cortex_m_rt::ExceptionFrame;
use cortex_m_semihosting::{debug, hio};

use super::stack::{calls, instruction};
use super::{retained, watchdog};
use crate::config::WATCHDOG_SECONDS;
use crate::fault::{Fault, Stacked};
use crate::protocol::Cause;

/// A call to the debugger, `bkpt 0xAB`, and its length in bytes.
const DEBUGGER_CALL: (u16, u32) = (0xBEAB, 2);
const STACK_SIZE: usize = 2048;

/// Set once a call to the debugger was not answered.
static ALONE: AtomicBool = AtomicBool::new(false);
/// Set once a crash is being reported: a crash of the report itself is not.
static CRASHED: AtomicBool = AtomicBool::new(false);
/// The stack on which faults are reported: the other one may be the reason.
static STACK: Stack = Stack(UnsafeCell::new([0; STACK_SIZE]));

#[repr(align(8))]
struct Stack(#[expect(dead_code, reason = "only its place is used")] UnsafeCell<[u8; STACK_SIZE]>);

// SAFETY: only `HardFault` puts the stack pointer there, and a fault within it is no second one but the processor's lockup.
// What can interrupt it, the watchdog's call that cannot be masked, stacks below it and returns.
unsafe impl Sync for Stack {}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    // Where this handler was called, and where the function that did so was: found on the stack, as the registers hold something
    // else by now. The second is where the panic is, unless a helper was between.
    let mut calls = calls(msp::read());
    let [pc, lr] = [(); 2].map(|()| calls.next().unwrap_or_default());
    // Of a fault before, if it is not zero.
    let [cfsr, ..] = fault_status(false);
    crash(
        (Cause::Panic, pc, lr, cfsr),
        &format_args!("PANIC: {info}\n  pc {pc:#010x}  lr {lr:#010x}  cfsr {cfsr:#010x}"),
    )
}

/// Every fault ends here, since none has a handler of its own, on a stack of its own. Passes on where the processor put
/// the registers, and what tells how many they are; cortex-m-rt's own trampoline is of no use because it cannot return.
///
/// # Safety
///
/// Only the processor may call it, through the vector table.
// SAFETY: the name is the vector table's for just this.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() {
    naked_asm!(
        "mrs r0, msp", // The program and the interrupts have this one stack.
        "mov r1, lr",
        "ldr r2, 0f",
        "mov sp, r2",
        "push {{r0, r1}}",
        "bl {hard_fault}",
        "pop {{r0, r1}}",
        "mov sp, r0",
        "bx r1",
        ".p2align 2",
        "0: .word {stack} + {size}",
        stack = sym STACK,
        size = const STACK_SIZE,
        hard_fault = sym hard_fault,
    )
}

/// `exception` is what the link register holds on the way into a handler.
extern "C" fn hard_fault(frame: *mut ExceptionFrame, exception: u32) {
    let [cfsr, hfsr, mmfar, bfar] = fault_status(false);
    let sp = (frame as u32).wrapping_add(Stacked::size(exception));
    // SAFETY: the processor has put the frame there, and nothing else knows of it.
    let mut frame = Fault::has_stacked(cfsr).then(|| unsafe { &mut *frame });
    // A breakpoint is the one fault that leaves CFSR clear, where there is one. (It also sets HFSR.DEBUGEVT, but not in QEMU.)
    if cfsr == 0
        && let Some(frame) = &mut frame
        && step_over_debugger_call(frame)
    {
        fault_status(true);
        return;
    }
    let stacked = frame.map(|frame| Stacked {
        pc: frame.pc(),
        lr: frame.lr(),
        xpsr: frame.xpsr(),
    });
    let last_call = calls(sp).next();
    let (pc, lr) = stacked.map_or((0, last_call.unwrap_or_default()), |stacked| {
        (stacked.pc, stacked.lr)
    });
    crash(
        (Cause::Fault, pc, lr, cfsr),
        &Fault {
            stacked,
            sp,
            last_call,
            cfsr,
            hfsr,
            mmfar,
            bfar,
        },
    )
}

/// A call to the debugger with no debugger there fails as if it had answered -1, so that an image with logs runs
/// without one, too. Whether this was such a call.
fn step_over_debugger_call(frame: &mut ExceptionFrame) -> bool {
    let is_call = instruction(frame.pc()) == Some(DEBUGGER_CALL.0);
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

/// The program has finished no frame for too long; `interrupted` is where it is.
///
/// Not so if it is a report that takes so long, which the call that cannot be masked interrupts all the same.
pub(super) fn hang(interrupted: &ExceptionFrame) {
    if CRASHED.load(Ordering::Relaxed) {
        return;
    }
    let (pc, lr) = (interrupted.pc(), interrupted.lr());
    retained::end(Cause::Hang, pc, lr, 0);
    if watchdog::has_ticked() && !ALONE.load(Ordering::Relaxed) {
        watchdog::stall(false);
        say(&format_args!(
            "HANG: no frame finished for {WATCHDOG_SECONDS} s\n  pc {pc:#010x}  lr {lr:#010x}"
        ));
        watchdog::stall(true);
    }
}

/// On a chip a debugger can be recognised, and a call to one that is not there is the better avoided: in a fault handler it
/// would be the end.
#[cfg(any(feature = "pico", feature = "stm32f405"))]
pub(in crate::board) fn expect_no_debugger() {
    ALONE.store(true, Ordering::Relaxed);
}

fn crash((cause, pc, lr, cfsr): (Cause, u32, u32, u32), report: &dyn Display) -> ! {
    cortex_m::interrupt::disable();
    let is_first = !CRASHED.load(Ordering::Relaxed);
    CRASHED.store(true, Ordering::Relaxed);
    if is_first {
        retained::end(cause, pc, lr, cfsr);
    }
    // The processor's debug registers are not for an M0+ to read.
    if !ALONE.load(Ordering::Relaxed) || cfg!(not(armv6m)) && DCB::is_debugger_attached() {
        watchdog::stall(false);
        if is_first {
            say(report);
        }
        debug::exit(debug::EXIT_FAILURE);
    }
    SCB::sys_reset()
}

#[inline(never)]
fn say(report: &dyn Display) {
    if let Ok(mut stderr) = hio::hstderr() {
        let _ = match retained::last() {
            Some(last) => writeln!(stderr, "{report}\n  {last}"),
            None => writeln!(stderr, "{report}\n  no scene yet"),
        };
    }
}

/// Why a fault was taken: CFSR, HFSR, MMFAR and BFAR, zeros on a Cortex-M0+, which has none; if `clears`, HFSR forgets it.
#[cfg(not(armv6m))]
fn fault_status(clears: bool) -> [u32; 4] {
    // SAFETY: it is always there, and nothing else uses these registers.
    let control = unsafe { &*cortex_m::peripheral::SCB::PTR };
    if clears {
        // SAFETY: writing the bits back only clears them.
        unsafe { control.hfsr.modify(|bits| bits) };
    }
    [
        control.cfsr.read(),
        control.hfsr.read(),
        control.mmfar.read(),
        control.bfar.read(),
    ]
}

#[cfg(armv6m)]
fn fault_status(_: bool) -> [u32; 4] {
    [0; 4]
}
