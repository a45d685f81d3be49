//! A study as tables.

use double_pendulum::Error;
use double_pendulum::plan::{Limit, Method, Plan};

use super::study::{Case, Class, median};
use super::target::Chip;
use crate::commands::count::ERROR_BAR;
use crate::commands::table::{Table, small};

/// What the promises are worth, and what planning saves, for each class of scene.
pub fn classes(cases: &[Case], chip: &Chip) -> Result<Table, Error> {
    let mut rows = Vec::new();
    for class in Class::ALL {
        let mut within = Vec::new();
        for case in cases {
            if Class::of(&case.scene)? == class {
                within.push(case);
            }
        }
        rows.push(row(class.name(), &within, chip));
    }
    rows.push(row("all", &cases.iter().collect::<Vec<_>>(), chip));
    Ok(Table {
        name: "plans-by-class",
        title: format!("Plans for a {}: {} scenes", chip.title, cases.len()),
        note: format!(
            "Every scene is planned, carried out and compared with the reference at each frame. Broken: more than half a \
             pixel off before the promised horizon. Promised: the promised horizon over the true one in the median, over \
             all scenes and over those whose true horizon is within the scene. Cycles of a frame are medians, where anything \
             holds. {ERROR_BAR} Always f64: the same steps by RK4 in f64. Always finest: compensated f32 direction form at the \
             finest step that any scene of the class is planned with in f32.",
        ),
        columns: vec![
            "scenes",
            "number",
            "nothing holds",
            "right to their end",
            "broken",
            "largest error (pixels)",
            "promised (all)",
            "promised (ending early)",
            "cycles a frame",
            "always f64",
            "always finest f32",
        ],
        rows,
    })
}

fn row(name: &str, cases: &[&Case], chip: &Chip) -> Vec<String> {
    let plans: Vec<Plan> = cases.iter().filter_map(|case| case.plan.ok()).collect();
    let finest = plans.iter().filter(|plan| plan.method != Method::Fixed64).map(|plan| plan.steps).max();
    let share = |early: bool| {
        let shares = cases.iter().filter(|case| !early || case.ends_early()).map(|case| case.share());
        format!("{:.2}", median(shares))
    };
    let cycles = |of: &dyn Fn(&Plan) -> f32| format!("{:.0}", median(plans.iter().map(|plan| of(plan).into())));
    vec![
        name.to_owned(),
        cases.len().to_string(),
        (cases.len() - plans.len()).to_string(),
        plans.iter().filter(|plan| plan.limit == Limit::End).count().to_string(),
        cases.iter().filter(|case| !case.is_kept()).count().to_string(),
        small(cases.iter().map(|case| case.verdict.error).fold(0.0, f64::max)),
        share(false),
        share(true),
        cycles(&|plan| plan.cost),
        cycles(&|plan| chip.rk4_f64 * plan.steps.max(1) as f32),
        cycles(&|_| chip.processor.costs.of_frame(Method::Direction, finest.unwrap_or(1).max(1))),
    ]
}

/// Every broken promise, none hidden.
pub fn broken(cases: &[Case]) -> Table {
    let row = |case: &Case| {
        let (pendulum, start, plan) = (case.scene.pendulum, case.scene.start, case.plan.ok()?);
        Some(vec![
            case.number.to_string(),
            format!("{:.3e}", pendulum.mass_ratio()),
            format!("{:.3e}", pendulum.l2 / pendulum.l1),
            format!("{:.3} {:.3}", start.a1, start.a2),
            format!("{:.3} {:.3}", start.w1, start.w2),
            plan.method.name().replace(',', ";"),
            plan.steps.to_string(),
            format!("{:.2}", plan.horizon),
            format!("{:.2}", case.verdict.horizon),
            small(case.verdict.error),
        ])
    };
    Table {
        name: "broken-promises",
        title: String::from("Broken promises"),
        note: String::from("Scenes in which a frame is more than half a pixel off before the promised horizon."),
        columns: vec![
            "scene",
            "m2/m1",
            "l2/l1",
            "angles (rad)",
            "velocities (rad/s)",
            "method",
            "steps to a frame",
            "promised (s)",
            "true (s)",
            "largest error (pixels)",
        ],
        rows: cases.iter().filter(|case| !case.is_kept()).filter_map(row).collect(),
    }
}
