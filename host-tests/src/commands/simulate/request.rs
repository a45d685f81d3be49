//! From options to a request that the kernel accepts, and the times of its rows.

use anyhow::{Context, anyhow, bail, ensure};
use double_pendulum::{Error, Method, Motion, Parameter};
use firmware::job::Request;

use super::options::name;
use super::tolerance::methods;
use super::{Number, SimulateOptions, option_of};

/// A checked request and the time from row to row.
#[derive(Debug)]
pub struct Plan {
    pub request: Request,
    /// Row n is at n times this.
    pub every: Number,
    /// What the user should know before the rows.
    pub note: Option<String>,
}

/// Checks everything there is to check before the first row; an error is one line that names the option and the value.
pub fn plan(options: &SimulateOptions) -> anyhow::Result<Plan> {
    let SimulateOptions { step, until, .. } = options;
    let every = options.every.as_ref().unwrap_or(step);
    for (option, time) in [("--step", step), ("--every", every)] {
        ensure!(
            time.is_positive(),
            "{option} {time}: must be greater than zero"
        );
    }
    ensure!(
        until.value() >= 0.0,
        "--until {until}: must not be negative"
    );
    let total = count(("--until", until), ("--step", step))?;
    let stride = count(("--every", every), ("--step", step))?;
    ensure!(
        total % stride == 0,
        "--until {until}: must be a whole multiple of --every {every}"
    );

    let request = request(options, method(options)?, step, stride, total / stride);
    accepted(options, &request)?;
    // Numbers that overflow at once are refused before anything is printed.
    Request {
        stride: 1,
        samples: request.samples.min(1),
        ..request
    }
    .readings(|_| Ok::<_, Error>(()))
    .with_context(|| format!("--step {step}: not even one step can be made"))?;
    let longest = request
        .admissible_step()
        .filter(|longest| request.dt > *longest);
    let note = longest.map(|longest| {
        format!("warning: --step {step}: too long to resolve every motion of this energy; {longest:.1e} s would do")
    });
    Ok(Plan {
        request,
        every: every.clone(),
        note,
    })
}

/// How many times one option's time goes into another's.
pub(super) fn count(
    (option, time): (&str, &Number),
    (unit_option, unit): (&str, &Number),
) -> anyhow::Result<u32> {
    let count = time.whole_multiple_of(unit);
    let count = count.with_context(|| {
        format!("{option} {time}: must be a whole multiple of {unit_option} {unit}")
    })?;
    u32::try_from(count).ok().with_context(|| {
        format!(
            "{option} {time}: more than {} times {unit_option} {unit}",
            u32::MAX
        )
    })
}

/// The motion that the options describe, by `method` in steps of `step`.
pub(super) fn request(
    options: &SimulateOptions,
    method: Method,
    step: &Number,
    stride: u32,
    samples: u32,
) -> Request {
    let (parameters, Motion { a1, a2, w1, w2 }) =
        (options.start.parameters(), options.start.motion());
    let (angles, velocities, dt) = ([a1, a2], [w1, w2], step.value());
    Request {
        method,
        parameters,
        angles,
        velocities,
        dt,
        stride,
        samples,
    }
}

/// Refuses what the kernel refuses, and names its option; and angles that leave the turns more digits than the direction.
pub(super) fn accepted(options: &SimulateOptions, request: &Request) -> anyhow::Result<()> {
    let digits = if request.method.is_single() {
        f32::MANTISSA_DIGITS
    } else {
        f64::MANTISSA_DIGITS
    };
    let limit = f64::powi(2.0, digits as i32 / 2);
    if let Some(angle) = request.angles.into_iter().find(|angle| angle.abs() > limit) {
        let numbers = request.method.numbers();
        bail!(
            "--angles: {angle:?} rad: must not exceed {limit}, beyond which {numbers} has too few digits for a direction"
        );
    }
    Request {
        samples: 0,
        ..*request
    }
    .readings(|_| Ok(()))
    .map_err(|error: Error| match error {
        Error::Diverged {
            parameter: Parameter::Energy,
            ..
        } => {
            anyhow!(
                "--velocities {}: the energy at the start is too large a number",
                options.start.velocities
            )
        }
        error => anyhow!("{}: {error}", option_of(&error, "--step")),
    })
}

/// The method asked for, or the first of the table, if the place asked for computes it.
pub(super) fn method(options: &SimulateOptions) -> anyhow::Result<Method> {
    let method = options.method.unwrap_or(Method::ALL[0]);
    let is_there = methods(options.place).contains(&method);
    ensure!(
        is_there,
        "--method {method}: not on {}; --list says where it runs",
        name(options.place)
    );
    Ok(method)
}
