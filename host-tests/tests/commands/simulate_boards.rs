//! `cargo simulate --on BOARD` gives the same rows as on the host, to the bit.

use std::process::Command;

use double_pendulum::Integrator;
use firmware::job::ON_BOARDS;
use host_tests::emulator::boards::{BOARDS, Board};

fn simulate(arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_simulate"))
        .args(arguments.split_whitespace())
        .output()
        .unwrap_or_else(|error| panic!("simulate {arguments}: {error}"));
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn same_on(board: &Board, options: &str) {
    let host = simulate(&format!("{options} --bits"));
    assert!(host.lines().count() > 2);
    assert_eq!(simulate(&format!("{options} --bits --on {}", board.name)), host, "{options} on {}", board.name);
}

/// Chaotic, and long enough for one wrong bit to show everywhere.
const FIGURE_7: &str = "--masses 1,2.75 --angles 171,171 --degrees";
/// For the closed form.
const SMALL: &str = "--angles 0.1,-0.05 --velocities 0.2,0";

/// On a Cortex-M3; test `verify_board` does the same on a Cortex-M4F, `identity` compares every step on both.
#[test]
fn every_method() {
    for method in ON_BOARDS {
        let motion = if method.integrator() == Integrator::ClosedForm { SMALL } else { FIGURE_7 };
        same_on(&BOARDS[0], &format!("{motion} --step 1/256 --until 5 --every 1 --method {method}"));
    }
}

#[test]
fn unequal_rods_with_velocities_on_every_board() {
    let rods = "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 --step 1/256 --until 4 --every 1/2";
    for board in &BOARDS {
        for method in ["rk4-f32", "rk4-fixed32"] {
            same_on(board, &format!("{rods} --method {method}"));
        }
    }
}

/// What is chosen for a tolerance is what is computed, on the host and on the board.
#[test]
fn a_tolerance_is_kept_on_a_board() {
    let motion = "--angles 2,2 --until 2 --every 1/2 --bits";
    let board = BOARDS[0].name;
    let tolerated = simulate(&format!("{motion} --tolerance 1e-4 --on {board}"));
    assert_eq!(tolerated, simulate(&format!("{motion} --tolerance 1e-4 --method rk4-fixed32 --on host")));
    assert_ne!(tolerated, simulate(&format!("{motion} --tolerance 1e-4")));
}
