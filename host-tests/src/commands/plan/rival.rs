//! A method that the planner does not know: RK4 in `f64`. Would it ever be cheaper?

use double_pendulum::form::DirectionForm;
use double_pendulum::plan::{Method, Plan, PlanError, Problem, ShadowedRun};

use super::study::{Case, spread};
use super::target::Chip;
use crate::commands::table::Table;

/// Of the scenes that were planned in `f64`, those that plain RK4 in `f64` would bring as far for less.
pub fn rk4_in_f64(cases: &[Case], chip: &Chip) -> Result<Table, PlanError> {
    let planned = cases.iter().filter_map(|case| Some((case.scene, case.plan.ok()?)));
    let double: Vec<_> = planned.filter(|(_, plan)| plan.method == Method::Direction8).collect();
    let cheaper = spread(&double, |(scene, plan)| would_do(scene, plan, chip))?;
    let row = vec![double.len().to_string(), cheaper.iter().filter(|&&cheaper| cheaper).count().to_string()];
    Ok(Table {
        name: "rk4-in-f64",
        title: String::from("Plain RK4 in f64, which the planner does not try"),
        note: String::from(
            "Of the scenes planned in f64 by steps of order 8: how many would go as far by plain RK4 in f64 in the \
             direction form, estimated as the planner does, with the most steps that cost less.",
        ),
        columns: vec!["planned in f64", "RK4 cheaper"],
        rows: vec![row],
    })
}

/// Whether RK4 goes as far with as many steps, a power of two, as cost less than the plan's.
fn would_do(scene: &Problem, plan: &Plan, chip: &Chip) -> Result<bool, PlanError> {
    let steps = (plan.cost / chip.rk4_f64) as u32;
    let Some(steps) = steps.checked_ilog2().map(|power| 1 << power) else { return Ok(false) };
    let mut shadowed = ShadowedRun::<f64, DirectionForm<f64>>::new(scene, steps)?;
    let promised = (plan.horizon * f64::from(scene.rate)).round() as u32;
    for _ in 0..promised {
        let (_, estimate) = shadowed.next_frame()?;
        let is_right = estimate.bound() <= 1.0;
        if !is_right {
            return Ok(false);
        }
    }
    Ok(promised > 0)
}
