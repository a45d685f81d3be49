//! From options to a request that the kernel accepts, and the times of its rows.

use anyhow::{Context, anyhow, ensure};
use firmware::job::{Job, JobError, Request};
use firmware::protocol::Field;

use super::{Method, Number, Options, on_host, order8};

/// A checked request and the time from row to row.
#[derive(Debug)]
pub struct Plan {
    /// What to compute.
    pub request: Request,
    /// Row n is at n times this.
    pub every: Number,
    /// How its steps are made.
    pub method: Method,
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
    let steps = |option, time: &Number| {
        let count = time
            .whole_multiple_of(step)
            .with_context(|| format!("{option} {time}: must be a whole multiple of --step {step}"))?;
        u32::try_from(count).with_context(|| format!("{option} {time}: more than {} steps", u32::MAX))
    };
    let total = steps("--until", until)?;
    let stride = steps("--every", every)?;
    ensure!(total % stride == 0, "--until {until}: must be a whole multiple of --every {every}");

    let Options { arithmetic, model, .. } = *options;
    let form = options.form.or_else(|| Job::default_form(arithmetic, model));
    let form =
        form.with_context(|| format!("--arithmetic {}: not with --model {}", arithmetic.name(), model.name()))?;
    let request = Request {
        arithmetic,
        model,
        form,
        parameters: options.start.parameters(),
        angles: options.start.angles(),
        velocities: options.start.velocities(),
        dt: step.value(),
        stride,
        samples: total / stride,
    };
    Job::new(&request).map_err(|error| match error {
        JobError::NoSuchForm(form) => {
            let [form, arithmetic, model] = [form.name(), arithmetic.name(), model.name()];
            anyhow!("--form {form}: not with --arithmetic {arithmetic} and --model {model}")
        }
        JobError::Refused(error) => anyhow!("{}: {error}", option_of(error.into())),
    })?;
    if options.method == Method::Order8 {
        order8::check(options, form)?;
    }
    let plan = Plan { request, every: every.clone(), method: options.method };
    // Numbers that overflow at once are refused before anything is printed.
    let first_step = Request { stride: 1, samples: request.samples.min(1), ..request };
    on_host(&Plan { request: first_step, every: every.clone(), method: options.method }, |_| Ok(()))
        .with_context(|| format!("--step {step}: not even one step can be made"))?;
    Ok(plan)
}

/// The option that sets a field of the request.
fn option_of(field: Field) -> &'static str {
    match field {
        Field::Arithmetic => "--arithmetic",
        Field::Model => "--model",
        Field::Form => "--form",
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
