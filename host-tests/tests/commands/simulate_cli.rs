//! `cargo simulate` as a user meets it: tables, digits, bits and refusals.

use std::process::{Command, Output};

use double_pendulum::Method;

use host_tests::oracle::tolerances;

/// Runs the command and waits; everything here takes milliseconds.
fn simulate(arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_simulate"))
        .args(arguments.split_whitespace())
        .output()
        .unwrap_or_else(|error| panic!("simulate {arguments}: {error}"))
}

fn rows(arguments: &str) -> Vec<Vec<String>> {
    let output = simulate(arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("'{text}' is no number"))
}

/// 113-bit results of `data/known_answers.csv`, scene S4, at t = 5 s.
const FIGURE_7_AT_5: [f64; 4] = [2.639210761945576, 9.313387543618361, 3.230631394279675, 4.470030045274852];
/// The RK4 error there with step 1/4096, measured 8e-9 rad; the promise to the user is this.
const PROMISE: f64 = 1e-7;

#[test]
fn figure_7_agrees_with_high_precision() {
    let rows = rows(
        "--masses 1,2.75 --lengths 1,1 --gravity 9.8 --angles 171,171 --degrees --step 1/4096 --until 5 --every 1 \
         --method rk4-f64",
    );
    assert_eq!(rows[0].join(","), "t,a1,a2,p1,p2,w1,w2,energy");
    assert_eq!(rows.len(), 1 + 6);
    assert_eq!(rows.iter().skip(1).map(|row| row[0].as_str()).collect::<Vec<_>>(), ["0", "1", "2", "3", "4", "5"]);
    for (text, expected) in rows[6][1..5].iter().zip(FIGURE_7_AT_5) {
        assert!((number(text) - expected).abs() < PROMISE, "{text} is not {expected}");
    }
}

#[test]
fn digits_read_back_exactly_and_bits_say_the_same() {
    for row in &rows("--angles 1,-2 --velocities 1e-12,0 --step 1/64 --until 1/2 --bits")[1..] {
        for column in 1..5 {
            assert_eq!(format!("{:016x}", number(&row[column]).to_bits()), row[column + 7]);
        }
    }
    for row in &rows("--angles 1,-2 --step 1/64 --until 1/2 --bits --method rk4-f32")[1..] {
        for column in 1..5 {
            let single: f32 = row[column].parse().unwrap_or(f32::NAN);
            assert_eq!(format!("{:08x}", single.to_bits()), row[column + 7]);
        }
    }
}

#[test]
fn models_agree_where_they_must() {
    let options = "--masses 1,2 --lengths 0.5,0.5 --angles 1e-4,1e-4 --step 1/1024 --until 1 --every 1";
    let general = &rows(&format!("{options} --method rk4-f64"))[2];
    for method in ["rk4-f64-equal-rods", "closed-form-f64"] {
        let other = &rows(&format!("{options} --method {method}"))[2];
        for column in 1..3 {
            let difference = number(&general[column]) - number(&other[column]);
            assert!(difference.abs() < tolerances::SMALL_SWING, "{method}, column {column}: {difference:e}");
        }
    }
}

/// At the largest angle that is taken, a direction has half of the digits.
#[test]
fn many_turns_at_the_start_keep_the_energy() {
    for (start, digits) in [("67108864,0", 1e-5), ("4096,0 --method rk4-f32", 5e-2)] {
        let energies = rows(&format!("--angles {start} --until 1 --every 1"));
        let [before, after] = [1, 2].map(|row| number(&energies[row][7]));
        println!("{start}: {before} {after}");
        assert!((after - before).abs() < digits * before.abs(), "{start}: {before} {after}");
    }
}

/// Figure 7 turns over, so this holds the whole turns too.
#[test]
fn every_form_moves_as_the_canonical_state_does() {
    let options = "--masses 1,2.75 --angles 171,171 --degrees --step 1/4096 --until 3 --every 1";
    let canonical = &rows(&format!("{options} --method rk4-f64"))[4];
    assert!(number(&canonical[2]) > std::f64::consts::PI, "it does not turn over: {canonical:?}");
    let [method, single] = tolerances::FIGURE_7_FORMS;
    for (form, difference) in [("rk4-f64-direction", method), ("rk4-fixed32", single), ("rk4-f32-direction", single)] {
        let other = &rows(&format!("{options} --method {form}"))[4];
        for column in 1..3 {
            let apart = (number(&canonical[column]) - number(&other[column])).abs();
            println!("{form}, column {column}: {apart:e}");
            assert!(apart < difference, "{form}, column {column}: {apart:e}");
        }
    }
}

#[test]
fn order_8_needs_few_steps() {
    let options = "--masses 1,2.75 --angles 171,171 --degrees --until 3 --every 1";
    let exact = &rows(&format!("{options} --step 1/16384"))[4];
    for method in ["extrapolation8-f64", "extrapolation8-fixed64"] {
        let other = &rows(&format!("{options} --step 1/512 --method {method}"))[4];
        for column in 1..3 {
            let apart = (number(&exact[column]) - number(&other[column])).abs();
            println!("{method}, column {column}: {apart:e}");
            assert!(apart < tolerances::FIGURE_7_ORDER_8, "{method}, column {column}: {apart:e}");
        }
    }
}

