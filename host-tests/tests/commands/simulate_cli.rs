//! `cargo simulate` computes what it says: methods agree, energies stay, digits and bits are the same numbers, and a board's are
//! the host's.

use std::f64::consts::PI;

use double_pendulum::Integrator;
use firmware::job::ON_BOARDS;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::oracle::known_answers::table;
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
fn figure_7_agrees_with_high_precision() {
    let motion = "--masses 1,2.75 --lengths 1,1 --gravity 9.8 --angles 171,171 --degrees";
    let state = last(&format!("{motion} --step 1/4096 --until 5 --every 1 --method rk4-f64"));
    let table = table().expect("the table can be read");
    let mut exact = table.iter().find(|row| row.scene == "S4").expect("figure 7").reference();
    exact.advance_to(5.0);
    for (found, expected) in state[1..5].iter().zip(<[f64; 4]>::from(exact.state())) {
        // Measured 8e-9.
        assert!((found - expected).abs() < tolerances::FIGURE_7, "{found} is not {expected}");
    }
}

#[test]
fn digits_read_back_exactly_and_bits_say_the_same() {
    for (method, is_single) in [("rk4-f64", false), ("rk4-f32", true)] {
        for row in rows(&format!("--angles 1,-2 --velocities 1e-12,0 --step 1/64 --until 1/2 --bits --method {method}"))
        {
            for column in 1..5 {
                let double: f64 = row[column].parse().expect("a number");
                let single: f32 = row[column].parse().expect("a number");
                let bits =
                    if is_single { format!("{:08x}", single.to_bits()) } else { format!("{:016x}", double.to_bits()) };
                assert_eq!(bits, row[column + 7], "{method}: {row:?}");
            }
        }
    }
}

#[test]
fn methods_agree_where_they_must() {
    const SMALL: &str = "--masses 1,2 --lengths 0.5,0.5 --angles 1e-4,1e-4 --until 1 --every 1";
    /// It turns over, so this holds the whole turns too.
    const FIGURE_7: &str = "--masses 1,2.75 --angles 171,171 --degrees --until 3 --every 1";
    const REGULAR: &str = "--angles 0.5,0.5 --gravity 9.8125 --until 10 --every 10";
    assert!(last(&format!("{FIGURE_7} --step 1/4096"))[2] > PI, "it does not turn over");
    for (motion, exact, method, tolerance) in [
        (SMALL, "rk4-f64 --step 1/1024", "closed-form-f64 --step 1/1024", tolerances::SMALL_SWING),
        (FIGURE_7, "rk4-f64 --step 1/4096", "rk4-fixed32 --step 1/4096", tolerances::FIGURE_7_IN_32_BITS),
        (FIGURE_7, "rk4-f64 --step 1/4096", "rk4-f32-direction --step 1/4096", tolerances::FIGURE_7_IN_32_BITS),
        (FIGURE_7, "rk4-f64 --step 1/16384", "extrapolation8-fixed64 --step 1/512", tolerances::FIGURE_7_ORDER_8),
        (REGULAR, "rk4-f64 --step 1/4096", "rk4-f32-direction --step 1/256", tolerances::DIRECTION_FORM[0]),
    ] {
        let [exact, other] = [exact, method].map(|method| last(&format!("{motion} --method {method}")));
        for column in 1..3 {
            let apart = (exact[column] - other[column]).abs();
            assert!(apart < tolerance, "{motion} --method {method}, column {column}: {apart:e}");
        }
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

/// On a Cortex-M3; test `verify_board` does the same on a Cortex-M4F, `identity` compares every step on both.
#[test]
fn every_method_has_the_same_bits_on_a_board() {
    for method in ON_BOARDS {
        let is_linear = method.integrator() == Integrator::ClosedForm;
        // Chaotic, and long enough for one wrong bit to show everywhere.
        let figure_7 = "--masses 1,2.75 --angles 171,171 --degrees";
        let motion = if is_linear { "--angles 0.1,-0.05 --velocities 0.2,0" } else { figure_7 };
        same_on(&BOARDS[0], &format!("{motion} --step 1/256 --until 5 --every 1 --method {method}"));
    }
}

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
