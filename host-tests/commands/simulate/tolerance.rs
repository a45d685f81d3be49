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
use crate::table::at_most;
use boards::console::number::Number;
use boards::console::progress::Progress;

const MOST_STEPS: u32 = 1 << 19;
const MOST_ROWS: u32 = 10_000;

/// The cheapest trial within the tolerance or else the trial that is within it for the longest
/// time.
#[derive(Debug)]
pub struct Choice {
    pub request: Request,
    pub rows: Rows,
    pub note: String,
    /// A missing turn is an error.
    pub error: f64,
    pub end: Option<String>,
}

/// Returns the cheapest method and step that keep the tolerance in every row. Prices are cycles on
/// the board of the options, or evaluations of the equations on this computer.
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

    let exact = exact(options, &rows);

    let (unit, methods) = candidates(options);
    let trials = methods.into_iter().flat_map(|(method, price)| {
        divisions(method, rows.samples).map(move |parts| (f64::from(parts) * price, method, parts))
    });
    let mut trials: Vec<_> = trials.collect();
    trials.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));

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
/// Returns the numbers of steps between rows that are tried. The closed form needs only 1.
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

/// Returns the number of rows within `limit`, rad, of the exact motion, and the largest error of an
/// angle in them. The error includes the rounding of the exact angle.
fn agreement(request: &Request, exact: &[State<f64>], limit: f64) -> (usize, f64) {
    let mut rows = 0;
    let mut largest = 0.0_f64;

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

fn candidates(options: &SimulateOptions) -> (&'static str, Vec<(Method, f64)>) {
    const EVALUATIONS: &str = "evaluations of the equations";
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

pub(super) fn methods(place: Place) -> &'static [Method] {
    if place.is_none() {
        Method::ALL
    } else {
        ON_BOARDS
    }
}

/// Returns the number of evaluations, because the host computes in `f64` as fast as in other
/// numbers. `None` for a method that is as accurate as a cheaper one.
fn on_host(method: Method) -> Option<f64> {
    use Equations::{Directions, Linear};
    use Numbers::{CompensatedF64, F64};
    let is_fast = matches!(
        (method.equations(), method.numbers()),
        (Directions, F64 | CompensatedF64) | (Linear, F64)
    );
    is_fast.then(|| evaluations(method))
}

fn on_board(method: Method, Processor { costs, .. }: &Processor) -> Option<f64> {
    const PRICED: Method = Method::Extrapolation10Fixed64;
    if method.numbers() == Numbers::Fixed64 {
        return Some(f64::from(costs.fixed64) * evaluations(method) / evaluations(PRICED));
    }
    Some(f64::from(costs.of_frame(Stepping { method, steps: 1 }))).filter(|cost| cost.is_finite())
}

/// K^2 + 1 ([`Extrapolation`](double_pendulum::Extrapolation)).
fn evaluations(method: Method) -> f64 {
    match method.integrator() {
        Integrator::ClosedForm => 0.0,
        Integrator::Rk4 => 4.0,
        Integrator::Extrapolation => f64::from(method.order() / 2).powi(2) + 1.0,
    }
}
