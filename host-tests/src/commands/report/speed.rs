//! Speed against error, and where the error stops falling.

use super::accuracy::{Contestant, Point};
use super::c_peers::Counted;
use super::costs::{self, Cost};
use super::scene::SAMPLES;
use crate::commands::count::{ERROR_BAR, StepCost};
use crate::commands::table::{Table, small};
use crate::emulator::boards::{BOARDS, Board};

/// A point with its price on one board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Priced {
    /// Method, scene, step size and error.
    pub point: Point,
    /// The board.
    pub board: &'static Board,
    /// Executed instructions per simulated second.
    pub instructions: f64,
    /// Estimated cycles per simulated second.
    pub cycles: f64,
    /// Another point of the scene and board has neither more cycles nor a larger error, and less of one.
    pub dominated: bool,
}

/// All points on all boards that the cost is known of, and those of the programs in C.
pub fn priced(points: &[Point], costs: &[Cost], counted: &[Counted]) -> Vec<Priced> {
    let mut priced = Vec::new();
    for board in &BOARDS {
        priced.extend(points.iter().filter_map(|&point| {
            let Contestant::Kernel(method) = point.contestant else { return None };
            Some(Priced::new(point, board, costs::of(costs, method, point.scene, board)?.step))
        }));
        for one in counted.iter().filter(|one| one.board == board) {
            priced.extend(one.points.iter().map(|&point| Priced::new(point, board, one.step)));
        }
    }
    let all = priced.clone();
    for one in &mut priced {
        one.dominated = all.iter().any(|other| dominates(other, one));
    }
    priced
}

impl Priced {
    fn new(point: Point, board: &'static Board, step: StepCost) -> Self {
        let steps = f64::from(point.rate);
        let (instructions, cycles) = (steps * step.instructions, steps * step.cycles);
        Self { point, board, instructions, cycles, dominated: false }
    }
}

fn dominates(other: &Priced, one: &Priced) -> bool {
    let same = other.board == one.board && other.point.scene == one.point.scene;
    let (error, worse) = (other.point.error.angle, one.point.error.angle);
    same && other.cycles <= one.cycles && error <= worse && (other.cycles < one.cycles || error < worse)
}

/// Speed against error.
pub fn table(priced: &[Priced]) -> Table {
    let row = |one: &Priced| {
        let Point { scene, contestant, rate, error } = one.point;
        vec![
            scene.name.to_owned(),
            one.board.cpu.to_owned(),
            contestant.to_string(),
            format!("1/{rate}"),
            format!("{:.0}", one.instructions),
            format!("{:.0}", one.cycles),
            small(error.angle),
            small(error.pixels),
            String::from(if 1.0 / f64::from(rate) <= scene.admissible_step() { "yes" } else { "no" }),
            String::from(if one.dominated { "dominated" } else { "best" }),
        ]
    };
    Table {
        name: "speed-against-error",
        title: String::from("Speed against error"),
        note: format!(
            "Largest error of an angle, and of a bob's place on the panel, over {SAMPLES} states a second or fewer, against the \
             reference. Costs per simulated second. {ERROR_BAR} Resolved: the step is at most the longest that resolves \
             every motion of the scene's energy; a tame one may do with more. Dominated: something else is at least as \
             good in both.",
        ),
        columns: vec![
            "scene",
            "processor",
            "method",
            "step (s)",
            "instructions per s",
            "cycles per s (estimate)",
            "error (rad)",
            "error (pixels)",
            "resolved",
            "verdict",
        ],
        rows: priced.iter().map(row).collect(),
    }
}

/// The error floors: the least error, the step it needs, and what becomes of it as the step shrinks further.
pub fn floors(points: &[Point]) -> Table {
    let mut rows = Vec::new();
    for group in points.chunk_by(|a, b| a.scene == b.scene && a.contestant == b.contestant) {
        let least = group.iter().min_by(|a, b| a.error.angle.total_cmp(&b.error.angle));
        let worst_growth = group.windows(2).map(|pair| pair[1].error.angle / pair[0].error.angle).fold(0.0, f64::max);
        if let (Some(least), Some(finest)) = (least, group.last()) {
            rows.push(vec![
                least.scene.name.to_owned(),
                least.contestant.to_string(),
                small(least.error.angle),
                format!("1/{}", least.rate),
                small(finest.error.angle),
                format!("1/{}", finest.rate),
                format!("{worst_growth:.2}"),
            ]);
        }
    }
    Table {
        name: "error-floors",
        title: String::from("Error floors"),
        note: String::from(
            "The least error over all step sizes, where it is reached, the error at the finest step, and the largest \
             factor by which the next shorter step made the error grow.",
        ),
        columns: vec![
            "scene",
            "method",
            "least error (rad)",
            "at step (s)",
            "error at the finest step (rad)",
            "finest step (s)",
            "worst growth on refining",
        ],
        rows,
    }
}

#[cfg(test)]
mod tests {
    use double_pendulum::Method;

    use super::*;
    use crate::commands::report::accuracy::Error;
    use crate::commands::report::scene::SCENES;
    use crate::emulator::boards::BOARDS;

    #[test]
    fn a_point_is_dominated_by_one_at_least_as_good_in_both() {
        let one = |cycles, angle| Priced {
            point: Point {
                scene: &SCENES[0],
                contestant: Contestant::Kernel(Method::ALL[0]),
                rate: 16,
                error: Error { angle, pixels: 0.0 },
            },
            board: &BOARDS[0],
            instructions: 0.0,
            cycles,
            dominated: false,
        };
        assert!(dominates(&one(1.0, 1.0), &one(2.0, 1.0)));
        assert!(dominates(&one(1.0, 1.0), &one(1.0, 2.0)));
        assert!(!dominates(&one(1.0, 1.0), &one(1.0, 1.0)));
        assert!(!dominates(&one(1.0, 2.0), &one(2.0, 1.0)));
        let elsewhere = Priced { board: &BOARDS[1], ..one(0.0, 0.0) };
        assert!(!dominates(&elsewhere, &one(1.0, 1.0)));
    }
}
