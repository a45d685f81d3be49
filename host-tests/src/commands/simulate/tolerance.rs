//! The cheapest method and step that keep an error: found by trying, proven by the reference.
//!
//! What may be taken is tried in the order of its price; the first that stays so near to the double-double reference in every
//! row is the cheapest.

use std::fmt;

use anyhow::{bail, ensure};
use double_pendulum::{Integrator, Method, Motion};
use firmware::job::{JobError, Request};

use super::price::candidates;
use super::request::{accepted, count, method, request};
use super::{Number, Plan, SimulateOptions};
use crate::commands::table::small;
use crate::console::progress::Bar;
use reference::taylor::Reference;

/// The longest run that is tried, steps.
const MOST_STEPS: u32 = 1 << 19;
/// The most rows: each costs the reference a step.
const MOST_ROWS: u32 = 10_000;
/// Rows where no time between them is given.
const ROWS: u32 = 100;

/// What was chosen, and its error by the reference.
#[derive(Debug)]
pub struct Choice {
    pub plan: Plan,
    step: Number,
    /// Of a simulated second.
    price: f64,
    unit: &'static str,
    /// How far any angle of any row is from the exact one at most, rad.
    pub error: f64,
}

/// Chooses among all that the options leave open; an error is one line that names the option and the value.
pub fn choose(options: &SimulateOptions, tolerance: &Number) -> anyhow::Result<Choice> {
    let search = Search::new(options, tolerance)?;
    search.check(method(options)?)?;
    let exact = search.exact();
    let mut trials = Vec::new();
    let (unit, methods) = candidates(options);
    for (method, price) in methods {
        trials.extend(search.divisions(method).map(|parts| (f64::from(parts) * price, method, parts)));
    }
    trials.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));

    let bar = Bar::start("trials", trials.len() as u64);
    let mut reached = 0;
    for (price, method, parts) in trials {
        bar.advance(1);
        let (request, step) = search.request(method, parts);
        let (rows, error) = agreement(&request, &exact, tolerance.value());
        if rows == exact.len() {
            let (plan, price) = (Plan { request, every: search.every.clone() }, price / search.every.value());
            return Ok(Choice { plan, step, price, unit, error });
        }
        reached = reached.max(rows);
    }
    let until = search.every.times((reached as u64).saturating_sub(1));
    bail!("--tolerance {tolerance}: nothing that may be taken keeps it beyond {until} s")
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plan, step, price, unit, error } = self;
        let (method, error) = (plan.request.method, small(*error));
        write!(f, "takes {method} in steps of {step} s, {price:.0} {unit} a simulated second: ")?;
        write!(f, "off by {error} rad at most, by the double-double reference")
    }
}

/// Which rows are wanted, and how well.
struct Search<'a> {
    options: &'a SimulateOptions,
    every: Number,
    samples: u32,
}

impl<'a> Search<'a> {
    fn new(options: &'a SimulateOptions, tolerance: &Number) -> anyhow::Result<Self> {
        let SimulateOptions { until, every, .. } = options;
        ensure!(tolerance.is_positive(), "--tolerance {tolerance}: must be greater than zero");
        ensure!(until.is_positive(), "--until {until}: must be greater than zero with --tolerance");
        let every = every.clone().unwrap_or_else(|| until.divided_by(ROWS));
        ensure!(every.is_positive(), "--every {every}: must be greater than zero");
        let samples = count(("--until", until), ("--every", &every))?;
        ensure!(samples < MOST_ROWS, "--every {every}: more than {MOST_ROWS} rows with --tolerance");
        Ok(Self { options, every, samples })
    }

    /// Refuses what the kernel refuses in the finest steps.
    fn check(&self, method: Method) -> anyhow::Result<()> {
        let finest = self.divisions(method).last().unwrap_or(1);
        accepted(self.options, &self.request(method, finest).0)
    }

    /// The motion by `method` in this many steps from row to row, and the step.
    fn request(&self, method: Method, parts: u32) -> (Request, Number) {
        let step = self.every.divided_by(parts);
        (request(self.options, method, &step, parts, self.samples), step)
    }

    /// The numbers of steps from row to row that are tried: 1, 2, 3, 4, 6, 8, 12 and so on; the closed form needs none.
    fn divisions(&self, method: Method) -> impl Iterator<Item = u32> + use<> {
        let most = if method.integrator() == Integrator::ClosedForm { 1 } else { MOST_STEPS / self.samples };
        let powers = (0..u32::BITS - 2).map(|exponent| 1_u32 << exponent);
        powers
            .flat_map(|power| [power, power / 2 * 3])
            .filter(|parts| *parts > 0)
            .take_while(move |parts| *parts <= most)
    }

    /// The angles of every row, rad, by the reference.
    fn exact(&self) -> Vec<[f64; 2]> {
        let start = &self.options.start;
        let ([a1, a2], [w1, w2]) = (start.angles(), start.velocities());
        let mut reference = Reference::new(&start.parameters(), &Motion { a1, a2, w1, w2 });
        let bar = Bar::start("reference, rows", u64::from(self.samples));
        let row = |row| {
            bar.advance(1);
            reference.advance_to(self.every.times(row));
            let Motion { a1, a2, .. } = reference.motion();
            [a1, a2]
        };
        (0..=u64::from(self.samples)).map(row).collect()
    }
}

/// How long a motion stays within `limit`, rad, of the exact one: the rows before the first that is too far off, and the largest
/// error of an angle in them.
fn agreement(request: &Request, exact: &[[f64; 2]], limit: f64) -> (usize, f64) {
    /// It is too far off, or lost.
    struct End;
    impl From<JobError> for End {
        fn from(_: JobError) -> Self {
            End
        }
    }
    let (mut rows, mut largest) = (0, 0.0_f64);
    // Anything that ends the motion ends the agreement.
    let _ = request.readings(|reading| {
        let ([a1, a2, ..], [b1, b2]) = (reading.state, exact.get(rows).ok_or(End)?);
        let apart = (a1 - b1).abs().max((a2 - b2).abs());
        if apart > limit {
            return Err(End);
        }
        (rows, largest) = (rows + 1, largest.max(apart));
        Ok(())
    });
    (rows, largest)
}
