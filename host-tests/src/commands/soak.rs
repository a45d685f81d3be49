//! Long runs on the emulated boards: whatever time brings, drift, leaks or a count that runs over, shows.
//!
//! The clock of the board is the counted one, so that an hour of it takes minutes and any run can be repeated.

mod physics;
mod scenes;

use std::fmt;

use firmware::protocol::Frame;

use crate::emulator::boards::Board;
use crate::emulator::qemu::Machine;
use crate::link::Counts;

pub use physics::{PHYSICS, physics};
pub use scenes::scenes;

/// What a run has shown.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Frames drawn and sent.
    pub frames: u64,
    /// Integration steps computed on request.
    pub steps: u64,
    /// The largest energy error, relative to the energy above hanging at rest.
    pub energy_error: f64,
    /// The most bytes that the stack has held, where that was measured.
    pub stack: Option<u32>,
    /// What was not as it must be; empty if all was well.
    pub faults: Vec<String>,
}

impl Outcome {
    /// Takes a frame; it must follow the one before and no tick may have gone without a frame.
    fn frame(&mut self, frame: &Frame) {
        if u64::from(frame.sequence) != self.frames {
            self.fault(format!("frame {} came as number {}", frame.sequence, self.frames));
        }
        if frame.dropped != 0 {
            self.fault(format!("{} frames were dropped by frame {}", frame.dropped, frame.sequence));
        }
        self.frames += 1;
    }

    /// At the end: what the link and the log say.
    fn end(&mut self, machine: &Machine, board: &Board) {
        /// What a firmware says whose panel QEMU does not emulate.
        const NO_PANEL: &str = "panel: Absent";

        let Counts { damaged, lost, .. } = machine.serial.counts();
        for (count, what) in [(damaged, "messages arrived damaged"), (lost, "frames were lost on the way")] {
            if count > 0 {
                self.fault(format!("{count} {what}"));
            }
        }
        let lines = machine.log.arrived().filter(|line| line.is_bad()).map(|line| line.to_string());
        for line in lines.filter(|line| board.has_panel || !line.contains(NO_PANEL)) {
            self.fault(line);
        }
    }

    /// Notes a fault. The first few tell enough.
    fn fault(&mut self, text: String) {
        const FEW: usize = 10;
        if self.faults.len() < FEW {
            self.faults.push(text);
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, steps, energy_error, stack, faults } = self;
        write!(f, "{frames} frames, {steps} steps on request, largest energy error {energy_error:.1e}, ")?;
        if let Some(stack) = stack {
            write!(f, "stack {stack} bytes, ")?;
        }
        if faults.is_empty() { f.write_str("nothing lost") } else { write!(f, "NOT WELL: {}", faults.join("; ")) }
    }
}
