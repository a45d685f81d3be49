//! The map of flips: what of it can be believed, and what it costs on chips.

use double_pendulum::{Error, Parameters};
use firmware::config::{FlipsPace, TICK_RATE};
use firmware::graphics::canvas::{HEIGHT, WIDTH};
use firmware::graphics::fade_layer::FadeLayer;
use firmware::motion::settings::Settings;
use firmware::motion::simulation::Means;
use firmware::scenes::SceneName;
use firmware::scenes::flips::Flips;
use firmware::scenes::scene::Scene;

use super::frames::Counted;
use crate::commands::count::{ERROR_BAR, Part};
use crate::commands::flips::judge::{Sample, judge, sample};
use crate::commands::flips::map::Map;
use crate::commands::flips::square::Square;
use crate::commands::table::Table;
use crate::emulator::boards::Board;

/// Limits of the maps judged, sqrt(l/g), and points of the first that the reference judges.
const LIMITS: [f32; 3] = [10.0, 100.0, 1000.0];
const SAMPLE: usize = 60;

/// Maps of `side` x `side` starts, of the first `limits` limits.
pub fn belief(side: usize, limits: usize) -> Result<Table, Error> {
    let map = |limit| Map::new(Parameters::equal_rods(1.0, 1.0, 1.0), limit, Square::whole([side, side]));
    let row = |&limit: &f32| {
        let map = map(limit)?;
        let verdict = judge(&map)?;
        let share = |points: usize| format!("{:.2} %", 100.0 * points as f64 / verdict.points as f64);
        let sample = if limit == LIMITS[0] {
            let Sample { judged, wrong } = sample(&map, SAMPLE)?;
            format!("{wrong} of {judged}")
        } else {
            String::new()
        };
        let [right, doubtful] = [verdict.points - verdict.wrong, verdict.doubtful].map(share);
        Ok(vec![limit.to_string(), verdict.points.to_string(), right, doubtful, share(verdict.unsuspected), sample])
    };
    Ok(Table {
        name: "flips",
        title: String::from("The map of flips: what can be believed"),
        note: format!(
            "Of {side} x {side} starts from rest, half of which mirror the others, those that may turn over. Right: within a grey \
             level of the panel, a fourteenth of the logarithmic scale up to the limit, by steps 16 times finer in compensated f64. \
             In doubt: the map's two steps are farther apart. Unsuspected: wrong, and not in doubt. Wrong by the reference: of a \
             sample, by the exact motion. Speed: `cargo bench --bench flips`."
        ),
        columns: vec!["limit (sqrt(l/g))", "points", "right", "in doubt", "unsuspected", "wrong by the reference"],
        rows: LIMITS.iter().take(limits).map(row).collect::<Result<_, Error>>()?,
    })
}

/// What the panel's map costs on the boards whose frames were counted.
pub fn cost(frames: &[Counted]) -> Result<Table, Error> {
    let row = |frame: &Counted| {
        let (pace, ticks) = played(frame.board)?;
        let cycles = frame.cycles(Part::Motion) as f64;
        let points = (WIDTH * HEIGHT / 2) as f64;
        Ok(vec![
            frame.board.name.to_owned(),
            pace.steps.to_string(),
            format!("{:.0}", cycles / f64::from(pace.steps)),
            format!("{:.0}", cycles * f64::from(ticks) / points),
            format!("{:.1}", f64::from(ticks) / f64::from(TICK_RATE)),
        ])
    };
    Ok(Table {
        name: "flips-cost",
        title: String::from("The map of flips on the panel"),
        note: format!(
            "Up to 100 sqrt(l/g), on a Cortex-M3 in fixed point, on a Cortex-M4F in f32. A start counts as so many steps as it costs. A \
             point: one of the {} that are computed, the others are their mirror images. {ERROR_BAR}",
            WIDTH * HEIGHT / 2
        ),
        columns: vec!["board", "steps a frame", "cycles a step", "cycles a point", "whole map (s)"],
        rows: frames.iter().filter(|frame| frame.scene == SceneName::Flips).map(row).collect::<Result<_, Error>>()?,
    })
}

/// A board's pace, and its ticks until the map is finished.
fn played(board: &Board) -> Result<(FlipsPace, u32), Error> {
    let means = Means { processor: board.processor(), method: None };
    let (mut scene, mut ink) = (Flips::new(&Settings::default(), &means)?, FadeLayer::NONE);
    let mut ticks = 0;
    while !scene.is_done() {
        scene.tick(&mut ink);
        ticks += 1;
    }
    Ok((means.processor.flips, ticks))
}
