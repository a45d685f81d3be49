//! The conversion of the options to a request that the kernel accepts, with the times of its rows.

use anyhow::{Context, anyhow, bail, ensure};
use double_pendulum::{Error, Integrator, Method, Motion, Parameter};
use firmware::job::Request;

use super::SimulateOptions;
use super::options::name;
use super::tolerance::methods;
use console::number::{FEWER_DIGITS, Number};

/// A checked request and the time between rows.
#[derive(Debug)]
pub struct Plan {
    /// The motion, accepted by the kernel in its first step.
    pub request: Request,
    /// The time between rows, s: row n is at n times this.
    pub every: Number,
    /// A note for the user, which the caller prints before the rows; one line without a newline.
    pub note: Option<String>,
}

/// The longest step, s, that is chosen by default.
const USUAL_STEP: f64 = 1.0 / 1024.0;
/// The largest number of steps of a motion for which the default step is shortened to be safe.
const MOST_CHOSEN: f64 = (1 << 22) as f64;
/// The number of rows if neither a step nor a time between rows is given.
const ROWS: u32 = 100;

/// The times of a motion: the step, the time between rows in seconds and in steps, and the number
/// of rows after the first.
struct Timing {
    step: Number,
    every: Number,
    stride: u32,
    samples: u32,
}

/// Checks the options of the motion before the first row, and computes the first step on this
/// computer. It uses the step of the options, or else chooses one; the tolerance and the file are
/// not considered. A time of the last row of 0 gives the start only. A step of the options that may
/// be too long for the motion is no error, but causes a note.
///
/// The chosen step is as in [`SimulateOptions::step`]. But the closed form makes one step for each
/// row. It is an error if a fast motion needs more than 2^22 safe steps in all.
///
/// An error is one line that names the option and the value. It is an error if that time is
/// negative or another time is not greater than zero, if it is no whole multiple of the time
/// between rows, or the latter none of the step, if there are more than 2^32 - 1 steps, or if the
/// place does not have the method. It is also an error if the kernel refuses the motion, if its
/// first step diverges, or if an angle exceeds 2^26 rad, in single precision 2^12 rad.
pub fn plan(options: &SimulateOptions) -> anyhow::Result<Plan> {
    let until = &options.until;
    ensure!(
        until.value() >= 0.0,
        "--until {until}: must not be negative"
    );
    let method = method(options)?;
    let timing = match &options.step {
        Some(step) => given(options, step)?,
        None => chosen(options, method)?,
    };
    let Timing {
        step,
        every,
        stride,
        samples,
    } = timing;

    // The kernel decides whether the motion can be computed.
    let request = request(options, method, &step, stride, samples);
    accepted(options, &request)?;
    check_first_step(options, &request)?;

    // A given step that is too long for the fastest motion is a warning only, because this motion
    // may be slow.
    let longest = request
        .admissible_step()
        .filter(|longest| options.step.is_some() && request.dt > *longest);
    let note = longest.map(|longest| {
        format!(
            "warning: --step {step}: may be too long for the fastest motion possible at this \
             energy; {} is safe",
            at_most(longest)
        )
    });
    Ok(Plan {
        request,
        every,
        note,
    })
}

/// Returns the times if a step is given.
fn given(options: &SimulateOptions, step: &Number) -> anyhow::Result<Timing> {
    let until = &options.until;
    // A row for each step, unless the user wants fewer.
    let every = options.every.as_ref().unwrap_or(step);
    for (option, time) in [("--step", step), ("--every", every)] {
        ensure!(
            time.is_positive(),
            "{option} {time}: must be greater than zero"
        );
    }
    let total = count(("--until", until), ("--step", step))?;
    let stride = count(("--every", every), ("--step", step))?;
    ensure!(
        total % stride == 0,
        "--until {until}: must be a whole multiple of --every {every}"
    );
    Ok(Timing {
        step: step.clone(),
        every: every.clone(),
        stride,
        samples: total / stride,
    })
}

