//! `cargo prove`: what it says, and what it refuses.

use std::process::{Command, Output};

fn prove(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_prove")).args(arguments.split_whitespace()).output().expect("it runs")
}

fn said(arguments: &str) -> String {
    let output = prove(arguments);
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("text")
}

/// The page's horizon, as a theorem.
#[test]
fn the_pages_frames_are_right_until_20_617_s() {
    let page = said("--scene page");
    assert!(page.contains("until 20.617 s, every one of 1237 frames") && page.contains("wrong at 20.633 s"), "{page}");
    assert!(page.contains("open       0 frames"), "{page}");
    let other = said("--scene page --method rk4-f32-direction --steps 4");
    assert!(other.contains("until 10.517 s"), "{other}");
}

/// Decimals are not what `f64` has of them, and the box is written frame by frame.
#[test]
fn decimals_are_enclosed_and_a_table_has_a_row_for_each_frame() {
    let csv = said("--angles 120,120 --degrees --duration 1 --csv");
    assert_eq!(csv.lines().count(), 61);
    assert!(csv.lines().skip(1).all(|line| line.ends_with(",right")), "{csv}");
    assert!(said("--angles 1/3,0.1 --duration 1").contains("none wrong of all 60 frames"));
}

#[test]
fn bad_input_is_refused_in_one_line() {
    for (arguments, word) in [
        ("--masses 0,1", "--masses"),
        ("--method rk4-f64", "rk4-f64"),
        ("--method rk4-fixed32 --steps 0", "--steps"),
        ("--scene flips", "flips"),
        ("--study 3", "--study"),
        ("--lengths 1,1.00000000000000000000000000000000000000001", "38 digits"),
    ] {
        let output = prove(arguments);
        let error = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {error}");
        assert!(error.lines().count() == 1 && error.contains(word) && output.stdout.is_empty(), "{arguments}: {error}");
    }
}
