//! `cargo simulate`: the rows of a board are equal to the host's, and what is said about the rows
//! is true. Digits and bits are in the snapshots.

use boards::BOARDS;
use boards::process::Output;
use clap::Parser;
use host_tests::simulate::{SimulateOptions, choose, plan};

use super::cli::{output, program};

fn simulate(arguments: &str) -> Output {
    output(program("simulate").args(arguments.split_whitespace()))
}

fn options(arguments: &str) -> SimulateOptions {
    let words = std::iter::once("simulate").chain(arguments.split_whitespace());
    SimulateOptions::try_parse_from(words).unwrap_or_else(|error| panic!("{arguments}: {error}"))
}

/// Returns the time and the error of an angle, rad, of each row of a table with the columns t, a1
/// and a2.
fn errors(arguments: &str, table: &str) -> Vec<(f64, f64)> {
    let mut reference = options(arguments).reference();
    let error = |row: &str| {
        let numbers: Vec<f64> = row
            .split(',')
            .map(|number| number.parse().expect("a number"))
            .collect();
        let &[time, a1, a2] = &numbers[..] else {
            panic!("{row}");
        };
        reference.advance_to(time);
        let exact = reference.state();
        (time, (a1 - exact.a1).abs().max((a2 - exact.a2).abs()))
    };
    table.lines().skip(1).map(error).collect()
}

#[test]
fn unequal_rods_with_velocities_have_the_same_bits_on_every_board() {
    let rods = "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 \
        --step 1/256 --seconds 4 --every 1/2 --bits";
    for method in ["rk4-f32", "rk4-fixed32"] {
        let on = |place: &str| {
            let output = simulate(&format!("{rods} --method {method} --board {place}"));
            assert!(output.status.success(), "{place}: {}", output.stderr);
            output.stdout
        };
        let host = on("host");
        assert!(host.lines().count() > 2);
        BOARDS
            .iter()
            .for_each(|board| assert_eq!(on(board.name), host, "{method} on {}", board.name));
    }
}

/// A share, which is less than 1 only for rows that are as accurate as the second run.
const SHORT: f64 = 0.8;
/// The time of two rows, s: the table has fewer digits than the compared numbers.
const ROWS: f64 = 0.02;

/// Each time is when the exact motion of the given decimals leaves the level, or a little earlier.
#[test]
fn the_note_says_until_when_rows_hold() {
    for motion in [
        // The rounding errors of RK4 in the usual steps, of short rods, and of heavy bobs.
        "--seconds 30 --every 0.01",
        "--angles 141.7,169.8 --degrees --lengths 0.216,0.241 --masses 1.22,1 --gravity 9.8 \
         --seconds 9 --every 0.01",
        "--masses 1,1000 --seconds 15 --every 0.01",
        "--masses 1,0.01 --angles 2.5,-3 --velocities 3,-9 --seconds 40 --every 0.01",
        // Balanced straight up, which the rounding of pi sets in motion.
        "--angles 180,-180 --degrees --seconds 20 --every 0.01",
        // Single precision, the linear motion, and the most accurate method, whose errors are those
        // of the given numbers.
        "--seconds 20 --every 0.01 --method rk4-f32",
        "--angles 0.1,0.2 --seconds 30 --every 0.01 --method closed-form-f64",
        "--seconds 40 --every 0.01 --method extrapolation16-f64 --step 1/40",
    ] {
        let arguments = format!("{motion} --columns t,a1,a2");
        let output = simulate(&arguments);
        let errors = errors(&arguments, &output.stdout);
        let end = errors.last().map_or(0.0, |(time, _)| *time);
        let holds = |level: f64| {
            let worst = output
                .stderr
                .rsplit_once("within ")?
                .1
                .split_once(" rad")?
                .0;
            let worst: f64 = worst.parse().ok()?;
            let is_all = output.stderr.contains("every row") || output.stderr.contains("the end");
            (is_all && worst <= level).then_some(end)
        };
        for (level, name) in [(1e-6, "1e-6"), (0.01, "0.01"), (1.0, "1")] {
            let held = errors.iter().take_while(|(_, error)| *error <= level);
            let held = held.last().map_or(0.0, |(time, _)| *time);
            let until = output.stderr.split_once(&format!("within {name} rad"));
            let until = until.and_then(|(_, rest)| rest.split_once("until "));
            let until = until.and_then(|(_, rest)| rest.split_once(" s")?.0.parse().ok());
            let said: f64 = holds(level).or(until).unwrap_or(0.0);
            println!("{motion}: {name} rad until {held} s, said {said}");
            assert!(
                (SHORT * held - ROWS..=held + ROWS).contains(&said),
                "{motion}: {name} rad until {held} s: {}",
                output.stderr
            );
        }
    }
}

