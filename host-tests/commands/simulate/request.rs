//! The conversion of the options to a request that the kernel accepts, with the times of its rows.

use anyhow::{anyhow, bail, ensure};
use double_pendulum::{Error, Integrator, Method, Motion, Parameter};
use firmware::job::Request;

use super::SimulateOptions;
use super::options::name;
use super::tolerance::methods;
use boards::console::number::Number;

const USUAL_STEP: f64 = 1.0 / 1024.0;
/// The limit for a default step, so that a fast motion takes seconds and not hours.
const MOST_CHOSEN: f64 = (1 << 22) as f64;
const ROWS: u32 = 100;
/// A quotient of two times is rounded by less than this share.
const ROUNDING: f64 = 1e-9;

/// The times of the rows: row n is at n/`parts` times `unit`.
#[derive(Clone, Debug)]
pub struct Rows {
    unit: Number,
    parts: u32,
    pub samples: u32,
}

impl Rows {
    pub fn of(options: &SimulateOptions) -> anyhow::Result<Self> {
        let SimulateOptions {
            seconds,
            every,
            step,
            ..
        } = options;
        ensure!(
            seconds.value() > 0.0,
            "--seconds {seconds}: must be greater than zero"
        );
        // A row for each step, unless the user wants fewer.
        let Some(every) = every.as_ref().or(step.as_ref()) else {
            return Ok(Self {
                unit: seconds.clone(),
                parts: ROWS,
                samples: ROWS,
            });
        };

        let option = if options.every.is_some() {
            "--every"
        } else {
            "--step"
        };
        ensure!(
            every.value() > 0.0,
            "{option} {every}: must be greater than zero"
        );
        let samples = (seconds.value() / every.value() * (1.0 + ROUNDING)).floor();
        ensure!(
            samples >= 1.0,
            "{option} {every}: must not exceed --seconds {seconds}"
        );
        ensure!(
            samples <= f64::from(u32::MAX),
            "{option} {every}: more than {} rows in --seconds {seconds}; take a longer time",
            u32::MAX
        );
        Ok(Self {
            unit: every.clone(),
            parts: 1,
            samples: samples as u32,
        })
    }

    pub fn time(&self, row: u32) -> f64 {
        self.unit.times(row, self.parts)
    }

    fn request(
        &self,
        options: &SimulateOptions,
        method: Method,
        longest: f64,
    ) -> anyhow::Result<Request> {
        let parts = (self.time(1) / longest * (1.0 - ROUNDING)).ceil().max(1.0);
        ensure!(
            parts * f64::from(self.samples) <= f64::from(u32::MAX),
            "--seconds {}: more than {} steps of {longest:.1e} s; take a shorter time",
            options.seconds,
            u32::MAX
        );
        Ok(self.in_parts(options, method, parts as u32))
    }

    pub fn in_parts(&self, options: &SimulateOptions, method: Method, parts: u32) -> Request {
        let (parameters, Motion { a1, a2, w1, w2 }) = options.motion();
        Request {
            method,
            parameters,
            angles: [a1, a2],
            velocities: [w1, w2],
            dt: self.time(1) / f64::from(parts),
            stride: parts,
            samples: self.samples,
        }
    }
}

/// Returns the request of the options, and the times of its rows. The step divides the time between
/// rows. Its default is at most `USUAL_STEP` and short enough for the fastest motion of this
/// energy, if that takes no more than `MOST_CHOSEN` steps.
pub fn plan(options: &SimulateOptions) -> anyhow::Result<(Request, Rows)> {
    let rows = Rows::of(options)?;
    let method = method(options)?;
    if let Some(step) = &options.step {
        ensure!(
            step.value() > 0.0,
            "--step {step}: must be greater than zero"
        );
        let request = rows.request(options, method, step.value())?;
        return match check(&request) {
            Ok(()) => Ok((request, rows)),
            Err(error) => bail!(refusal(options, &error)),
        };
    }

    // The closed form reaches every row in one step.
    if method.integrator() == Integrator::ClosedForm {
        let request = rows.in_parts(options, method, 1);
        check(&request).map_err(|error| anyhow!(refusal(options, &error)))?;
        return Ok((request, rows));
    }

    let usual = USUAL_STEP.min(rows.time(1));
    let start = Request {
        dt: usual,
        ..rows.in_parts(options, method, 1)
    };
    let least = options.seconds.value() / MOST_CHOSEN;
    let safe = start.admissible_step().unwrap_or(usual).max(least);
    let mut longest = usual.min(safe);

    // A method may have a limit of its own.
    let at = |longest| rows.request(options, method, longest);
    if let Err(Error::TooLarge {
        parameter: Parameter::Dt,
        limit,
        ..
    }) = check(&at(longest)?)
    {
        longest = limit * (1.0 - ROUNDING);
    }
    let request = at(longest)?;
    check(&request).map_err(|error| anyhow!(refusal(options, &error)))?;
    Ok((request, rows))
}

pub fn check(request: &Request) -> Result<(), Error> {
    Request {
        samples: 0,
        ..*request
    }
    .readings(|_| Ok(()))
}

pub fn refusal(options: &SimulateOptions, error: &Error) -> String {
    match error {
        Error::Diverged { parameter, value } => format!(
            "the start: {parameter} = {value:?}: out of range; take lower --velocities or --gravity"
        ),
        error => options.start.refusal(error, "--step"),
    }
}

pub fn method(options: &SimulateOptions) -> anyhow::Result<Method> {
    let method = options.method.unwrap_or(Method::ALL[0]);
    ensure!(
        methods(options.place).contains(&method),
        "--method {method}: does not run on {}; --list shows where each method runs",
        name(options.place)
    );
    Ok(method)
}
