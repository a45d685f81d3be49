//! `cargo simulate`, whose digits and bits are in the snapshots. The rows of a board are equal to
//! the host's. The method that is chosen for a tolerance keeps the error in every row and costs no
//! more than necessary.

use clap::Parser;
use double_pendulum::{Integrator, Method, Motion};
use emulator::boards::BOARDS;
use firmware::job::Request;
use host_tests::commands::simulate::{Plan, SimulateOptions, choose, plan};
use reference::taylor;

use super::cli::{output, program};

/// Returns the output of a `cargo simulate` that succeeds.
fn simulate(arguments: &str) -> String {
    let output = output(program("simulate").args(arguments.split_whitespace()));
    assert!(output.status.success(), "{arguments}: {}", output.stderr);
    output.stdout
}

/// `cargo simulate --bits` prints the same text on the host and on every board, for two methods.
/// The test `verify_board` compares every method, and `identity` every step.
#[test]
fn unequal_rods_with_velocities_have_the_same_bits_on_every_board() {
    let rods = "--masses 2,0.5 --lengths 0.3,1.1 --velocities 3,-4 \
        --step 1/256 --until 4 --every 1/2 --bits";
    for method in ["rk4-f32", "rk4-fixed32"] {
        let on = |place: &str| simulate(&format!("{rods} --method {method} --on {place}"));
        let host = on("host");
        assert!(host.lines().count() > 2);
        BOARDS
            .iter()
            .for_each(|board| assert_eq!(on(board.name), host, "{method} on {}", board.name));
    }
}

/// Returns the plan that `--tolerance` chooses and its largest error, rad, or the refusal.
fn chosen(arguments: &str) -> Result<(Plan, f64), String> {
    let words = std::iter::once("simulate").chain(arguments.split_whitespace());
    let options = SimulateOptions::try_parse_from(words).map_err(|error| error.to_string())?;
    let tolerance = options.tolerance.as_ref().ok_or("no tolerance")?;
    choose(&options, tolerance).map_err(|error| format!("{error:#}"))
}

/// Returns the largest error of an angle in any row, rad, by the double-double reference.
fn error(request: &Request) -> Result<f64, double_pendulum::Error> {
    let mut rows = Vec::new();
    request.readings::<double_pendulum::Error>(|reading| {
        rows.push(reading.state);
        Ok(())
    })?;
    let every = f64::from(request.stride) * request.dt;

    // Evaluate the reference at the times of the rows.
    let times = (0..rows.len()).map(|row| row as f64 * every);
    let [a1, a2] = request.angles;
    let [w1, w2] = request.velocities;
    let exact = taylor::states(&request.parameters, &Motion { a1, a2, w1, w2 }, times);
    let errors = rows
        .iter()
        .zip(exact)
        .map(|([a1, a2, ..], exact)| (a1 - exact.a1).abs().max((a2 - exact.a2).abs()));
    Ok(errors.fold(0.0, f64::max))
}

/// The allowed ratio of the errors: the times of rows are multiples of the step in one computation,
/// and of the time between rows in the other.
const ROUNDING: f64 = 1.01;

/// The motions to choose a method for.
const MOTIONS: [&str; 6] = [
    "--angles 0.5,0.5 --until 10 --every 1/4",
    "--angles 2,2 --until 5 --every 1/2",
    "--angles 120,120 --degrees --until 5 --every 1",
    "--angles 171,171 --degrees --masses 1,2.75 --until 3 --every 1/2",
    "--masses 1,100 --lengths 0.3,1.1 --angles 2,1 --velocities 3,-4 --until 2 --every 1/2",
    "--angles 1e-3,-1e-3 --until 5 --every 1",
];
/// The places, each with the tolerances to keep, rad.
const PLACES: [(&str, &[f64]); 3] = [
    ("host", &[1e-3, 1e-6, 1e-9, 1e-11]),
    ("lm3s6965evb", &[1e-2, 1e-4, 1e-9]),
    ("stm32f405", &[1e-2, 1e-4, 1e-9]),
];

