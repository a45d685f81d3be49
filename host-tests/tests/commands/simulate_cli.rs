//! `cargo simulate` computes what it says: methods agree, energies stay, digits and bits are the same numbers.

use std::f64::consts::PI;
use std::process::Command;

use host_tests::oracle::tolerances;

/// The rows that the command prints, cell by cell, without the header.
fn rows(arguments: &str) -> Vec<Vec<String>> {
    let mut simulate = Command::new(env!("CARGO_BIN_EXE_simulate"));
    let output = simulate.args(arguments.split_whitespace()).output().expect("it runs");
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The numbers of its last row.
fn last(arguments: &str) -> Vec<f64> {
    let number = |text: &String| text.parse().unwrap_or_else(|_| panic!("'{text}' is no number"));
    rows(arguments).last().expect("a row").iter().map(number).collect()
}

/// 113-bit results of `data/known_answers.csv`, scene S4, at t = 5 s.
const FIGURE_7_AT_5: [f64; 4] = [2.639210761945576, 9.313387543618361, 3.230631394279675, 4.470030045274852];

#[test]
fn figure_7_agrees_with_high_precision() {
    let motion = "--masses 1,2.75 --lengths 1,1 --gravity 9.8 --angles 171,171 --degrees";
    let state = last(&format!("{motion} --step 1/4096 --until 5 --every 1 --method rk4-f64"));
    for (found, expected) in state[1..5].iter().zip(FIGURE_7_AT_5) {
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
    let [form, single] = tolerances::FIGURE_7_FORMS;
    assert!(last(&format!("{FIGURE_7} --step 1/4096"))[2] > PI, "it does not turn over");
    for (motion, exact, method, tolerance) in [
        (SMALL, "rk4-f64 --step 1/1024", "rk4-f64-equal-rods --step 1/1024", tolerances::SMALL_SWING),
        (SMALL, "rk4-f64 --step 1/1024", "closed-form-f64 --step 1/1024", tolerances::SMALL_SWING),
        (FIGURE_7, "rk4-f64 --step 1/4096", "rk4-f64-direction --step 1/4096", form),
        (FIGURE_7, "rk4-f64 --step 1/4096", "rk4-fixed32 --step 1/4096", single),
        (FIGURE_7, "rk4-f64 --step 1/4096", "rk4-f32-direction --step 1/4096", single),
        (FIGURE_7, "rk4-f64 --step 1/16384", "extrapolation8-f64 --step 1/512", tolerances::FIGURE_7_ORDER_8),
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
