//! Crash reports: panics and faults are reported in plain text on the debugger's standard error,
//! and then the run fails.
//!
//! The report is plain text, not a defmt log, because a crash may happen in the middle of a log
//! line, and because the report must be readable without any tool. Without a debugger, and on a Pico
//! always, the board keeps the cause and restarts, and the next run logs it (`resume`,
//! `board/main_loop.rs`).
//!
//! A program that hangs is reported at the first interrupt of the watchdog. If the program
//! continues nevertheless, nothing else happens. Otherwise the watchdog resets the board.
//!
//! # A debugger that is gone
//!
//! A debugger that is present answers a call at once. An absent one is recognised by the fault of
//! the call, or on a chip by the processor's debug mode, which is off (C_DEBUGEN).
//!
//! A probe that was unplugged without switching debug mode off seems to be present, and the
//! processor halts in the call for good. Only a probe or a loss of power ends debug mode; the
//! program cannot. So from the first word of a report on, the watchdog no longer stops while a
//! debugger halts the processor, and resets the board. To examine a crashed board at leisure, set a
//! breakpoint at `crash`, where the report begins.
//!
//! A log line that uses such a call also waits for an absent probe, and then the watchdog is
//! stopped. The log of the LM3S6965 waits until it loses power. The log of the STM32F405 is in
//! memory and never waits.

use core::arch::{asm, naked_asm};
use core::cell::UnsafeCell;
use core::fmt::{Display, Write};
use core::panic::PanicInfo;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::peripheral::{DCB, SCB};
use cortex_m_rt::ExceptionFrame;
use cortex_m_semihosting::{debug, hio};

use super::stack::{self, calls, instruction};
use super::{retained, watchdog};
use crate::config::WATCHDOG_SECONDS;
use crate::fault::{Fault, Stacked};
use crate::protocol::Cause;

/// A call to the debugger, `bkpt 0xAB`, and its length, bytes.
const DEBUGGER_CALL: (u16, u32) = (0xBEAB, 2);
const STACK_SIZE: usize = 2048;

/// True if no debugger is assumed to be present: a call was not answered, or the board is a chip.
static ALONE: AtomicBool = AtomicBool::new(false);
/// True after the start of a crash report. A crash within the report is not reported.
static CRASHED: AtomicBool = AtomicBool::new(false);
/// The stack for the reports of faults. The other stack may be the cause of the fault.
static STACK: Stack = Stack(UnsafeCell::new([0; STACK_SIZE]));

#[repr(align(8))]
struct Stack(#[expect(dead_code, reason = "only its place is used")] UnsafeCell<[u8; STACK_SIZE]>);

// SAFETY: only `HardFault` sets the stack pointer to it. A fault within `HardFault` is not taken
// again: the processor locks up. The watchdog's interrupt that cannot be masked may interrupt it;
// it stacks below and returns.
unsafe impl Sync for Stack {}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    // The call of this handler, and the call of the function that called it. They are found on the
    // stack from the frame pointer on: below it, this function's own frame may contain calls that
    // have returned. The second call is the place of the panic, unless a helper function is in
    // between.
    let frame: u32;
    // SAFETY: a register is read.
    unsafe { asm!("mov {}, r7", out(reg) frame, options(nomem, nostack, preserves_flags)) };
    let mut calls = calls(frame);
    let [pc, lr] = [(); 2].map(|()| calls.next().unwrap_or_default());

    // The status of an earlier fault, if it is not zero.
    let [cfsr, ..] = fault_status(false);
    crash(
        (Cause::Panic, pc, lr, cfsr),
        &format_args!("PANIC: {info}\n  pc {pc:#010x}  lr {lr:#010x}  cfsr {cfsr:#010x}"),
    )
}

/// The handler of every fault. The trampoline of cortex-m-rt is not used because it cannot return.
///
/// # Safety
///
/// Only the processor may call it, through the vector table.
// SAFETY: the vector table uses this name for this handler.
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

