//! A study as tables.

use super::study::{Case, median};
use super::target::CHIPS;
use crate::commands::count::ERROR_BAR;
use crate::commands::table::{Table, small};

/// What the predictions are worth, for each chip.
pub fn summary(cases: &[Case]) -> Table {
    let rows = CHIPS.iter().map(|chip| {
        let cases: Vec<&Case> = cases.iter().filter(|case| case.chip == *chip).collect();
        let count = |pick: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| pick(case)).count().to_string();
        let share = |pick: &dyn Fn(&Case) -> bool| {
            format!("{:.2}", median(cases.iter().filter(|case| pick(case)).map(|case| case.share())))
        };
        let costs = cases.iter().filter_map(|case| Some(case.plan.ok()?.cost.into()));
        vec![
            chip.title.to_owned(),
            cases.len().to_string(),
            count(&|case| case.plan.is_err()),
            count(&|case| case.ends_early()),
            count(&|case| case.is_violation()),
            small(cases.iter().map(|case| case.verdict.error).fold(0.0, f64::max)),
            share(&|case| case.plan.is_ok()),
            share(&|case| case.ends_early()),
            format!("{:.0}", median(costs)),
        ]
    });
    Table {
        name: "plans",
        title: String::from("Plans"),
        note: format!(
            "Every scene is planned for each processor, carried out and compared with the reference at each frame. Nothing holds: no \
             method that is affordable is right in any frame. End early: cease to be right to half a pixel within the scene. \
             Violations: scenes with a frame more than half a pixel off before the predicted horizon. Largest error: until then. \
             Predicted: the predicted horizon over the true one in the median, of all scenes with a plan and of those that end early. Cycles: \
             the median. {ERROR_BAR}",
        ),
        columns: vec![
            "processor",
            "scenes",
            "nothing holds",
            "end early",
            "violations",
            "largest error (pixels)",
            "predicted (all)",
            "predicted (ending early)",
            "cycles a frame",
        ],
        rows: rows.filter(|row| row[1] != "0").collect(),
    }
}

/// Every violation, none hidden.
pub fn violations(cases: &[Case]) -> Table {
    let row = |case: &Case| {
        let (pendulum, start, plan) = (case.scene.pendulum, case.scene.start, case.plan.ok()?);
        Some(vec![
            case.number.to_string(),
            case.chip.name.to_owned(),
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
        name: "plan-violations",
        title: String::from("Violations"),
        note: String::from("Scenes in which a frame is more than half a pixel off before the predicted horizon."),
        columns: vec![
            "scene",
            "target",
            "m2/m1",
            "l2/l1",
            "angles (rad)",
            "velocities (rad/s)",
            "method",
            "steps to a frame",
            "predicted (s)",
            "true (s)",
            "largest error (pixels)",
        ],
        rows: cases.iter().filter(|case| case.is_violation()).filter_map(row).collect(),
    }
}
