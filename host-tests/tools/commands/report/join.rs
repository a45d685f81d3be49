//! The table of cost and error of every method and of the programs in C.

use anyhow::Result;
use double_pendulum::{Integrator, Method};
use rayon::prelude::*;

use super::accuracy::{self, Error, LONG, SAMPLES, SCENES, Scene, rates, request, usual_rate};
use super::c_peers;
use crate::commands::count::{StepCost, Target, affordable_cost};
use crate::commands::table::{Table, small};
use console::progress::Progress;
use emulator::boards::Board;
use emulator::toolchain::Toolchain;

/// The finest step is 2^-`FINEST` s.
const FINEST: u32 = 13;

/// The result of a method in a scene, on a board, with a step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// A method of the kernel, or a program in C.
    pub name: &'static str,
    /// The motion that was computed.
    pub scene: &'static Scene,
    /// The board with the core that the cost was counted on.
    pub board: &'static Board,
    /// The number of steps per simulated second.
    pub rate: u32,
    /// The cost of a step: instructions, cycles (estimated), bytes.
    pub step: StepCost,
    /// The largest errors in the scene.
    pub error: Error,
}

impl Point {
    /// Returns the estimated cycles per simulated second: the cycles of a step times the steps.
    pub fn cycles(&self) -> f64 {
        f64::from(self.rate) * self.step.cycles
    }

    /// Returns true if another of `points` has, in the same scene and on the same board, neither
    /// more cycles per simulated second nor a larger error of an angle, and is better in at least
    /// one of them. The point itself may be among `points`.
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
/// It runs QEMU for minutes. The scenes are those of [`SCENES`], then [`LONG`], with the numbers of
/// steps of [`rates`] up to 2^13 per second. The closed forms are left out, because their error
/// comes from the linear equations. A scene or a step that a method does not support has no point;
/// a motion that diverges has infinite errors.
///
/// The methods are in the order of [`Method::ALL`]. The points of a method are in the order of the
/// scenes, then of the steps, from the coarsest on, then of the targets. The programs in C are
/// last, each by target, scene and steps. Also returns a line for each program in C and board that
/// cannot be built, with the reason. An error means that QEMU or a program on a target fails, or
/// executes an instruction without a known timing.
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
        // All scenes have the same pendulum and so the same code and cost of a step.
        let cost =
            |target| affordable_cost(target, &request(method, &SCENES[0], usual_rate(method)));
        let costs = targets
            .iter()
            .map(|target| Ok((target.board, cost(target)?)))
            .collect::<Result<Vec<_>>>()?;

        // A method that does not support a scene or a step has no point there.
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

    // The programs in C are measured in the same way.
    let (peers, absent) = c_peers::points(toolchain, targets, &scenes)?;
    points.extend(peers);
    Ok((points, absent))
}

/// Returns the table of the report, a row for each point, in the order of `points`. Its titles name
/// the units. Counts are rounded to whole numbers, and an infinite error is "none". A step is
/// "resolved" ("yes" or "no") if it is at most the admissible step of the motion. The verdict is
/// "dominated" ([`Point::is_dominated`]) or "best".
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
        // The columns in the order of `COLUMNS`.
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
    use emulator::boards::BOARDS;

    /// Returns a point for tests: `name` in the regular scene on the first board, with 64 steps and
    /// `cycles` cycles per simulated second, an error of `angle`, rad, and ten times as many
    /// pixels. All other costs are 0.
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

    /// A point is dominated by another point of its board that is no worse in cycles and error and
    /// better in one. Equal points and points of other boards do not dominate.
    #[test]
    fn a_point_is_dominated_by_one_at_least_as_good_in_both() {
        let one = |cycles, angle| point("rk4-f32", cycles, angle);
        assert!(one(2.0, 1.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(one(1.0, 2.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(!one(1.0, 1.0).is_dominated(&[one(1.0, 1.0)]));
        assert!(!one(2.0, 1.0).is_dominated(&[one(1.0, 2.0)]));

        // Points of different boards are not compared.
        let elsewhere = Point {
            board: &BOARDS[1],
            ..one(0.0, 0.0)
        };
        assert!(!one(1.0, 1.0).is_dominated(&[elsewhere]));
    }
}
