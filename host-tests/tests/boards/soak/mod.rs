//! Long runs on the emulated boards: drift, leaks or a count that runs over show.
//!
//! The clock of the board is the counted one, so that an hour of it takes minutes and any run can be repeated. The long one:
//! `cargo test -p host-tests --test boards soak:: -- --ignored`.

mod physics;
mod scenes;

use std::fmt;
use std::time::Duration;

use firmware::protocol::Frame;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Machine, QemuError, Settings};
use host_tests::link::Counts;
use rayon::prelude::*;

use crate::support::{LIMIT, on};

/// Seconds of the board's time in a short run: 1.5 for each scene, twice. Within 1.1 s the stack has been as deep on every
/// board as it gets in an hour, an interrupt apart, whichever tick a scene is left at.
const SCENES: u32 = 36;
/// Minutes of the motion's time in a short run.
const PHYSICS: u32 = 2;
/// An hour of scenes, a day of physics.
const LONG: [u32; 2] = [3600, 24 * 60];
/// Guards a long run against a hang: the slowest board on a slow host takes a tenth of it.
const LONG_LIMIT: Duration = Duration::from_secs(6 * 3600);

/// What a run has shown.
#[derive(Debug, Default)]
struct Outcome {
    /// Frames drawn and sent.
    frames: u64,
    /// The largest energy error, relative to the energy above hanging at rest.
    energy_error: f64,
    /// The most bytes that the stack has held, where that was measured.
    stack: Option<u32>,
    /// What was not as it must be; empty if all was well.
    faults: Vec<String>,
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
        let Self { frames, energy_error, stack, faults } = self;
        write!(f, "{frames} frames, largest energy error {energy_error:.1e}, stack {stack:?} bytes, {faults:?}")
    }
}

fn scenes(seconds: u32, limit: Duration) -> Result<(), QemuError> {
    BOARDS.par_iter().try_for_each(|board| {
        let outcome = on(board, |settings| scenes::scenes(&Settings { limit, ..*settings }, seconds))?;
        println!("{}: {seconds} s of scenes: {outcome}", board.name);
        assert!(outcome.faults.is_empty(), "{}: {outcome}", board.name);
        assert!(outcome.frames >= u64::from(60 * seconds), "{}: {outcome}", board.name);
        Ok(())
    })
}

fn physics(minutes: u32, limit: Duration) -> Result<(), QemuError> {
    let board = BOARDS.iter().find(|board| board.name == "mps2-an386").expect("it is a board");
    let outcome = on(board, |settings| physics::physics(&Settings { limit, ..*settings }, minutes))?;
    println!("{minutes} min of physics: {outcome}");
    assert!(outcome.faults.is_empty(), "{outcome}");
    Ok(())
}

#[test]
fn every_board_plays_all_scenes_twice_alike() -> Result<(), QemuError> {
    scenes(SCENES, LIMIT)
}

#[test]
fn physics_alone_keeps_its_energy() -> Result<(), QemuError> {
    physics(PHYSICS, LIMIT)
}

#[test]
#[ignore = "takes hours"]
fn an_hour_of_scenes_and_a_day_of_physics() -> Result<(), QemuError> {
    let [seconds, minutes] = LONG;
    scenes(seconds, LONG_LIMIT)?;
    physics(minutes, LONG_LIMIT)
}
