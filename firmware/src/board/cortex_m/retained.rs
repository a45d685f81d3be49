//! The memory that is kept across a reset, and who writes it: the main loop after each frame, a crash at the end.

use core::hint::black_box;
use core::sync::atomic::{AtomicU8, Ordering};

use crate::app::Record;
use crate::display::Controller;
use crate::protocol::{Cause, MAX_WIRE, Restarted};

/// Two copies: whenever the program ends, even in the middle of writing one, the other is whole. The message's check tells
/// which.
// SAFETY: start-up leaves this section alone, and what stands there is bytes.
#[unsafe(link_section = ".uninit.kept")]
static KEPT: [[AtomicU8; MAX_WIRE]; 2] = [const { [const { AtomicU8::new(0) }; MAX_WIRE] }; 2];

/// The bytes, of which the compiler must assume nothing: what is read here was written by a program that has ended, and
/// what is written is for one yet to come.
fn copies() -> &'static [[AtomicU8; MAX_WIRE]; 2] {
    black_box(&KEPT)
}

/// Keeps what is played and where it stands, in case this frame is the last.
#[inline(never)]
pub fn keep(record: &Record) {
    let bytes = record.write();
    for copy in copies() {
        for (place, byte) in copy.iter().zip(bytes) {
            place.store(byte, Ordering::Relaxed);
        }
    }
}

#[inline(never)]
fn kept() -> Option<Record> {
    copies()
        .iter()
        .find_map(|copy| Record::read(&copy.each_ref().map(|byte| byte.load(Ordering::Relaxed))))
}

/// What was kept across the last reset, if that was no planned one.
pub fn recall(by_watchdog: bool) -> Option<Record> {
    kept()?.restart(by_watchdog)
}

/// Returns the controller that was chosen for the panel, after any reset that left memory powered.
pub fn chosen_panel() -> Option<Controller> {
    kept()?.played.panel.chosen
}

pub fn last() -> Option<Restarted> {
    kept().map(|record| record.end)
}

/// Notes why the program ends, unless it has shown nothing yet.
#[inline(never)]
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
