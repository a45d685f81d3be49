//! `cargo plan`: the cheapest method that draws a scene.

mod options;

pub use options::{CHIPS, Chip, SceneOptions};

use clap::Parser;
use double_pendulum::plan::{Limit, Plan, Problem};
use double_pendulum::{Method, Parameters, Pendulum};
use firmware::config::{HALF_PIXEL, TICK_RATE};

use boards::console::cli::{Refused, complain, say};

const EXAMPLES: &str = "Examples:
  cargo plan --angles 90,90 --degrees --height 64 --seconds 10
  cargo plan --masses 1,2.75 --angles 171,171 --degrees --board stm32f405
  cargo plan --scene figure-7 --board pico";

/// Finds the cheapest method that keeps the picture within half a pixel, and for how long. If the
/// chip is too slow for any, that is the result (exit code 0).
///
/// Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo plan", after_help = EXAMPLES)]
pub struct PlanOptions {
    /// What moves.
    #[command(flatten)]
    scene: SceneOptions,
}

pub fn run(PlanOptions { scene }: &PlanOptions) -> anyhow::Result<()> {
    let (problem, plan) = scene.plan().map_err(Refused::because)?;
    scene.start.advice().iter().for_each(complain);
    if let (true, Ok(plan)) = (scene.is_linear(), &plan) {
        return Ok(linear_words(plan).iter().try_for_each(say)?);
    }
    Ok(words(&problem, &plan, &scene.target, scene.end())
        .iter()
        .try_for_each(say)?)
}

fn words(scene: &Problem, plan: &Result<Plan, Limit>, chip: &Chip, end: &str) -> Vec<String> {
    let frame = chip.processor.budget(scene).frame;
    let mut lines = vec![format!("scene    {}", pendulum(scene))];
    if rests(scene) {
        lines.push("horizon  for ever: the pendulum is at rest, and nothing moves".into());
        return lines;
    }
    lines.extend(match plan {
        Ok(plan) => {
            let share = 100.0 * plan.cost * f32::from(scene.rate) / chip.clock;
            let Plan { horizon, cost, .. } = plan;
            let end = match plan.limit {
                Limit::End => format!(", {end}"),
                _ => String::new(),
            };
            vec![
                format!("method   {}", plan.method),
                format!("step     {}", step(scene, plan)),
                format!(
                    "horizon  expected to stay within half a pixel of the exact motion until \
                     {horizon:.2} s of {} s{end}",
                    scene.duration
                ),
                format!(
                    "error    at most {} expected until then",
                    pixels(HALF_PIXEL * plan.error)
                ),
                format!(
                    "cost     {cost:.0} cycles a frame, {share:.2} % of a {} (estimate)",
                    chip.title
                ),
                format!(
                    "search   the chip finds this plan after {:.1} s of playing",
                    plan.spent / chip.processor.look_ahead / TICK_RATE as f32
                ),
                format!("why      {}", method(plan.method)),
                format!("         {}", limit(plan, frame)),
            ]
        }
        Err(limit) => vec![
            format!("method   none is fast enough for a {}", chip.title),
            format!("why      {}", forbidden(*limit, frame)),
        ],
    });
    lines.extend(energy(scene).map(|line| format!("         {line}")));
    lines
}

pub fn pendulum(scene: &Problem) -> String {
    let Parameters { m1, m2, l1, l2, g } = scene.pendulum;
    let height = 2.0 * f64::from(HALF_PIXEL) * (l1 + l2) / scene.tolerance;
    format!(
        "masses {m1}, {m2} kg; rods {l1}, {l2} m; gravity {g} m/s^2; drawn {height:.0} \
         pixels high"
    )
}

pub fn rests(scene: &Problem) -> bool {
    Pendulum::new(&scene.pendulum)
        .is_ok_and(|pendulum| pendulum.rests(&pendulum.to_state(&scene.start)))
}

fn linear_words(plan: &Plan) -> [String; 3] {
    [
        format!("method   {}", plan.method),
        format!(
            "horizon  leaves the exact motion by half a pixel after {:.2} s",
            plan.horizon
        ),
        String::from("why      this scene shows the linear motion on purpose: nothing is planned"),
    ]
}

/// Rounded up.
fn pixels(error: f32) -> String {
    if error < 1e-3 {
        String::from("a thousandth of a pixel")
    } else {
        format!("{:.3} pixels", (1e3 * error).ceil() / 1e3)
    }
}

fn step(scene: &Problem, plan: &Plan) -> String {
    match plan.steps {
        0 => String::from("none: the closed form computes each frame directly"),
        1 => format!("1/{} s, 1 per frame", scene.rate),
        steps => format!(
            "1/{} s, {steps} per frame",
            u64::from(scene.rate) * u64::from(steps)
        ),
    }
}

fn method(method: Method) -> String {
    let directions = |why| format!("drawing needs only directions, no angles; {why}");
    match method {
        Method::ClosedFormF32 => {
            "until the horizon the linear motion is within half a pixel".into()
        }
        Method::Rk4F32DirectionPlain => directions("the rounding errors of plain sums do not show"),
        Method::Rk4F32Direction => directions("compensated sums keep rounding errors small"),
        Method::Rk4Fixed32 => directions("integers are cheapest here"),
        Method::Extrapolation10Fixed64 => {
            "32-bit methods are too inaccurate, or need so many steps that they cost more".into()
        }
        other => other.name().into(),
    }
}

fn limit(plan: &Plan, frame: f32) -> String {
    match plan.limit {
        Limit::End if plan.steps > 1 => {
            "half as many steps would be too inaccurate, or could miss the fastest motion".into()
        }
        Limit::End => "no cheaper method that was tried stays accurate to the end".into(),
        Limit::Growth => {
            "the motion is chaotic: one frame later, its rounding errors, even of 64 bits, may have \
             grown to half a pixel"
                .into()
        }
        Limit::Budget => format!(
            "errors grow; a method that lasts longer costs more than the {frame:.0} cycles allowed"
        ),
        Limit::Planning => {
            "the budget for planning ended there: later frames may be accurate, too".into()
        }
        other => other.name().into(),
    }
}

fn forbidden(limit: Limit, frame: f32) -> String {
    match limit {
        Limit::Budget => {
            format!("steps fine enough cost more than the {frame:.0} cycles allowed for a frame")
        }
        Limit::Planning => String::from("the time for planning ended before a method was found"),
        other => format!("finer steps are ruled out by {}", other.name()),
    }
}

pub fn no_method(scene: &Problem, limit: Limit, chip: &Chip) -> String {
    let frame = chip.processor.budget(scene).frame;
    let why = forbidden(limit, frame);
    format!("no method is fast enough for a {}: {why}", chip.title)
}

fn energy(scene: &Problem) -> Option<String> {
    let pendulum = Pendulum::new(&scene.pendulum).ok()?;
    let state = pendulum.to_state(&scene.start);

    // An admissible step is a quarter of the time that the fastest motion of this energy takes to
    // turn by a radian.
    let radian = 4.0 * pendulum.admissible_step(&state).ok()?;
    if !radian.is_finite() {
        return Some(String::from("there is no energy, so nothing moves"));
    }
    let turns = if pendulum.cannot_turn_over(&state) {
        "there is not enough energy for a rod to turn over"
    } else {
        "there is enough energy for a rod to turn over"
    };
    Some(format!(
        "{turns}; the rods turn at most {:.0} rad/s",
        (1.0 / radian).ceil()
    ))
}
