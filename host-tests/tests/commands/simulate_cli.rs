//! `cargo simulate`, whose digits and bits the snapshots show: a board's rows are the host's. What it chooses for a tolerance keeps the
//! error in every row, and costs no more than it must.

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

/// Test `verify_board` compares every method, `identity` every step.
#[test]
fn unequal_rods_with_velocities_have_the_same_bits_on_every_board() {
    let rods = "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 --step 1/256 --until 4 --every 1/2 --bits";
    for method in ["rk4-f32", "rk4-fixed32"] {
        let on = |place: &str| simulate(&format!("{rods} --method {method} --on {place}"));
        let host = on("host");
        assert!(host.lines().count() > 2);
        BOARDS
            .iter()
            .for_each(|board| assert_eq!(on(board.name), host, "{method} on {}", board.name));
    }
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
    let times = (0..rows.len()).map(|row| row as f64 * every);
    let ([a1, a2], [w1, w2]) = (request.angles, request.velocities);
    let exact = taylor::states(&request.parameters, &Motion { a1, a2, w1, w2 }, times);
    let errors = rows
        .iter()
        .zip(exact)
        .map(|([a1, a2, ..], exact)| (a1 - exact.a1).abs().max((a2 - exact.a2).abs()));
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
const PLACES: [(&str, &[f64]); 3] = [
    ("host", &[1e-3, 1e-6, 1e-9, 1e-11]),
    ("lm3s6965evb", &[1e-2, 1e-4, 1e-9]),
    ("stm32f405", &[1e-2, 1e-4, 1e-9]),
];

#[test]
fn every_row_is_within_the_tolerance_and_no_longer_step_would_do()
-> Result<(), Box<dyn std::error::Error>> {
    for motion in MOTIONS {
        for (place, tolerances) in PLACES {
            for tolerance in tolerances {
                let case = format!("{motion} --on {place} --tolerance {tolerance:e}");
                let (Plan { request, note, .. }, told) = chosen(&case)?;
                let found = error(&request)?;
                println!("{case}: {note:?}, {found:.1e} rad");
                assert!(
                    found <= told * ROUNDING && told <= *tolerance,
                    "{case}: {found:e} rad"
                );
                // One of three steps, or two of three, from row to row fewer.
                let fewer = if request.stride.is_power_of_two() {
                    3 * request.stride / 4
                } else {
                    2 * request.stride / 3
                };
                let longer = request.dt * f64::from(request.stride) / f64::from(fewer);
                if let (1.., Ok(error)) = (
                    fewer,
                    error(&Request {
                        dt: longer,
                        stride: fewer,
                        ..request
                    }),
                ) {
                    assert!(error > *tolerance, "{case}: {error:e} rad with {longer} s");
                }
            }
        }
    }
    Ok(())
}
