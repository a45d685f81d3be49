//! From options to a request that the kernel accepts, and the times of its rows.

use anyhow::{Context, anyhow, bail, ensure};
use double_pendulum::{Error, Parameter};
use firmware::job::{JobError, ON_BOARDS, Request, Row};
use firmware::protocol::Field;

use super::price::rows;
use super::{Number, Options, Place};

/// A checked request and the time from row to row.
#[derive(Debug)]
pub struct Plan {
    /// What to compute.
    pub request: Request,
    /// Row n is at n times this.
    pub every: Number,
}

impl Plan {
    /// What the user should know: the step is too long for some motion of this energy.
    pub fn warning(&self, options: &Options) -> Option<String> {
        let admissible = self.request.admissible_step()?;
        let too_long = self.request.dt > admissible;
        too_long.then(|| {
            let step = &options.step;
            format!("--step {step}: too long to resolve every motion of this energy; {admissible:.1e} s would do")
        })
    }
}

/// Checks everything there is to check before the first row; an error is one line that names the option and the value.
pub fn plan(options: &Options) -> anyhow::Result<Plan> {
    let Options { step, until, .. } = options;
    let every = options.every.as_ref().unwrap_or(step);
    for (option, time) in [("--step", step), ("--every", every)] {
        ensure!(time.is_positive(), "{option} {time}: must be greater than zero");
    }
    ensure!(!until.is_negative(), "--until {until}: must not be negative");
    let total = count(("--until", until), ("--step", step))?;
    let stride = count(("--every", every), ("--step", step))?;
    ensure!(total % stride == 0, "--until {until}: must be a whole multiple of --every {every}");

    let request = request(options, row(options)?, step, stride, total / stride);
    accepted(options, &request)?;
    // Numbers that overflow at once are refused before anything is printed.
    Request { stride: 1, samples: request.samples.min(1), ..request }
        .readings(|_| Ok::<_, JobError>(()))
        .with_context(|| format!("--step {step}: not even one step can be made"))?;
    Ok(Plan { request, every: every.clone() })
}

/// How many times one option's time goes into another's.
pub(super) fn count((option, time): (&str, &Number), (unit_option, unit): (&str, &Number)) -> anyhow::Result<u32> {
    let count = time
        .whole_multiple_of(unit)
        .with_context(|| format!("{option} {time}: must be a whole multiple of {unit_option} {unit}"))?;
    u32::try_from(count)
        .ok()
        .with_context(|| format!("{option} {time}: more than {} times {unit_option} {unit}", u32::MAX))
}

/// The motion that the options describe, by `row` in steps of `step`.
pub(super) fn request(options: &Options, row: Row, step: &Number, stride: u32, samples: u32) -> Request {
    let start = &options.start;
    Request {
        row,
        parameters: start.parameters(),
        angles: start.angles(),
        velocities: start.velocities(),
        dt: step.value(),
        stride,
        samples,
    }
}

/// Refuses what the kernel refuses, and names its option; and angles that leave the turns more digits than the direction.
pub(super) fn accepted(options: &Options, request: &Request) -> anyhow::Result<()> {
    let arithmetic = request.row.arithmetic;
    let digits = if arithmetic.is_single() { f32::MANTISSA_DIGITS } else { f64::MANTISSA_DIGITS };
    let limit = f64::powi(2.0, digits as i32 / 2);
    if let Some(angle) = request.angles.into_iter().find(|angle| angle.abs() > limit) {
        let name = arithmetic.name();
        bail!(
            "--angles: {angle:?} rad: must not exceed {limit}, beyond which {name} has too few digits for a direction"
        );
    }
    Request { samples: 0, ..*request }.readings(|_| Ok(())).map_err(|error: JobError| match error {
        JobError::NoSuchRow(_) => anyhow!("{error}"),
        JobError::Refused(Error::Diverged { parameter: Parameter::Energy, .. }) => {
            anyhow!("--velocities {}: the energy at the start is too large a number", options.start.velocities)
        }
        JobError::Refused(error) => anyhow!("{}: {error}", option_of(error.into())),
    })
}

/// The first row of the table that has all that is asked for, if the place asked for computes it.
pub(super) fn row(options: &Options) -> anyhow::Result<Row> {
    let wanted = options.wanted();
    let rows: Vec<_> = rows(Place::Host).collect();
    let row = wanted.first_of(&rows).map_err(|field| {
        let words = [
            (Field::Arithmetic, wanted.arithmetic.map(|word| word.name().to_owned())),
            (Field::Model, wanted.model.map(|word| word.name().to_owned())),
            (Field::Form, wanted.form.map(|word| word.name().to_owned())),
            (Field::Integrator, wanted.integrator.map(|word| word.name().to_owned())),
            (Field::Order, wanted.order.map(|order| order.to_string())),
        ];
        let given = |(field, word): &(Field, Option<String>)| Some(format!("{} {}", option_of(*field), word.as_ref()?));
        let wrong = words.iter().filter(|(one, _)| *one == field).find_map(given).unwrap_or_default();
        let before: Vec<_> = words.iter().take_while(|(one, _)| *one != field).filter_map(given).collect();
        if before.is_empty() {
            anyhow!("{wrong}: there is none such")
        } else {
            anyhow!("{wrong}: not with {}", before.join(" "))
        }
    })?;
    match options.place {
        Place::Board(board) if !ON_BOARDS.contains(&row) => bail!("--on {}: boards do not compute {row}", board.name),
        _ => Ok(row),
    }
}

/// The option that sets a field of the request.
fn option_of(field: Field) -> &'static str {
    match field {
        Field::Arithmetic => "--arithmetic",
        Field::Model => "--model",
        Field::Form => "--form",
        Field::Integrator => "--integrator",
        Field::Order => "--order",
        Field::M1 | Field::M2 => "--masses",
        Field::L1 | Field::L2 => "--lengths",
        Field::G => "--gravity",
        Field::A1 | Field::A2 => "--angles",
        Field::W1 | Field::W2 => "--velocities",
        Field::Dt => "--step",
        // What only a command has.
        other => other.name(),
    }
}
