//! The table of cost and error of every method and of the programs in C.

use anyhow::Result;
use double_pendulum::{Integrator, Method};
use rayon::prelude::*;

use super::accuracy::{
    self, Error, LONG, ReportedMotion, SAMPLES, SCENES, rates, request, usual_rate,
};
use super::c_peers;
use crate::count::{StepCost, Target, affordable_cost};
use crate::table::{Table, small};
use boards::Board;
use boards::console::progress::Progress;
use boards::toolchain::Toolchain;

const FINEST: u32 = 13;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub name: &'static str,
    pub scene: &'static ReportedMotion,
    /// The cost was counted on the core of this board.
    pub board: &'static Board,
    pub rate: u32,
    pub step: StepCost,
    pub error: Error,
}

impl Point {
    /// Per simulated second.
    pub fn cycles(&self) -> f64 {
        f64::from(self.rate) * self.step.cycles
    }

    /// Returns true if another point of the same scene and board is no worse in cycles and error,
    /// and better in one of them.
    pub fn is_dominated(&self, points: &[Self]) -> bool {
        let error = self.error.angle;
        let cycles = self.cycles();
        let mut others = points
            .iter()
            .filter(|other| other.board == self.board && other.scene == self.scene);
        others.any(|other| {
            let other_error = other.error.angle;
            let other_cycles = other.cycles();
            other_cycles <= cycles
                && other_error <= error
                && (other_cycles < cycles || other_error < error)
        })
    }
}

/// Returns the points of every method and of every program in C, through the scenes on all targets.
/// The closed forms are left out, because their error comes from the linear equations.
pub fn join(toolchain: &Toolchain, targets: &[Target]) -> Result<(Vec<Point>, Vec<String>)> {
    let scenes = [&SCENES[0], &SCENES[1], &LONG]
        .map(|scene| (scene, accuracy::exact(scene, SAMPLES * scene.duration)));
    let methods = Method::ALL
        .iter()
        .copied()
        .filter(|method| method.integrator() != Integrator::ClosedForm);
    let methods: Vec<_> = methods.collect();
    let bar = Progress::of("comparing and counting", methods.len() as u64);
    let points = methods.par_iter().map(|&method| {
        let cost =
            |target| affordable_cost(target, &request(method, &SCENES[0], usual_rate(method)));
        let costs = targets
            .iter()
            .map(|target| Ok((target.board, cost(target)?)))
            .collect::<Result<Vec<_>>>()?;

        let mut points = Vec::new();
        for &(scene, ref exact) in &scenes {
            for rate in rates(method, scene, FINEST) {
                let Some(error) = accuracy::error(&request(method, scene, rate), exact) else {
                    continue;
                };
                let name = method.name();
                let point = |&(board, step)| Point {
                    name,
                    scene,
                    board,
                    rate,
                    step,
                    error,
                };
                points.extend(costs.iter().map(point));
            }
        }
        bar.advance(1);
        Ok(points)
    });
    let mut points = points.collect::<Result<Vec<_>>>()?.concat();

    let (peers, absent) = c_peers::points(toolchain, targets, &scenes)?;
    points.extend(peers);
    Ok((points, absent))
}

pub fn table(points: &[Point]) -> Table {
    let row = |point: &Point| {
        let Point {
            name,
            scene,
            board,
            rate,
            step,
            error,
        } = *point;
        let mut row = [scene.name, board.cpu, name].map(str::to_owned).to_vec();
        row.push(format!("1/{rate}"));
        row.extend(
            [step.instructions, step.cycles, step.stalls].map(|count| format!("{count:.0}")),
        );
        row.extend(
            [step.hot_bytes, step.code_bytes, step.stack_bytes].map(|bytes| bytes.to_string()),
        );
        row.push(format!("{:.0}", point.cycles()));
        row.extend([error.angle, error.pixels].map(small));

        // A step is resolved if it is at most the admissible step of the motion.
        let request = request(Method::Rk4F64, scene, rate);
        let is_resolved = request
            .admissible_step()
            .is_some_and(|longest| request.dt <= longest);
        row.push(String::from(if is_resolved { "yes" } else { "no" }));
        row.push(String::from(if point.is_dominated(points) {
            "dominated"
        } else {
            "best"
        }));
        row
    };
    const COLUMNS: &str = "scene,processor,method,step (s),instructions of a step,\
        cycles of a step (estimate),stalls,hot bytes,code bytes,stack bytes,\
        cycles per s (estimate),error (rad),error (pixels),resolved,verdict";
    Table {
        columns: COLUMNS.split(',').collect(),
        rows: points.iter().map(row).collect(),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use boards::BOARDS;

    pub fn point(name: &'static str, cycles: f64, angle: f64) -> Point {
        let step = StepCost {
            cycles: cycles / 64.0,
            ..StepCost::default()
        };
        let error = Error {
            angle,
            pixels: 10.0 * angle,
        };
        Point {
            name,
            scene: &SCENES[0],
            board: &BOARDS[0],
            rate: 64,
            step,
            error,
        }
    }

    #[test]
    fn a_point_is_dominated_by_one_at_least_as_good_in_both() {
        let one = |cycles, angle| point("rk4-f32", cycles, angle);
        assert!(one(2.0, 1.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(one(1.0, 2.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(!one(1.0, 1.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(!one(2.0, 1.0).is_dominated(&[one(1.0, 2.0)]));

        let elsewhere = Point {
            board: &BOARDS[1],
            ..one(0.0, 0.0)
        };
        assert!(!one(1.0, 1.0).is_dominated(&[elsewhere]));
    }
}
