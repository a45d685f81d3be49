//! A way that the planner does not know: RK4 in `f64`. Would it ever be cheaper?

use double_pendulum::Error;
use double_pendulum::form::DirectionForm;
use double_pendulum::plan::{HALF_PIXEL, Method, ShadowedRun};

use super::study::{Case, spread};
use super::target::Chip;
use crate::commands::table::Table;

/// Of the scenes that were planned in `f64`, those that plain RK4 in `f64` would bring as far for less.
pub fn rk4_in_f64(cases: &[Case], chip: &Chip) -> Result<Table, Error> {
    let double: Vec<_> = cases.iter().filter(|case| case.plan.way == Method::Direction8).collect();
    let cheaper = spread(&double, |case| would_do(case, chip))?;
    let row = vec![double.len().to_string(), cheaper.iter().filter(|&&cheaper| cheaper).count().to_string()];
    Ok(Table {
        name: "rk4-in-f64",
        title: String::from("Plain RK4 in f64, which the planner does not try"),
        note: String::from(
            "Of the scenes planned in f64 by steps of order 8: how many would go as far by plain RK4 in f64 in the frame \
             form, judged as the planner does, with the most steps that cost less.",
        ),
        columns: vec!["planned in f64", "RK4 cheaper"],
        rows: vec![row],
    })
}

/// Whether RK4 goes as far with as many steps, a power of two, as cost less than the plan's.
fn would_do(case: &Case, chip: &Chip) -> Result<bool, Error> {
    let steps = (case.plan.cycles / chip.rk4_f64) as u32;
    let Some(steps) = steps.checked_ilog2().map(|power| 1 << power) else { return Ok(false) };
    let mut judged = ShadowedRun::<f64, DirectionForm<f64>>::new(&case.scene, steps)?;
    let promised = (case.plan.horizon * f64::from(case.scene.rate)).round() as u32;
    for _ in 0..promised {
        let (_, doubt) = judged.next_frame()?;
        let is_right = doubt.bound() <= HALF_PIXEL;
        if !is_right {
            return Ok(false);
        }
    }
    Ok(promised > 0)
}
