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

/// Writes the record in place of the earlier one, in case this frame is the last.
#[inline(never)] // Test `scenes` profiles it by its name.
pub fn keep(record: &Record) {
    let bytes = record.write();
    for copy in copies() {
        for (place, byte) in copy.iter().zip(bytes) {
            place.store(byte, Ordering::Relaxed);
        }
    }
}

fn kept() -> Option<Record> {
    copies()
        .iter()
        .find_map(|copy| Record::read(&copy.each_ref().map(|byte| byte.load(Ordering::Relaxed))))
}

/// Returns the record that was kept across the last reset, with this restart counted; `None` after
/// a reset from outside. `by_watchdog` is the board's own information that the watchdog caused the
/// reset. Called before the first [`keep`], which replaces that record.
pub fn recall(by_watchdog: bool) -> Option<Record> {
    kept()?.restart(by_watchdog)
}

/// Returns the choices for the panel, after any reset that left memory powered.
pub fn chosen_panel() -> Option<PanelOptions> {
    Some(kept()?.played.panel.chosen)
}

/// Returns the scene and tick of the last frame, and the cause if [`end`] has recorded one.
pub fn last() -> Option<Restarted> {
    kept().map(|record| record.end)
}

/// Records why the program ends.
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