const MOTIONS: [&str; 4] = [
    "--angles 0.5,0.5 --seconds 10 --every 1/4",
    "--angles 120,120 --degrees --seconds 5 --every 1",
    "--masses 1,100 --lengths 0.3,1.1 --angles 2,1 --velocities 3,-4 --seconds 2 --every 1/2",
    "--angles 1e-3,-1e-3 --seconds 5 --every 1",
];
/// The places, each with the tolerances to keep, rad.
const PLACES: [(&str, &[f64]); 3] = [
    ("host", &[1e-3, 1e-9, 1e-11]),
    ("lm3s6965evb", &[1e-2, 1e-9]),
    ("stm32f405", &[1e-2, 1e-9]),
];

/// The chosen method in the next smaller number of steps must not keep the tolerance.
#[test]
fn every_row_is_within_the_tolerance_and_longer_steps_are_not() {
    for motion in MOTIONS {
        for (place, tolerances) in PLACES {
            for tolerance in tolerances {
                let case = format!("{motion} --board {place} --tolerance {tolerance:e}");
                let options = options(&case);
                let choice = choose(&options, options.tolerance.as_ref().expect("a tolerance"))
                    .unwrap_or_else(|error| panic!("{case}: {error}"));
                assert!(choice.end.is_none(), "{case}: {choice:?}");
                let error = |parts| {
                    let mut reference = options.reference();
                    let mut row = 0;
                    let mut largest = 0.0_f64;
                    let request = choice.rows.in_parts(&options, choice.request.method, parts);
                    let done = request.readings::<double_pendulum::Error>(|reading| {
                        reference.advance_to(choice.rows.time(row));
                        row += 1;
                        let exact = reference.state();
                        let [a1, a2, ..] = reading.state;
                        largest = largest
                            .max((a1 - exact.a1).abs())
                            .max((a2 - exact.a2).abs());
                        Ok(())
                    });
                    done.map_or(f64::INFINITY, |()| largest)
                };
                let parts = choice.request.stride;
                let found = error(parts);
                println!("{case}: {}, {found:.1e} rad", choice.note);
                assert!(
                    found <= choice.error && choice.error <= *tolerance,
                    "{case}"
                );

                // Fewer steps between rows: three quarters of a power of two, or two thirds of the
                // others.
                let fewer = if parts.is_power_of_two() {
                    3 * parts / 4
                } else {
                    2 * parts / 3
                };
                assert!(fewer == 0 || error(fewer) > *tolerance, "{case}");
            }
        }
    }
}

#[test]
fn a_tolerance_is_kept_by_the_rows_before_its_end() {
    let arguments = "--seconds 30 --every 1 --tolerance 1e-3 --columns t,a1,a2";
    let output = simulate(arguments);
    assert_eq!(output.status.code(), Some(1));
    let errors = errors(arguments, &output.stdout);
    let &(end, _) = errors.last().expect("rows");
    assert!(
        end >= 20.0 && errors.iter().all(|(_, error)| *error <= 1e-3),
        "{errors:?}"
    );
    let reason = format!("--tolerance 1e-3: the rows end at {end} s, because small errors grow");
    assert!(output.stderr.contains(&reason), "{}", output.stderr);
}

/// The step divides the time between rows and is at most the given one, or the default.
#[test]
fn the_step_is_derived() {
    for (arguments, stride, samples) in [
        ("--every 0.3 --seconds 1 --step 0.25", 2, 3),
        ("--every 0.1 --step 1/1024", 103, 100),
        ("--every 1/2 --step 1/256", 128, 20),
        ("--step 0.1 --seconds 0.3", 1, 3),
        ("--every 0.1", 103, 100),
        ("", 103, 100),
        ("--method closed-form-f64 --every 5", 1, 2),
        // A faster motion needs shorter steps, but no more than 2^22 in all.
        ("--masses 1,1000 --seconds 1 --every 1", 61_433, 1),
        ("--masses 1,1e9 --every 10", 1 << 22, 1),
    ] {
        let (request, rows) = plan(&options(arguments)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            (request.stride, request.samples),
            (stride, samples),
            "{arguments}"
        );
        let whole = request.dt * f64::from(stride) / rows.time(1);
        assert!((whole - 1.0).abs() < 4.0 * f64::EPSILON, "{arguments}");
    }
}
