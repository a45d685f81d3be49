//! A short soak; `cargo soak` runs the long one.

use crate::support::{application, settings, toolchain};
use host_tests::commands::soak::{self, Outcome};
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::QemuError;
use rayon::prelude::*;

/// Seconds of the board's time: 1.5 for each scene, twice. Within 1.1 s the stack has been as deep on every board as it gets
/// in an hour, an interrupt apart, whichever tick a scene is left at.
const SCENES: u32 = 36;
/// Minutes of the motion's time.
const PHYSICS: u32 = 2;

fn is_well(board: &Board, outcome: &Outcome) {
    assert!(outcome.faults.is_empty(), "{}: {outcome}", board.name);
}

#[test]
fn every_board_plays_all_scenes_twice_alike() -> Result<(), QemuError> {
    BOARDS.par_iter().try_for_each(|board| {
        let (toolchain, elf) = (toolchain(), application(board));
        let outcome = soak::scenes(&settings(&toolchain, board, &elf), SCENES, || ())?;
        is_well(board, &outcome);
        assert!(outcome.frames >= u64::from(60 * SCENES), "{}: {outcome}", board.name);
        Ok(())
    })
}

#[test]
fn physics_alone_keeps_its_energy() -> Result<(), QemuError> {
    let board = BOARDS.iter().find(|board| board.name == "mps2-an386").expect("it is a board");
    let (toolchain, elf) = (toolchain(), application(board));
    let outcome = soak::physics(&settings(&toolchain, board, &elf), PHYSICS, || ())?;
    is_well(board, &outcome);
    assert_eq!(outcome.steps, 60 * 256 * u64::from(PHYSICS));
    Ok(())
}
