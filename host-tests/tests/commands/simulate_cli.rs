//! `cargo simulate` says what it computes: digits and bits are the same numbers, turns are counted, and a board's rows are the host's.

use std::f64::consts::PI;

use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::oracle::tolerances;

use super::cli::{output, program};

fn simulate(arguments: &str) -> String {
    let output = output(program("simulate").args(arguments.split_whitespace()));
    assert!(output.status.success(), "{arguments}: {}", output.stderr);
    output.stdout
}

/// The rows that the command prints, cell by cell, without the header.
fn rows(arguments: &str) -> Vec<Vec<String>> {
    simulate(arguments).lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The numbers of its last row.
fn last(arguments: &str) -> Vec<f64> {
    let number = |text: &String| text.parse().unwrap_or_else(|_| panic!("'{text}' is no number"));
    rows(arguments).last().expect("a row").iter().map(number).collect()
}

#[test]
fn digits_read_back_exactly_and_bits_say_the_same() {
    let single = |digits: &str| digits.parse::<f32>().map(|number| format!("{:08x}", number.to_bits()));
    let double = |digits: &str| digits.parse::<f64>().map(|number| format!("{:016x}", number.to_bits()));
    let motion = "--angles 1,-2 --velocities 1e-12,0 --step 1/64 --until 1/2 --bits";
    for (method, bits) in [("rk4-f64", &double as &dyn Fn(&str) -> _), ("rk4-f32", &single)] {
        for row in rows(&format!("{motion} --method {method}")) {
            (1..5).for_each(|column| assert_eq!(bits(&row[column]), Ok(row[column + 7].clone()), "{method}: {row:?}"));
        }
    }
}

/// That each method is right, test `kernel methods::` sees to; here are whole turns, and what makes no steps.
#[test]
fn turns_are_counted_and_small_swings_have_a_closed_form() {
    const SMALL: &str = "--masses 1,2 --lengths 0.5,0.5 --angles 1e-4,1e-4 --until 1 --every 1 --step 1/1024";
    const FIGURE_7: &str = "--masses 1,2.75 --angles 171,171 --degrees --until 3 --every 1 --step 1/4096";
    assert!(last(FIGURE_7)[2] > PI, "it does not turn over");
    let single = tolerances::FIGURE_7_IN_32_BITS;
    for (motion, method, tolerance) in [
        (SMALL, "closed-form-f64", tolerances::SMALL_SWING),
        (FIGURE_7, "rk4-fixed32", single),
        (FIGURE_7, "rk4-f32-direction", single),
    ] {
        let [exact, other] = ["rk4-f64", method].map(|method| last(&format!("{motion} --method {method}")));
        let apart = (1..3).map(|column| (exact[column] - other[column]).abs()).fold(0.0, f64::max);
        assert!(apart < tolerance, "{motion} --method {method}: {apart:e}");
    }
}

/// At the largest angle that is taken, a direction has half of the digits.
#[test]
fn many_turns_at_the_start_keep_the_energy() {
    for (start, digits) in [("67108864,0", 1e-5), ("4096,0 --method rk4-f32", 5e-2)] {
        let [before, after] = [0, 1].map(|until| last(&format!("--angles {start} --until {until} --every 1"))[7]);
        assert!((after - before).abs() < digits * before.abs(), "{start}: {before} {after}");
    }
}

fn same_on(board: &Board, options: &str) {
    let host = simulate(&format!("{options} --bits"));
    assert!(host.lines().count() > 2);
    assert_eq!(simulate(&format!("{options} --bits --on {}", board.name)), host, "{options} on {}", board.name);
}

/// Test `verify_board` compares every method, `identity` every step.
#[test]
fn unequal_rods_with_velocities_have_the_same_bits_on_every_board() {
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
    let tolerated = simulate(&format!("{motion} --tolerance 1e-4 --on {}", BOARDS[0].name));
    assert_eq!(tolerated, simulate(&format!("{motion} --tolerance 1e-4 --method rk4-fixed32 --on host")));
    assert_ne!(tolerated, simulate(&format!("{motion} --tolerance 1e-4")));
}