extern "C" fn hard_fault(frame: *mut ExceptionFrame, exception: u32) {
    let [cfsr, hfsr, bfar] = fault_status(false);
    let sp = (frame as u32).wrapping_add(Stacked::size(exception));
    let stack_end = stack::end();
    let has_stacked = frame as u32 >= stack_end && Fault::has_stacked(cfsr);
    // SAFETY: the processor has put the frame there, and no other code refers to it.
    let mut frame = has_stacked.then(|| unsafe { &mut *frame });

    // A breakpoint is the only fault that leaves CFSR clear, on processors that have a CFSR. (It
    // also sets HFSR.DEBUGEVT, but not in QEMU.)
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
            stack_end,
            last_call,
            cfsr,
            hfsr,
            bfar,
        },
    )
}

/// Completes a call to an absent debugger as if it had answered -1, so that an image with logs also
/// runs without a debugger. Returns true if the fault was such a call.
fn step_over_debugger_call(frame: &mut ExceptionFrame) -> bool {
    let is_call = instruction(frame.pc()) == Some(DEBUGGER_CALL.0);
    if is_call {
        ALONE.store(true, Ordering::Relaxed);
        // SAFETY: the answer of a debugger changes just these two: the result and the program
        // counter.
        unsafe {
            frame.set_r0(u32::MAX);
            frame.set_pc(frame.pc().wrapping_add(DEBUGGER_CALL.1));
        }
    }
    is_call
}

/// Records a hang, and reports it to a debugger. The program then continues.
///
/// After the start of a crash report it does nothing: the report may take this long, and the
/// interrupt that cannot be masked interrupts it.
pub(super) fn hang(interrupted: &ExceptionFrame) {
    if CRASHED.load(Ordering::Relaxed) {
        return;
    }
    let pc = interrupted.pc();
    let lr = interrupted.lr();

    retained::end(Cause::Hang, pc, lr, 0);
    if watchdog::has_ticked() && !ALONE.load(Ordering::Relaxed) {
        watchdog::stall(false);
        say(&format_args!(
            "HANG: no frame finished for {WATCHDOG_SECONDS} s\n  pc {pc:#010x}  lr {lr:#010x}"
        ));
        watchdog::stall(true);
    }
}

/// Assumes from now on that no debugger is present, unless the processor's debug mode is on.
///
/// On a chip a debugger can be recognised. A call to an absent one is better avoided, because
/// within a fault handler it would be fatal.
#[cfg(any(feature = "pico", feature = "stm32f405"))]
pub(in crate::board) fn expect_no_debugger() {
    ALONE.store(true, Ordering::Relaxed);
}

fn crash((cause, pc, lr, cfsr): (Cause, u32, u32, u32), report: &dyn Display) -> ! {
    cortex_m::interrupt::disable();
    let is_first = !CRASHED.load(Ordering::Relaxed);
    CRASHED.store(true, Ordering::Relaxed);
    // The first crash is the cause; a crash within its report is a consequence.
    if is_first {
        retained::end(cause, pc, lr, cfsr);
    }

    // An M0+ cannot read the debug registers of the processor.
    if !ALONE.load(Ordering::Relaxed) || cfg!(not(armv6m)) && DCB::is_debugger_attached() {
        watchdog::stall(false);
        if is_first {
            say(report);
        }
        debug::exit(debug::EXIT_FAILURE);
    }
    SCB::sys_reset()
}

fn say(report: &dyn Display) {
    if let Ok(mut stderr) = hio::hstderr() {
        let _ = match retained::last() {
            Some(last) => writeln!(stderr, "{report}\n  {last}"),
            None => writeln!(stderr, "{report}\n  no scene yet"),
        };
    }
}

/// Returns CFSR, HFSR and BFAR. A Cortex-M0+ has no such registers.
#[cfg(not(armv6m))]
fn fault_status(clears: bool) -> [u32; 3] {
    // SAFETY: the registers always exist, and no other code uses them.
    let control = unsafe { &*cortex_m::peripheral::SCB::PTR };
    if clears {
        // SAFETY: writing the bits back clears them and has no other effect.
        unsafe { control.hfsr.modify(|bits| bits) };
    }
    [
        control.cfsr.read(),
        control.hfsr.read(),
        control.bfar.read(),
    ]
}

#[cfg(armv6m)]
fn fault_status(_: bool) -> [u32; 3] {
    [0; 3]
}
