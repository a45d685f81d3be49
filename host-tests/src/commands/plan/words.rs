//! A plan in words.

use double_pendulum::Pendulum;
use double_pendulum::plan::{Limit, Method, Plan, Problem};

use super::target::Chip;

/// The plan with its reasons, a line each.
pub fn words(scene: &Problem, plan: &Plan, chip: &Chip) -> Vec<String> {
    let budget = chip.budget(scene.rate, 1.0);
    let share = |cycles: f32| 100.0 * cycles * f32::from(scene.rate) / chip.clock;
    let mut lines = vec![
        format!("way      {}", plan.way.name()),
        format!("step     {}", step(scene, plan)),
        format!("error    {:.1e} pixels expected until the horizon", plan.error),
        format!(
            "cost     {:.0} cycles a frame, {:.2} % of a {} (estimate)",
            plan.cycles,
            share(plan.cycles),
            chip.title
        ),
        format!("horizon  right to half a pixel until {:.2} s of {} s", plan.horizon, scene.duration),
        format!("looked   ahead at a cost of {:.2} s of the chip", plan.planning / chip.clock),
    ];
    lines.push(format!("why      {}", way(scene, plan)));
    lines.push(format!("         {}", limit(plan, budget.frame)));
    lines.extend(energy(scene).map(|line| format!("         {line}")));
    lines
}

fn step(scene: &Problem, plan: &Plan) -> String {
    match plan.steps {
        0 => String::from("none: every frame is computed by itself"),
        1 => format!("1/{} s, one to a frame", scene.rate),
        steps => format!("1/{} s, {steps} to a frame", u64::from(scene.rate) * u64::from(steps)),
    }
}

fn way(scene: &Problem, plan: &Plan) -> String {
    let rods = if scene.pendulum.l1 == scene.pendulum.l2 { "equal" } else { "unequal" };
    match plan.way {
        Method::ClosedForm => String::from("until the horizon the linear motion is right to half a pixel"),
        Method::DirectionPlain => {
            format!("no angle is needed to draw, nor are carried roundings; {rods} rods cost alike")
        }
        Method::Direction => {
            format!("no angle is needed to draw, but the roundings must be carried; {rods} rods cost alike")
        }
        Method::Angle => String::from("the direction form loses more than steps on the angles do"),
        Method::Direction8 => String::from("the roundings of f32 would show before; in f64 order 8 is cheapest"),
        other => other.name().to_owned(),
    }
}

fn limit(plan: &Plan, frame: f32) -> String {
    match plan.limit {
        Limit::End => String::from("coarser steps and cheaper arithmetic would be seen, finer and costlier would not"),
        Limit::Growth => String::from("errors grow until they show, in f64 as well; nothing here goes farther"),
        Limit::Budget => {
            format!("errors grow until they show; what goes farther costs more than the {frame:.0} cycles allowed")
        }
        Limit::Planning => String::from("nobody has looked farther: see --planning"),
        other => other.name().to_owned(),
    }
}

/// What the proven bounds say.
fn energy(scene: &Problem) -> Option<String> {
    let pendulum = Pendulum::new(scene.pendulum).ok()?;
    let state = pendulum.to_state(&scene.start);
    let turns = if pendulum.cannot_turn_over(&state) { "no rod can turn over" } else { "a rod may turn over" };
    let step = pendulum.admissible_step(&state).ok()?;
    Some(format!("by its energy {turns}, and steps of 1/{:.0} s resolve its liveliest motion", (1.0 / step).ceil()))
}
