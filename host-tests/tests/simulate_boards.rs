//! `cargo simulate --on BOARD` gives the same rows as on the host, to the bit.

use std::process::Command;

use host_tests::emulator::boards::{BOARDS, Board, STM32F405};

fn simulate(arguments: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_simulate"))
        .args(arguments.split_whitespace())
        .output()
        .unwrap_or_else(|error| panic!("simulate {arguments}: {error}"));
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// One board for each kind of processor: the boards of a kind run the same code (every board answers one request below).
const PROCESSORS: [&Board; 2] = [&BOARDS[0], &STM32F405];

fn same_everywhere(options: &str) {
    same_on(PROCESSORS, options);
}

fn same_on<'a>(boards: impl IntoIterator<Item = &'a Board>, options: &str) {
    let host = simulate(&format!("{options} --bits"));
    assert!(host.lines().count() > 2);
    for board in boards {
        assert_eq!(simulate(&format!("{options} --bits --on {}", board.name)), host, "{options} on {}", board.name);
    }
}

/// Chaotic, and long enough for one wrong bit to show everywhere.
const FIGURE_7: &str = "--masses 1,2.75 --angles 171,171 --degrees --until 5 --every 1";

#[test]
fn single_precision() {
    same_everywhere(&format!("{FIGURE_7} --step 1/4096 --arithmetic f32"));
}

#[test]
fn double_precision() {
    same_everywhere(&format!("{FIGURE_7} --step 1/512 --arithmetic f64"));
}

#[test]
fn equal_rods() {
    same_everywhere(&format!("{FIGURE_7} --step 1/512 --arithmetic f32 --model equal-rods"));
}

#[test]
fn unequal_rods_with_velocities_on_every_board() {
    same_on(
        &BOARDS,
        "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 --step 1/256 --until 4 --every 1/2 --arithmetic f32",
    );
}

#[test]
fn compensated_single_precision_in_angles() {
    same_everywhere(&format!("{FIGURE_7} --step 1/4096 --arithmetic f32-compensated"));
}

#[test]
fn compensated_single_precision_in_directions() {
    same_everywhere(&format!("{FIGURE_7} --step 1/4096 --arithmetic f32-compensated --form direction"));
}

#[test]
fn plain_forms() {
    for (arithmetic, form) in [("f32", "angle"), ("f32", "direction"), ("f64", "angle"), ("f64", "direction")] {
        same_everywhere(&format!("{FIGURE_7} --step 1/256 --arithmetic {arithmetic} --form {form}"));
    }
}

#[test]
fn order_8() {
    same_everywhere(&format!("{FIGURE_7} --step 1/32 --integrator rk8"));
}

#[test]
fn fixed_point() {
    same_everywhere(&format!("{FIGURE_7} --step 1/4096 --arithmetic fixed32"));
    same_everywhere(&format!("{FIGURE_7} --step 1/64 --arithmetic fixed64"));
    same_everywhere("--lengths 0.3,1.1 --velocities 3,-4 --step 1/256 --until 4 --every 1 --arithmetic fixed32");
}

#[test]
fn every_order_of_extrapolation() {
    for order in [6, 8, 12, 16] {
        same_everywhere(&format!(
            "{FIGURE_7} --step 1/128 --arithmetic fixed64 --integrator extrapolation --order {order}"
        ));
    }
}

#[test]
fn closed_form() {
    same_everywhere(
        "--angles 0.1,-0.05 --velocities 0.2,0 --step 1/64 --until 10 --every 1 --arithmetic f64 --model linear",
    );
}
