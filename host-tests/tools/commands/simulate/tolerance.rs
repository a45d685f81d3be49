//! The search for the cheapest method and step that meet a tolerance, verified by the reference.
//!
//! The allowed methods and steps are tried in the order of their prices. The first one whose every
//! row is within the tolerance of the double-double reference is the cheapest.

use anyhow::{Context, bail, ensure};
use double_pendulum::plan::Stepping;
use double_pendulum::{Equations, Integrator, Method, Numbers, State};
use firmware::config::Processor;
use firmware::job::{ON_BOARDS, Request};
use reference::taylor;

use super::request::{accepted, check_parts, count, method, request};
use super::{Place, Plan, SimulateOptions};
use crate::commands::table::at_most;
use console::number::Number;
use console::progress::Progress;

/// The longest run that is tried, in steps.
const MOST_STEPS: u32 = 1 << 19;
/// The largest number of rows. Each row costs the reference a step.
const MOST_ROWS: u32 = 10_000;
/// The number of rows if no time between rows is given.
const ROWS: u32 = 100;

/// Returns the cheapest method and step that the options allow and that keep `tolerance`, rad, in
/// every row. The second value is the largest error of an angle in any row, rad; a missing turn is
/// an error. Prices are cycles on the board of the options, or evaluations of the equations on this
/// computer. Without a method in the options, only methods with a price are tried; a method in the
/// options that has none is priced by its evaluations. Every trial is computed on this computer,
/// which may take minutes. The time between rows is in the options, or else it is a hundredth of
/// the time of the last row. The note of the plan names the choice.
///
/// An error is one line that names the option and the value. It is an error if the tolerance or a
/// time is not greater than zero, if the time of the last row is no whole multiple of the time
/// between rows, if there are more than 10,000 rows, if the place does not have the method, if the
/// kernel refuses the motion or an angle is too large ([`plan`](super::plan)), or if no method
/// meets the tolerance in at most 2^19 steps. A step in the options is ignored.
pub fn choose(options: &SimulateOptions, tolerance: &Number) -> anyhow::Result<(Plan, f64)> {
    // The times of the rows.
    let SimulateOptions { until, every, .. } = options;
    ensure!(
        tolerance.is_positive(),
        "--tolerance {tolerance}: must be greater than zero"
    );
    ensure!(
        until.is_positive(),
        "--until {until}: must be greater than zero with --tolerance"
    );
    let every = every.clone().unwrap_or_else(|| until.divided_by(ROWS));
    ensure!(
        every.is_positive(),
        "--every {every}: must be greater than zero"
    );
    check_parts(options, &every)?;
    let samples = count(("--until", until), ("--every", &every))?;
    ensure!(
        samples < MOST_ROWS,
        "--every {every}: at most {MOST_ROWS} rows with --tolerance; take a longer --every"
    );

    // The request for the motion with this number of steps between rows, and the step.
    let in_parts = |method, parts| {
        let step = every.divided_by(parts);
        (request(options, method, &step, parts, samples), step)
    };

    // If the kernel refuses the motion in the finest steps, it refuses it in all steps.
    let first_method = method(options)?;
    accepted(
        options,
        &in_parts(
            first_method,
            divisions(first_method, samples).last().unwrap_or(1),
        )
        .0,
    )?;

    // The exact motion at each row.
    let bar = Progress::of("reference, rows", samples.into());
    let times = (0..=samples.into())
        .map(|row| every.times(row))
        .inspect(|_| bar.advance(1));
    let exact = taylor::states(&options.start.parameters(), &options.start.motion(), times);
    drop(bar);

    // All methods and steps, sorted by price.
    let (unit, methods) = candidates(options);
    let trials = methods.into_iter().flat_map(|(method, price)| {
        divisions(method, samples).map(move |parts| (f64::from(parts) * price, method, parts))
    });
    let mut trials: Vec<_> = trials.collect();
    trials.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));

    // The first trial that is accurate in every row is the cheapest one.
    let bar = Progress::of("trials", trials.len() as u64);
    let mut reached = 0;

    for (price, method, parts) in trials {
        bar.advance(1);
        let (request, step) = in_parts(method, parts);
        let (rows, error) = agreement(&request, &exact, tolerance.value());
        if rows == exact.len() {
            let price = price / every.value();
            let worst = at_most(error);
            let note = format!(
                "using {method}, step {step} s ({price:.0} {unit} per second of motion); \
                 largest error {worst} rad (measured, for the nearest f64 numbers)"
            );
            return Ok((
                Plan {
                    request,
                    every,
                    note: Some(note),
                },
                error,
            ));
        }
        reached = reached.max(rows);
    }

    // The best trial was accurate for this time.
    let until = every.times((reached as u64).saturating_sub(1));
    bail!(
        "--tolerance {tolerance}: no allowed method stays within it beyond {until} s; take a \
         shorter --until or a larger tolerance"
    )
}