#[test]
fn compensated_single_precision_is_given_to_its_last_digit() {
    let options = "--angles 0.5,0.5 --gravity 9.8125 --until 10 --every 10";
    let exact = &rows(&format!("{options} --method rk4-f64 --step 1/4096"))[2];
    let row = &rows(&format!("{options} --step 1/256 --method rk4-f32-direction"))[2];
    for column in 1..3 {
        let error = (number(&row[column]) - number(&exact[column])).abs();
        assert!(error < tolerances::DIRECTION_FORM[0], "column {column}: {error:e}");
    }
}

#[test]
fn the_table_lists_every_method() {
    let output = Command::new(env!("CARGO_BIN_EXE_simulate")).arg("--list").output().expect("simulate runs");
    let list = String::from_utf8(output.stdout).expect("text");
    assert_eq!(list.lines().count(), 1 + Method::ALL.len(), "{list}");
    for (line, method) in list.lines().skip(1).zip(Method::ALL) {
        assert_eq!(line.split_whitespace().next(), Some(method.name()), "{line}");
    }
}

#[test]
fn bad_input_gets_one_line_and_exit_code_2() {
    for (arguments, named) in [
        ("--lengths 0,1", "l1"),
        ("--lengths 1,nan", "--lengths"),
        ("--masses 1,-2", "m2"),
        ("--masses 1", "--masses"),
        ("--gravity -1", "g"),
        ("--gravity inf", "--gravity"),
        ("--angles 1/0,1", "--angles"),
        ("--velocities 1,x", "--velocities"),
        ("--step 0", "--step"),
        ("--step -1/4", "--step"),
        ("--step 2", "--step"),
        ("--until -1", "--until"),
        ("--until 1 --step 0.3", "--until"),
        ("--every 0", "--every"),
        ("--until 1 --every 0.3 --step 0.1", "--every"),
        ("--until 1e9 --step 1e-9", "--until 1e9: more than 4294967295 times --step 1e-9\n"),
        ("--method f16", "--method"),
        ("--method rk4-f64-equal-rods --lengths 1,2", "l2"),
        ("--method closed-form-f64 --gravity 0", "g"),
        ("--method rk4-fixed32 --step 1/8", "--step: dt"),
        ("--method extrapolation12-fixed64 --masses 1,100000", "--masses"),
        ("--method extrapolation12-f64 --on lm3s6965evb", "--method extrapolation12-f64: not on lm3s6965evb"),
        ("--list --method rk4-f64", "--list"),
        ("--angles 1e15,0", "--angles: 1000000000000000.0 rad: must not exceed 67108864,"),
        ("--angles 0,-5000 --method rk4-f32", "--angles: -5000.0 rad: must not exceed 4096,"),
        ("--velocities 1e300,1", "--velocities 1e300,1: the energy"),
        ("--on moon", "--on"),
        ("--wind 3", "--wind"),
        ("--masses 1e300,1 --lengths 1e200,1", "m1"),
        ("--masses 1e300,1e300 --angles 1,1 --step 1/256 --until 1", "--step 1/256"),
        ("--masses 1e30,1 --lengths 1e10,1 --method rk4-f32", "m1"),
    ] {
        let output = simulate(arguments);
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
        assert!(output.stdout.is_empty(), "{arguments}: wrote to stdout");
        assert_eq!(report.lines().count(), 1, "{arguments}: {report}");
        assert!(report.contains(named), "{arguments}: {report}");
    }
}

#[test]
fn a_step_too_long_for_the_energy_is_computed_and_warned_of() {
    let lively = "--masses 1,1000 --angles 2,1 --until 1/2 --every 1/2";
    for (arguments, warned) in [
        (format!("{lively} --step 1/1024"), true),
        (format!("{lively} --step 1/65536"), false),
        (format!("{lively} --step 1/1024 --method closed-form-f64"), false),
        (String::from("--angles 2,1 --step 1/1024"), false),
        (String::from("--angles 2,1 --step 1/64 --until 1/64 --method rk4-f32"), true),
        (String::from("--gravity 0 --velocities 0,1000 --step 1/1024 --until 0"), true),
    ] {
        let output = simulate(&arguments);
        let report = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !output.stdout.is_empty(), "{arguments}: {report}");
        assert_eq!(report.lines().count(), usize::from(warned), "{arguments}: {report}");
        assert!(!warned || report.starts_with("warning: --step 1/"), "{arguments}: {report}");
    }
}

/// What has been printed until then is right, and is kept.
#[test]
fn a_motion_that_diverges_later_keeps_its_rows_and_fails() {
    let output = simulate("--masses 1,100 --angles 3,2 --step 1/20 --until 10 --method rk4-f32");
    let report = String::from_utf8_lossy(&output.stderr);
    let rows = String::from_utf8_lossy(&output.stdout).lines().count();
    assert_eq!(output.status.code(), Some(1), "{report}");
    assert!(rows > 2 && report.contains(&format!("error: after {} rows: ", rows - 1)), "{rows}: {report}");
}

#[test]
fn decimals_divide_exactly() {
    let rows = rows("--angles 1,1 --step 0.1 --until 10 --every 0.1");
    assert_eq!(rows.len(), 1 + 101);
    assert_eq!(rows[4][0], "0.3");
}