/// For each motion, place and tolerance, the chosen method keeps the tolerance in every row, and
/// the reported error is the true one or larger ([`ROUNDING`] is allowed). The same method in the
/// next smaller number of steps does not keep it.
#[test]
fn every_row_is_within_the_tolerance_and_longer_steps_are_not()
-> Result<(), Box<dyn std::error::Error>> {
    for motion in MOTIONS {
        for (place, tolerances) in PLACES {
            for tolerance in tolerances {
                let case = format!("{motion} --on {place} --tolerance {tolerance:e}");
                let (Plan { request, note, .. }, reported) = chosen(&case)?;
                let found = error(&request)?;
                println!("{case}: {note:?}, {found:.1e} rad");
                assert!(
                    found <= reported * ROUNDING && reported <= *tolerance,
                    "{case}: {found:e} rad"
                );

                // Fewer steps between rows: three quarters of a power of two, or two thirds of the
                // others.
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

/// Returns the plan of a command line without `--tolerance`.
fn planned(arguments: &str) -> Result<Plan, Box<dyn std::error::Error>> {
    let words = std::iter::once("simulate").chain(arguments.split_whitespace());
    Ok(plan(&SimulateOptions::try_parse_from(words)?)?)
}

/// The step, without `--step`, divides the time between rows and is the longest that is at most
/// 1/1024 s and admissible. A step twice as long would exceed one of these. There is no warning.
#[test]
fn the_default_step_is_the_longest_that_divides_the_rows() -> Result<(), Box<dyn std::error::Error>>
{
    const USUAL: f64 = 1.0 / 1024.0;

    for (arguments, stride) in [
        ("--every 0.1", 103),
        ("--every 0.01", 11),
        ("--every 1/2", 512),
        ("--every 5/2", 2560),
        ("--every 1/4096", 1),
        ("--until 1 --every 1/3", 342),
        // The default is a hundred rows.
        ("", 103),
        ("--until 0", 11),
        ("--method closed-form-f64 --every 5", 1),
    ] {
        let Plan {
            request,
            every,
            note,
        } = planned(arguments)?;
        // The step divides the time between rows.
        let whole = request.dt * f64::from(request.stride) / every.value();
        assert!((whole - 1.0).abs() < 4.0 * f64::EPSILON, "{arguments}");
        assert_eq!((request.stride, note), (stride, None), "{arguments}");
        let is_closed = request.method.integrator() == Integrator::ClosedForm;
        assert!(is_closed || request.dt <= USUAL, "{arguments}");
    }

    // The step is shorter if the method or the fastest motion of the energy needs it.
    for arguments in [
        "--masses 1,1000 --until 1",
        "--masses 1,1000 --until 1 --method extrapolation12-f64",
        "--lengths 1e-8,1 --until 1/1024",
        "--method rk4-fixed32 --masses 1,100 --angles 3,3 --until 1",
    ] {
        let Plan { request, note, .. } = planned(arguments)?;
        let safe = request.admissible_step().unwrap_or(0.0);
        assert!(
            request.dt <= safe && note.is_none(),
            "{arguments}: {request:?}"
        );
        let halved = 2.0 * request.dt;
        assert!(halved > safe.min(USUAL), "{arguments}: {request:?}");
    }

    Ok(())
}

/// Motions with the energy of their velocities, from positions that change the velocities fast.
const FAST: [&str; 5] = [
    "--angles 0.3,-0.2 --velocities 0,30",
    "--angles 0,0.1 --velocities 20,-40 --masses 1,100",
    "--angles 1,0 --velocities -10,10 --masses 1,10 --lengths 1,0.5",
    "--angles 0,1.5 --velocities 50,-60 --masses 1,0.1",
    "--angles 0.1,3.1 --velocities 30,30 --masses 1,30 --lengths 1,3",
];

/// The error of RK4's longest step that causes no warning, rad: 0.0072/4^5
/// ([`Pendulum::admissible_step`](double_pendulum::Pendulum::admissible_step)).
const SAFE_STEP_ERROR: f64 = 7.2e-6;
/// The roundings of an angle in one step, rad.
const ROUNDINGS: f64 = 1e-13;

/// For five fast motions and five methods, the longest step 1/N s that is admissible causes no
/// warning, and the next longer one does. Without a warning, RK4's error in a step is at most
/// [`SAFE_STEP_ERROR`], and the error of the other methods is at most RK4's. The steps of a
/// tolerance cause no warning.
#[test]
fn the_warning_of_a_long_step_depends_on_the_order_of_the_method()
-> Result<(), Box<dyn std::error::Error>> {
    let methods = [
        Method::Rk4F64,
        Method::Extrapolation8Fixed64,
        Method::Extrapolation10Fixed64,
        Method::Extrapolation12F64,
        Method::Extrapolation16F64,
    ];

    for motion in FAST {
        let mut rk4 = 0.0;
        for method in methods {
            let case = format!("{motion} --method {method}");
            let safe = planned(&case)?.request.admissible_step().ok_or("no step")?;
            // The longest step without a warning, and the next longer one.
            for (steps, is_warned) in [((1.0 / safe).ceil(), false), ((1.0 / safe).floor(), true)] {
                let step = format!("--step 1/{steps} --until 1/{steps}");
                let Plan { request, note, .. } = planned(&format!("{case} {step}"))?;
                let found = error(&request)?;
                println!("{case} {step}: {found:.1e} rad");
                assert_eq!(note.is_some(), is_warned, "{case}: {note:?}");

                // RK4's error is bounded, and no other method exceeds it.
                let limit = if method.integrator() == Integrator::Rk4 {
                    rk4 = found;
                    SAFE_STEP_ERROR
                } else {
                    ROUNDINGS.max(rk4)
                };
                assert!(is_warned || found <= limit, "{case}: {found:e} rad");
            }
        }
    }

    // The steps that --tolerance chooses here, and those for smaller tolerances down to the last
    // digit, cause no warning.
    for (motion, step) in [("120,120", "1/24"), ("120,120", "1/64"), ("2,2", "1/16")] {
        let degrees = if motion == "2,2" { "" } else { "--degrees" };
        let case =
            format!("--angles {motion} {degrees} --method extrapolation16-fixed64 --step {step}");
        assert_eq!(planned(&format!("{case} --until 1"))?.note, None, "{case}");
    }

    Ok(())
}