/// Returns the numbers of steps between rows that are tried: 1, 2, 3, 4, 6, 8, 12 and so on. The
/// closed form needs only 1.
fn divisions(method: Method, samples: u32) -> impl Iterator<Item = u32> {
    let most = if method.integrator() == Integrator::ClosedForm {
        1
    } else {
        MOST_STEPS / samples
    };
    let powers = (0..u32::BITS - 2).map(|exponent| 1_u32 << exponent);
    let all = powers
        .flat_map(|power| [power, power / 2 * 3])
        .filter(|parts| *parts > 0);
    all.take_while(move |parts| *parts <= most)
}

/// Returns the time for which a motion stays within `limit`, rad, of the exact motion, as a number
/// of rows, and the largest error of an angle in these rows. The first row that exceeds the limit
/// ends the comparison.
///
/// The error includes the rounding of the exact angle, at most half a unit of its last place.
fn agreement(request: &Request, exact: &[State<f64>], limit: f64) -> (usize, f64) {
    let mut rows = 0;
    let mut largest = 0.0_f64;

    // An error of the motion also ends the comparison.
    let _ = request.readings::<anyhow::Error>(|reading| {
        let [a1, a2, ..] = reading.state;
        let exact = exact.get(rows).context("no more rows")?;
        let error = |a: f64, exact: f64| (a - exact).abs() + 0.5 * f64::EPSILON * exact.abs();
        let apart = error(a1, exact.a1).max(error(a2, exact.a2));
        ensure!(apart <= limit, "too far off");
        rows += 1;
        largest = largest.max(apart);
        Ok(())
    });
    (rows, largest)
}

/// Returns the unit of the prices, and the methods that the options allow with their prices. The
/// prices depend on the place. If the place has no price for any of the methods, a price is the
/// number of evaluations of the equations.
fn candidates(options: &SimulateOptions) -> (&'static str, Vec<(Method, f64)>) {
    const EVALUATIONS: &str = "evaluations of the equations";
    // The methods of the place, or the one method that the user selects.
    let left = methods(options.place).iter().copied();
    let left = left.filter(|method| options.method.is_none_or(|asked| asked == *method));
    let price = |method| {
        options.place.map_or(on_host(method), |board| {
            on_board(method, &board.processor())
        })
    };
    let priced: Vec<_> = left
        .clone()
        .filter_map(|method| Some((method, price(method)?)))
        .collect();

    // Without any price, the evaluations decide.
    match priced.is_empty() {
        true => (
            EVALUATIONS,
            left.map(|method| (method, evaluations(method))).collect(),
        ),
        false => (
            options.place.map_or(EVALUATIONS, |_| "cycles (estimate)"),
            priced,
        ),
    }
}

/// Returns the methods that the place can compute: [`Method::ALL`] on the host, [`ON_BOARDS`] on
/// every board.
pub(super) fn methods(place: Place) -> &'static [Method] {
    if place.is_none() {
        Method::ALL
    } else {
        ON_BOARDS
    }
}

/// Returns the price of a method on the host: the number of evaluations, because the host computes
/// in `f64` as fast as in other numbers. Returns `None` for methods that are never the best,
/// because another method is as accurate and costs less.
fn on_host(method: Method) -> Option<f64> {
    use Equations::{Directions, Linear};
    use Numbers::{CompensatedF64, F64};
    let is_fast = matches!(
        (method.equations(), method.numbers()),
        (Directions, F64 | CompensatedF64) | (Linear, F64)
    );
    is_fast.then(|| evaluations(method))
}

/// Returns the price of a method on a board, from the board's price list. The price of a 64-bit
/// fixed-point step of another order is proportional to its evaluations.
fn on_board(method: Method, Processor { costs, .. }: &Processor) -> Option<f64> {
    const PRICED: Method = Method::Extrapolation10Fixed64;
    if method.numbers() == Numbers::Fixed64 {
        return Some(f64::from(costs.fixed64) * evaluations(method) / evaluations(PRICED));
    }
    Some(f64::from(costs.of_frame(Stepping { method, steps: 1 }))).filter(|cost| cost.is_finite())
}

/// Returns the number of evaluations of the equations in a step. Extrapolation of order 2 K takes
/// K^2 + 1 ([`Extrapolation`](double_pendulum::Extrapolation)).
fn evaluations(method: Method) -> f64 {
    match method.integrator() {
        Integrator::ClosedForm => 0.0,
        Integrator::Rk4 => 4.0,
        Integrator::Extrapolation => f64::from(method.order() / 2).powi(2) + 1.0,
    }
}