/// Chooses the longest step that divides the time between rows, is at most [`USUAL_STEP`], and
/// resolves every motion of this energy. It is an error if that takes too many steps.
fn chosen(options: &SimulateOptions, method: Method) -> anyhow::Result<Timing> {
    let until = &options.until;
    // Without `--every`, the rows divide the time into `ROWS` parts.
    let every = match &options.every {
        Some(every) => every.clone(),
        None if until.is_positive() => until.divided_by(ROWS),
        None => Number::one().divided_by(ROWS),
    };
    ensure!(
        every.is_positive(),
        "--every {every}: must be greater than zero"
    );
    check_parts(options, &every)?;
    let samples = count(("--until", until), ("--every", &every))?;

    // Returns the request, and its step, with this number of steps between rows.
    let in_parts = |parts: u32| {
        let step = if parts == 1 {
            every.clone()
        } else {
            every.divided_by(parts)
        };
        (request(options, method, &step, parts, samples), step)
    };

    // The closed form reaches every row in one step.
    if method.integrator() == Integrator::ClosedForm {
        return Ok(Timing {
            step: every.clone(),
            every,
            stride: 1,
            samples,
        });
    }

    // The longest step that the method accepts, and the longest safe step.
    let usual = Request {
        dt: USUAL_STEP.min(every.value()),
        samples: 0,
        ..in_parts(1).0
    };
    let limit = match usual.readings(|_| Ok::<_, Error>(())) {
        Err(Error::TooLarge {
            parameter: Parameter::Dt,
            limit,
            ..
        }) => limit * (1.0 - f64::EPSILON),
        _ => USUAL_STEP,
    };
    let safe = usual
        .admissible_step()
        .filter(|safe| *safe > 0.0) // It is 0 if the square of a rate overflows.
        .map_or(limit, |safe| safe.min(limit));

    // The number of steps between rows.
    let [parts, least] = [safe, limit].map(|longest| (every.value() / longest).ceil());
    let rows = f64::from(samples.max(1));
    if least * rows > f64::from(u32::MAX) {
        bail!(too_many(options, samples, limit));
    }

    // A fast motion that takes long is computed only if the user chooses the step.
    let total = parts * rows;
    if parts > least && total > MOST_CHOSEN {
        // If the kernel refuses the motion in any step, report its reason instead.
        let longest = Request {
            dt: limit.min(every.value()),
            ..usual
        };
        accepted(options, &longest)?;
        let (number, remedy) = if total <= f64::from(u32::MAX) {
            let step = every.divided_by(parts as u32);
            (
                format!("{total}"),
                format!(", or wait for it with --step {step} --every {every}"),
            )
        } else {
            (format!("more than {}", u32::MAX), String::new())
        };
        bail!(
            "{}: this fast motion needs {number} steps of at most {}; take a shorter \
             --until{remedy}",
            options.start.extreme(),
            at_most(safe)
        );
    }

    let stride = parts as u32;
    let (_, step) = in_parts(stride);
    Ok(Timing {
        step,
        every,
        stride,
        samples,
    })
}

/// Returns the refusal of a motion of more than 2^32 - 1 steps of at most `limit`, s, in `samples`
/// rows. If the motion needs steps shorter than [`USUAL_STEP`], the line names the option with the
/// most extreme number. Otherwise it names the time that is too long.
fn too_many(options: &SimulateOptions, samples: u32, limit: f64) -> String {
    let until = &options.until;
    let step = at_most(limit);
    if limit < USUAL_STEP {
        return format!(
            "{}: this fast motion needs steps of at most {step}, too many for --until {until}; \
             take a shorter --until",
            options.start.extreme()
        );
    }

    // The longest time, in whole rows.
    let most = f64::from(u32::MAX);
    let (option, time, longest) = match &options.every {
        None => {
            let rows = f64::from(samples);
            ("--until", until, (most / rows).floor() * rows * limit)
        }
        Some(every) => match (most / (every.value() / limit).ceil()).floor() {
            0.0 => ("--every", every, most * limit),
            rows => ("--until", until, every.times(rows as u64)),
        },
    };
    format!(
        "{option} {time}: more than {} steps of {step}; take at most {}",
        u32::MAX,
        at_most(longest)
    )
}

/// Returns an error if numbers overflow in the first step, before anything is printed.
fn check_first_step(options: &SimulateOptions, request: &Request) -> anyhow::Result<()> {
    const SHORTER: f64 = 1e-6;
    // Computes the first step only, with the step `dt`.
    let first = |dt: f64| {
        let request = Request {
            dt,
            stride: 1,
            samples: request.samples.min(1),
            ..*request
        };
        request.readings(|_| Ok::<_, Error>(()))
    };
    let Err(error) = first(request.dt) else {
        return Ok(());
    };

    // If a much shorter step succeeds, the step is to blame. Otherwise the motion itself is.
    match (&options.step, first(SHORTER * request.dt)) {
        (Some(step), Ok(())) => bail!("--step {step}: too long for the first step: {error}"),
        _ => bail!(
            "{}: the first step leaves the range of {}; take less extreme values",
            options.start.extreme(),
            request.method
        ),
    }
}

/// Returns a time of at most `limit`, s, as a short text with the unit: three decimals from 0.1 s
/// on ("0.125 s"), a fraction from 1e-6 s on ("1/1024 s"), or else two digits with an exponent. Not
/// checked: `limit` is positive and finite.
pub(super) fn at_most(limit: f64) -> String {
    const LONG: f64 = 0.1;
    const SHORT: f64 = 1e-6;
    if limit >= LONG {
        return format!("{} s", (1e3 * limit).floor() / 1e3);
    }
    if limit >= SHORT {
        return format!("1/{} s", (1.0 / limit).ceil());
    }
    let power = limit.log10().floor();
    let digits = (10.0 * limit / 10_f64.powf(power)).floor() / 10.0;
    format!("{digits}e{power} s")
}

