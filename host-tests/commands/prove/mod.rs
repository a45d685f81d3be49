//! `cargo prove`: a proof that the frames of a chip are accurate until some time.

mod horizon;
mod tables;

pub use tables::{HEADING, horizons, known_answers, moving};

use std::process::ExitCode;
use std::sync::atomic::Ordering;

use clap::{Parser, value_parser};
use double_pendulum::plan::{Problem, Stepping};
use double_pendulum::{Error, Method, Parameter};

use crate::plan::{SceneOptions, no_method, pendulum};
use crate::simulate::StartOptions;
use boards::console::cli::{Refused, choice, complain, say};
use boards::console::number::FEWER_DIGITS;
use boards::console::progress::Progress;
use boards::process::{interrupted, interrupted_by};
use exact::known_answers;
use horizon::{frames, time, words};

const EXAMPLES: &str = "Examples:
  cargo prove --scene page
  cargo prove --angles 120,120 --degrees --method rk4-f32-direction --steps 4

Ctrl-C ends early and prints the proof so far.";

const CSV_HEADING: &str = "t,sin_a1,cos_a1,sin_a2,cos_a2,radius,verdict";

const MOST_STEPS: u32 = 65_536;

/// Proves how long the frames that a chip draws stay within half a pixel of the exact motion. It
/// encloses that motion, rounding errors included, and checks each frame of the planned method,
/// which is bit-identical on every chip.
///
/// The exact motion starts from exactly the decimals and fractions given, or those of --scene.
#[derive(Debug, Parser)]
#[command(name = "cargo prove", after_help = EXAMPLES)]
pub struct ProveOptions {
    /// What moves, and who draws it.
    #[command(flatten)]
    scene: SceneOptions,
    /// Draw with this method instead of the planned one
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(Method::DRAWN.iter().copied(), Method::name),
    )]
    method: Option<Method>,
    /// Steps of that method per frame
    #[arg(
        long,
        value_name = "N",
        requires = "method",
        default_value_t = 1,
        value_parser = value_parser!(u32).range(1..=MOST_STEPS.into()),
    )]
    steps: u32,
    /// Print for each frame the box that encloses the exact motion, and the verdict, as CSV
    #[arg(long)]
    csv: bool,
    /// Print a table of the horizons of all scenes that move on three chips, predicted and proved
    /// (takes a minute or two)
    #[arg(long, conflicts_with_all = ["scene", "method", "csv"])]
    table: bool,
    /// Print the table of known answers, with every digit proved again (takes minutes)
    #[arg(long, conflicts_with_all = ["scene", "method", "csv", "table"])]
    known_answers: bool,
}

/// Prints the proof or a table. Any result of the proof is a success. Ctrl-C ends it with the
/// frames that are proved until then; a table ends at once.
pub fn run(options: &ProveOptions) -> anyhow::Result<ExitCode> {
    if options.table {
        say(HEADING)?;
        for &name in moving() {
            say(horizons(name)?)?;
        }
        return Ok(ExitCode::SUCCESS);
    }

    if options.known_answers {
        say(known_answers::HEADING)?;
        for scene in known_answers::table()?.chunk_by(|one, next| one.scene == next.scene) {
            tables::known_answers(scene)?.iter().try_for_each(say)?;
        }
        return Ok(ExitCode::SUCCESS);
    }

    let (scene, plan) = options.scene.plan().map_err(Refused::because)?;
    let given = options.scene.scene.map_or_else(
        || options.scene.start.clone(),
        |name| StartOptions::of(&name.first_settings()),
    );
    let start = given.exact().ok_or_else(|| {
        Refused::because(format_args!(
            "{}: a number of more than 64 bits cannot be enclosed; {FEWER_DIGITS}",
            given.too_long()
        ))
    })?;

    let asked = options.method.map(|method| Stepping {
        method,
        steps: options.steps,
    });
    options.scene.start.advice().iter().for_each(complain);
    let stepping = match (asked, &plan) {
        (Some(asked), _) => asked,
        (None, Ok(plan)) => plan.stepping(),
        (None, Err(limit)) => {
            let reason = no_method(&scene, *limit, &options.scene.target);
            if options.csv {
                say(CSV_HEADING)?;
                complain(reason);
            } else {
                say(reason)?;
            }
            return Ok(ExitCode::SUCCESS);
        }
    };

    let stopped = interrupted()?;
    let verdicts = frames(&scene, &start, stepping, &stopped)
        .map_err(|error| refused(options, &scene, stepping, &error))?;
    if options.csv {
        say(CSV_HEADING)?;
    }
    let bar = Progress::of("proving", scene.frames().into());
    let mut proved = Vec::new();

    for frame in verdicts {
        bar.advance(1);
        proved.push(frame);
        if options.csv {
            say(frame.row(time(&scene, proved.len() as u32)))?;
        }
    }

    drop(bar);

    if !options.csv {
        if asked.is_none() && options.scene.is_linear() {
            say("scene      shows the linear motion on purpose, not the exact one")?;
        }
        say(format_args!("scene      {}", pendulum(&scene)))?;
        let last = options.scene.end();
        say(words(&scene, &plan, stepping, &proved, last, &stopped))?;
    }

    Ok(interrupted_by(stopped.load(Ordering::Relaxed)))
}

fn refused(
    options: &ProveOptions,
    scene: &Problem,
    Stepping { method, steps }: Stepping,
    error: &Error,
) -> Refused {
    if let Error::TooLarge {
        parameter: Parameter::Dt,
        value,
        limit,
    } = *error
    {
        let rate = scene.rate;
        let least = (f64::from(steps) * value / limit).ceil();
        return Refused::because(if least <= f64::from(MOST_STEPS) {
            format!(
                "--steps {steps}: too few for {method} in a frame of 1/{rate} s; take at \
                 least {least}"
            )
        } else {
            format!(
                "--method {method}: this motion needs more than {MOST_STEPS} steps per frame; take \
                 a higher --rate or another method"
            )
        });
    }
    let reason = options.scene.start.refusal(error, "--method");
    Refused::because(format_args!("{reason}, or leave --method {method} out"))
}
