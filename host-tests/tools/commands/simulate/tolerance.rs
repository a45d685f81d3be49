//! The search for the cheapest method and step that meet a tolerance, verified by the reference.
//!
//! The allowed methods and steps are tried in the order of their prices. The first one whose every
//! row is within the tolerance of the double-double reference is the cheapest.

use anyhow::{Context, anyhow, ensure};
use double_pendulum::plan::Stepping;
use double_pendulum::{Equations, Integrator, Method, Numbers, State};
use firmware::config::Processor;
use firmware::job::{ON_BOARDS, Request};

use super::request::{Rows, check, method, refusal};
use super::{Place, SimulateOptions};
use crate::commands::table::at_most;
use console::number::Number;
use console::progress::Progress;

/// The longest run that is tried, in steps.
const MOST_STEPS: u32 = 1 << 19;
/// The largest number of rows. Each row costs the reference a step.
const MOST_ROWS: u32 = 10_000;

/// The cheapest trial within the tolerance or, if there is none, the one that is for the longest
/// time.
#[derive(Debug)]
pub struct Choice {
    /// The motion, until the last row within the tolerance.
    pub request: Request,
    /// The times of its rows.
    pub rows: Rows,
    /// The method, its price and its error, in one line.
    pub note: String,
    /// The largest error of an angle in any row, rad; a missing turn is an error.
    pub error: f64,
    /// The reason why rows are missing, if some are.
    pub end: Option<String>,
}

/// Returns the cheapest method and step that the options allow and that keep `tolerance`, rad, in
/// every row. Every trial is computed on this computer. Prices are cycles on the board of the
/// options, or evaluations of the equations on this computer. An error is one line that names the
/// option and the value.
pub fn choose(options: &SimulateOptions, tolerance: &Number) -> anyhow::Result<Choice> {
    ensure!(
        tolerance.value() > 0.0,
        "--tolerance {tolerance}: must be greater than zero"
    );
    let rows = Rows::of(options)?;
    ensure!(
        rows.samples < MOST_ROWS,
        "--tolerance {tolerance}: at most {MOST_ROWS} rows; take a longer --every"
    );

    // If the kernel refuses the motion in the finest steps, it refuses it in all steps.
    let first = method(options)?;
    let finest = divisions(first, rows.samples).last().unwrap_or(1);
    check(&rows.in_parts(options, first, finest))
        .map_err(|error| anyhow!(refusal(options, &error)))?;

    // The exact motion at each row.
    let exact = exact(options, &rows);

    // All methods and steps, sorted by price.
    let (unit, methods) = candidates(options);
    let trials = methods.into_iter().flat_map(|(method, price)| {
        divisions(method, rows.samples).map(move |parts| (f64::from(parts) * price, method, parts))
    });
    let mut trials: Vec<_> = trials.collect();
    trials.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));

    // The first trial that is accurate in every row is the cheapest one.
    let bar = Progress::of("trials", trials.len() as u64);
    let mut best: Option<(usize, f64, f64, Request)> = None;
    for (price, method, parts) in trials {
        bar.advance(1);
        let request = rows.in_parts(options, method, parts);
        let (within, error) = agreement(&request, &exact, tolerance.value());
        if best.as_ref().is_none_or(|(most, ..)| within > *most) {
            best = Some((within, error, price, request));
        }
        if within == exact.len() {
            break;
        }
    }
    drop(bar);

    let (within, error, price, request) =
        best.filter(|(within, ..)| *within > 0).with_context(|| {
            format!(
                "--tolerance {tolerance}: smaller than the rounding of the start; take a larger one"
            )
        })?;
    let price = price / rows.time(1);
    let Request { method, stride, .. } = request;
    let note = format!(
        "{method}, steps per row: {stride} ({price:.0} {unit} per second of motion); the angles of \
         every row are within {} rad of the exact motion",
        at_most(error)
    );
    let samples = within as u32 - 1;
    let end = (samples < rows.samples).then(|| {
        format!(
            "--tolerance {tolerance}: the rows end at {} s, because {}",
            rows.time(samples),
            limit(&request, rows.samples)
        )
    });
    Ok(Choice {
        request: Request { samples, ..request },
        rows,
        note,
        error,
        end,
    })
}

/// Returns the exact states at the times of the rows.
fn exact(options: &SimulateOptions, rows: &Rows) -> Vec<State<f64>> {
    let bar = Progress::of("reference, rows", rows.samples.into());
    let mut reference = options.reference();
    let state = |row| {
        bar.advance(1);
        reference.advance_to(rows.time(row));
        reference.state()
    };
    (0..=rows.samples).map(state).collect()
}

/// Returns the reason why the best trial of rows ends early.
fn limit(request: &Request, samples: u32) -> String {
    if request.method.integrator() == Integrator::ClosedForm {
        return String::from("the linear motion leaves the exact one");
    }
    let next = divisions(request.method, samples).find(|parts| *parts > request.stride);
    match next {
        Some(_) => String::from(
            "small errors grow, and finer steps or other methods allowed here do not last longer",
        ),
        None => format!("finer steps would be more than {MOST_STEPS} in all"),
    }
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
