//! `cargo simulate` says what it computes: digits and bits are the same numbers, and a board's rows are the host's. What it
//! chooses for a tolerance keeps the error in every row, and costs no more than it must.

use clap::Parser;
use double_pendulum::Motion;
use firmware::job::Request;
use host_tests::commands::simulate::{Plan, SimulateOptions, choose};
use host_tests::emulator::boards::BOARDS;
use reference::taylor;

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

fn chosen(arguments: &str) -> Result<(Plan, f64), String> {
    let words = std::iter::once("simulate").chain(arguments.split_whitespace());
    let options = SimulateOptions::try_parse_from(words).map_err(|error| error.to_string())?;
    let tolerance = options.tolerance.as_ref().ok_or("no tolerance")?;
    choose(&options, tolerance).map_err(|error| format!("{error:#}"))
}

/// The largest error of an angle in any row, rad, by the double-double reference.
fn error(request: &Request) -> Result<f64, double_pendulum::Error> {
    let mut rows = Vec::new();
    request.readings::<double_pendulum::Error>(|reading| {
        rows.push(reading.state);
        Ok(())
    })?;
    let every = f64::from(request.stride) * request.dt;
    let times: Vec<_> = (0..rows.len()).map(|row| row as f64 * every).collect();
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let exact = taylor::states(&request.parameters, &Motion { a1, a2, w1, w2 }, &times);
    let errors = rows.iter().zip(exact).map(|([a1, a2, ..], exact)| (a1 - exact.a1).abs().max((a2 - exact.a2).abs()));
    Ok(errors.fold(0.0, f64::max))
}

/// Times of rows are multiples of the step here, and of the time between rows there.
const ROUNDING: f64 = 1.01;

const MOTIONS: [&str; 6] = [
    "--angles 0.5,0.5 --until 10 --every 1/4",
    "--angles 2,2 --until 5 --every 1/2",
    "--angles 120,120 --degrees --until 5 --every 1",
    "--angles 171,171 --degrees --masses 1,2.75 --until 3 --every 1/2",
    "--masses 1,100 --lengths 0.3,1.1 --angles 2,1 --velocities 3,-4 --until 2 --every 1/2",
    "--angles 1e-3,-1e-3 --until 5 --every 1",
];
const PLACES: [(&str, &[f64]); 3] =
    [("host", &[1e-3, 1e-6, 1e-9, 1e-11]), ("lm3s6965evb", &[1e-2, 1e-4, 1e-9]), ("stm32f405", &[1e-2, 1e-4, 1e-9])];

#[test]
fn every_row_is_within_the_tolerance_and_no_longer_step_would_do() -> Result<(), Box<dyn std::error::Error>> {
    for motion in MOTIONS {
        for (place, tolerances) in PLACES {
            for tolerance in tolerances {
                let case = format!("{motion} --on {place} --tolerance {tolerance:e}");
                let (Plan { request, note, .. }, told) = chosen(&case)?;
                let found = error(&request)?;
                println!("{case}: {note:?}, {found:.1e} rad");
                assert!(found <= told * ROUNDING && told <= *tolerance, "{case}: {found:e} rad");
                // One of three steps, or two of three, from row to row fewer.
                let fewer =
                    if request.stride.is_power_of_two() { 3 * request.stride / 4 } else { 2 * request.stride / 3 };
                let longer = request.dt * f64::from(request.stride) / f64::from(fewer);
                if let (1.., Ok(error)) = (fewer, error(&Request { dt: longer, stride: fewer, ..request })) {
                    assert!(error > *tolerance, "{case}: {error:e} rad with {longer} s");
                }
            }
        }
    }
    Ok(())
}

#[test]
fn the_cheapest_serves_where_it_is_right() -> Result<(), String> {
    for (case, method) in [
        // The cubic term of the exact motion comes to (1e-4)^3 w t/16.
        ("--angles 1e-4,1e-4 --until 1 --tolerance 1e-12", "closed-form-f64"),
        ("--angles 0.5,0.5 --until 1 --tolerance 1e-3 --method textbook-f32", "textbook-f32"),
        ("--angles 0.5,0.5 --until 1 --tolerance 1e-3 --method extrapolation16-f64", "extrapolation16-f64"),
        ("--angles 0.5,0.5 --until 1 --tolerance 1e-3 --on lm3s6965evb", "rk4-fixed32"),
        ("--angles 0.5,0.5 --until 1 --tolerance 1e-3 --on stm32f405", "rk4-f32-direction-plain"),
        ("--angles 0.5,0.5 --until 1 --tolerance 1e-3 --method rk4-f64 --on stm32f405", "rk4-f64"),
        ("--angles 0.5,0.5 --until 10 --tolerance 1e-9 --on stm32f405 --every 1/4", "extrapolation12-fixed64"),
    ] {
        assert_eq!(chosen(case)?.0.request.method.to_string(), method, "{case}");
    }
    Ok(())
}
