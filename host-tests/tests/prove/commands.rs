//! `cargo prove`: what it says, and what it refuses.

use std::process::{Command, Output};

use firmware::scenes::SceneName;
use host_tests::commands::prove::{horizons, known_answers};

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
    for words in ["until 20.617 s, every one of 1237 frames", "wrong at 20.633 s", "open       0 frames", "at 8.767 s"]
    {
        assert!(page.contains(words), "{page}");
    }
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
fn the_readme_has_the_table_that_the_command_makes() {
    let table = horizons([SceneName::Figure7].iter(), || ()).expect("it can be proved").markdown_rows();
    let readme = include_str!("../../README.md");
    assert!(table.lines().all(|line| readme.lines().any(|other| other == line)), "{table}");
}

#[test]
fn the_known_answers_are_those_that_the_command_makes() {
    let mut lines = Vec::new();
    let keep = |line| {
        lines.push(line);
        Ok(())
    };
    known_answers(|scene| scene == "S11", keep).expect("it can be proved");
    let file = include_str!("../../data/known_answers.csv");
    let kept = file.lines().filter(|line| line.starts_with("scene,") || line.starts_with("S11,"));
    assert_eq!(lines, kept.collect::<Vec<_>>());
}

#[test]
fn bad_input_is_refused_in_one_line() {
    for (arguments, word) in [
        ("--masses 0,1", "--masses"),
        ("--method rk4-f64", "rk4-f64"),
        ("--method rk4-fixed32 --steps 0", "--steps"),
        ("--scene flips", "flips"),
        ("--study 3", "--study"),
        ("--lengths 1,1.00000000000000000001", "18 digits"),
    ] {
        let output = prove(arguments);
        let error = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {error}");
        assert!(error.lines().count() == 1 && error.contains(word) && output.stdout.is_empty(), "{arguments}: {error}");
    }
}