/// Refuses a time of the last row if there is no `--every`, and the time between rows that follows
/// from it, `every`, is not exact in 64 bits.
pub(super) fn check_parts(options: &SimulateOptions, every: &Number) -> anyhow::Result<()> {
    let until = &options.until;
    ensure!(
        options.every.is_some() || until.exact().is_none() || every.exact().is_some(),
        "--until {until}: a hundredth of it is not exact in 64 bits; write fewer digits, or give \
         --every"
    );
    Ok(())
}

/// Returns how many times `unit` is in `time`, computed exactly. The error, which names both
/// options and their values, means that this is not a whole number from 0 to 2^32 - 1, or that
/// `unit` is zero. It names one of them if its exact value is unknown ([`Number::exact`]).
pub(super) fn count(
    (option, time): (&str, &Number),
    (unit_option, unit): (&str, &Number),
) -> anyhow::Result<u32> {
    for (option, number) in [(option, time), (unit_option, unit)] {
        ensure!(
            number.exact().is_some(),
            "{option} {number}: a number of more than 64 bits is not exact; {FEWER_DIGITS}"
        );
    }
    let count = time.whole_multiple_of(unit);
    count
        .and_then(|count| u32::try_from(count).ok())
        .with_context(|| {
            let parts = (time.value() / unit.value()).ceil();
            if parts > f64::from(u32::MAX) {
                let most = u32::MAX;
                return format!(
                    "{option} {time}: at most {most} times {unit_option} {unit}; take a longer \
                     {unit_option}"
                );
            }

            // The remedy is a step that divides the time between rows.
            let remedy = if option == "--every" && (1.0..1e9).contains(&parts) {
                format!("; take --step {}", time.divided_by(parts as u32))
            } else {
                String::new()
            };
            format!("{option} {time}: must be a whole multiple of {unit_option} {unit}{remedy}")
        })
}

/// Returns a request for the motion that the options describe, by `method` in steps of `step`, s. A
/// row is `stride` steps after the one before; `samples` rows follow the first. Nothing is checked.
pub(super) fn request(
    options: &SimulateOptions,
    method: Method,
    step: &Number,
    stride: u32,
    samples: u32,
) -> Request {
    let parameters = options.start.parameters();
    let Motion { a1, a2, w1, w2 } = options.start.motion();
    let angles = [a1, a2];
    let velocities = [w1, w2];
    let dt = step.value();
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

/// Returns an error, one line, for angles, rad, whose whole turns need more digits than the
/// direction has left in the numbers of the method: more than 2^26 rad, in single precision 2^12
/// rad.
// Half of the digits of a number are for the turns, the other half for the direction.
pub fn check_turns(angles: [f64; 2], method: Method) -> anyhow::Result<()> {
    let digits = if method.is_single() {
        f32::MANTISSA_DIGITS
    } else {
        f64::MANTISSA_DIGITS
    };
    let limit = f64::powi(2.0, digits as i32 / 2);

    if let Some(angle) = angles.into_iter().find(|angle| angle.abs() > limit) {
        let numbers = method.numbers();
        bail!(
            "--angles: {angle:?} rad: must not exceed {limit}, beyond which {numbers} has too few \
             digits for a direction; subtract whole turns"
        );
    }
    Ok(())
}

/// Returns an error for everything that the kernel refuses, with the option's name, and for angles
/// whose whole turns need more digits than the direction has left: more than 2^26 rad, in single
/// precision 2^12 rad. No step is computed.
pub(super) fn accepted(options: &SimulateOptions, request: &Request) -> anyhow::Result<()> {
    check_turns(request.angles, request.method)?;

    // A request without samples is checked and computes nothing.
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
                "{}: the energy at the start is too large for the numbers of this method; take \
                 smaller values",
                options.start.extreme()
            )
        }
        Error::TooLarge {
            parameter: Parameter::Dt,
            limit,
            ..
        } => match &options.step {
            Some(step) if options.until.value() / limit <= f64::from(u32::MAX) => anyhow!(
                "--step {step}: too long for {} here; at most {}",
                request.method,
                at_most(limit)
            ),
            _ => anyhow!(
                "{}: this fast motion needs steps of at most {}",
                options.start.extreme(),
                at_most(limit)
            ),
        },
        error => anyhow!(options.start.refusal(&error, "--step")),
    })
}

/// Returns the method of the options, or the first of the table (`rk4-f64`) without one. It is an
/// error if the place of the options cannot compute it.
pub(super) fn method(options: &SimulateOptions) -> anyhow::Result<Method> {
    let method = options.method.unwrap_or(Method::ALL[0]);
    // A board has fewer methods than the host.
    let is_there = methods(options.place).contains(&method);
    ensure!(
        is_there,
        "--method {method}: does not run on {}; --list shows where each method runs",
        name(options.place)
    );
    Ok(method)
}
