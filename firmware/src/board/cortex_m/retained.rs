//! The retained record in memory that a reset does not clear. The main loop writes it after each
//! frame, and a crash writes it at the end.
//!
//! A record is intact if its CRC matches and if a program with this version of the protocol, built
//! for the same panel, wrote it. After power-on none is.

use core::hint::black_box;
use core::sync::atomic::{AtomicU8, Ordering};

use crate::app::Record;
use crate::display::PanelOptions;
use crate::protocol::{Cause, MAX_WIRE, Restarted};

/// The two copies of the record. If a reset interrupts a write, the other copy is still intact; the
/// CRC shows which.
// SAFETY: start-up does not initialise this section, and its contents are bytes.
#[unsafe(link_section = ".uninit.kept")]
static KEPT: [[AtomicU8; MAX_WIRE]; 2] = [const { [const { AtomicU8::new(0) }; MAX_WIRE] }; 2];

/// Returns the copies, hidden from the optimiser. The compiler must assume nothing about them:
/// their bytes come from the program before a reset, and are read by the program after it.
fn copies() -> &'static [[AtomicU8; MAX_WIRE]; 2] {
    black_box(&KEPT)
}

/// Writes the record in place of the earlier one, in case this frame is the last. It is stored
/// twice, so that one copy is intact if a reset interrupts the writing.
#[inline(never)] // Test `scenes` profiles it by its name.
pub fn keep(record: &Record) {
    let bytes = record.write();
    for copy in copies() {
        for (place, byte) in copy.iter().zip(bytes) {
            place.store(byte, Ordering::Relaxed);
        }
    }
}

/// Returns the first copy that is intact; `None` if neither is, as when the board is switched on.
#[inline(never)] // Inlined, it and `main_loop::log` take 3.6 KB of flash (M0+).
fn kept() -> Option<Record> {
    copies()
        .iter()
        .find_map(|copy| Record::read(&copy.each_ref().map(|byte| byte.load(Ordering::Relaxed))))
}

/// Returns the record that was kept across the last reset, with this restart counted. Returns
/// `None` if no record is intact, or after a reset from outside: the record has no cause and
/// `by_watchdog` is false. `by_watchdog` is the board's own information that the watchdog caused
/// the reset, which counts as a hang if the record has no cause ([`Record::restart`]). To be called
/// before the first [`keep`], which replaces that record; the stored record is not changed.
pub fn recall(by_watchdog: bool) -> Option<Record> {
    kept()?.restart(by_watchdog)
}

/// Returns the choices for the panel, as the stored record has them, after any reset that left
/// memory powered; `None` if no record is intact.
pub fn chosen_panel() -> Option<PanelOptions> {
    Some(kept()?.played.panel.chosen)
}

/// Returns the second part of the stored record: the scene of the last frame and its tick, counted
/// from the start of that scene, and the cause if [`end`] has recorded one. Before the first
/// [`keep`] it is the record of the run before the reset. Returns `None` if no record is intact.
pub fn last() -> Option<Restarted> {
    kept().map(|record| record.end)
}

/// Records why the program ends: the cause, the program counter, the link register and the fault
/// status (CFSR), 0 where unknown. They replace those of an earlier call; the rest of the record
/// stays. Does nothing if no record is intact, as before the first scene after power-on.
pub fn end(cause: Cause, pc: u32, lr: u32, cfsr: u32) {
    if let Some(Record { played, end }) = kept() {
        keep(&Record {
            played,
            end: Restarted {
                cause: Some(cause),
                pc,
                lr,
                cfsr,
                ..end
            },
        });
    }
}
