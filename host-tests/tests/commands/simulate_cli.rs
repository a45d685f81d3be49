//! `cargo simulate` says what it computes: digits and bits are the same numbers, and a board's rows are the host's.

use host_tests::emulator::boards::BOARDS;

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

/// At the largest angle that is taken, a direction has half of the digits.
#[test]
fn many_turns_at_the_start_keep_the_energy() {
    for (start, digits) in [("67108864,0", 1e-5), ("4096,0 --method rk4-f32", 5e-2)] {
        let rows = rows(&format!("--angles {start} --until 1 --every 1 --columns energy"));
        let energies: Vec<f64> = rows.iter().flatten().filter_map(|energy| energy.parse().ok()).collect();
        let [before, after] = energies[..] else { panic!("{rows:?}") };
        assert!((after - before).abs() < digits * before.abs(), "{start}: {before} {after}");
    }
}

/// Test `verify_board` compares every method, `identity` every step.
#[test]
fn unequal_rods_with_velocities_have_the_same_bits_on_every_board() {
    let rods = "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 --step 1/256 --until 4 --every 1/2 --bits";
    for method in ["rk4-f32", "rk4-fixed32"] {
        let on = |place: &str| simulate(&format!("{rods} --method {method} --on {place}"));
        let host = on("host");
        assert!(host.lines().count() > 2);
        BOARDS.iter().for_each(|board| assert_eq!(on(board.name), host, "{method} on {}", board.name));
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
