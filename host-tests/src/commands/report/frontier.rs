//! What is cheapest for an error: the frontier of every scene on every core, and what to take in plain words.

use super::scene::{SCENES, Scene};
use super::speed::Priced;
use crate::commands::count::ERROR_BAR;
use crate::commands::table::{Table, small};
use crate::emulator::boards::{Board, Core};

/// Steps a second that give a picture in every frame of the panel.
const PICTURES: u32 = 60;
/// No larger an error is seen on the panel.
const HALF_PIXEL: f64 = 0.5;

/// What one may want to compute a motion for.
type Serves = fn(&Priced) -> bool;
const PURPOSES: [(&str, Serves); 3] = [
    ("60 pictures a second", |one| one.point.rate >= PICTURES && one.point.error.pixels <= HALF_PIXEL),
    ("1e-9 rad", |one| one.point.error.angle <= 1e-9),
    ("1e-12 rad", |one| one.point.error.angle <= 1e-12),
];

/// The cheapest of a scene on a board that `serves`.
pub fn cheapest<'a>(
    priced: &'a [Priced],
    scene: &Scene,
    board: &Board,
    serves: impl Fn(&Priced) -> bool,
) -> Option<&'a Priced> {
    let there = priced.iter().filter(|one| one.point.scene == scene && one.board == board && serves(one));
    there.min_by(|a, b| a.cycles.total_cmp(&b.cycles))
}

/// What to take on each board, through a regular and a chaotic motion: one sentence each, in Markdown.
pub fn advice(priced: &[Priced], boards: &[&Board]) -> Vec<String> {
    let mut sentences = Vec::new();
    for board in boards {
        let core = match board.core() {
            Core::M3 => "Cortex-M3",
            Core::M4F => "Cortex-M4F",
            Core::M0Plus => "Cortex-M0+",
        };
        for scene in &SCENES[..2] {
            let take = |(purpose, serves): (&str, Serves)| match cheapest(priced, scene, board, serves) {
                Some(one) => format!(
                    "for {purpose} take `{}` with {} steps ({} cycles a simulated second)",
                    one.point.contestant,
                    one.point.rate,
                    thousands(one.cycles)
                ),
                None => format!("nothing here reaches {purpose}"),
            };
            let taken = PURPOSES.map(take).join(", ");
            sentences.push(format!("On a {core}, {}, {} s: {taken}.", scene.title, scene.duration));
        }
    }
    sentences
}

/// To three digits, in thousands.
fn thousands(cycles: f64) -> String {
    match cycles / 1e3 {
        kilo @ ..10.0 => format!("{kilo:.1}k"),
        kilo @ ..1000.0 => format!("{kilo:.0}k"),
        kilo => format!("{:.1}M", kilo / 1e3),
    }
}

/// Every point that nothing else is as good as in both, the cheapest first.
pub fn table(priced: &[Priced], boards: &[&Board], scenes: &[Scene]) -> Table {
    let mut rows = Vec::new();
    for scene in scenes {
        for board in boards {
            let is_it = |one: &&Priced| one.point.scene == scene && one.board == *board && !one.dominated;
            let mut best: Vec<_> =
                priced.iter().filter(is_it).filter(|one| one.point.error.angle.is_finite()).collect();
            best.sort_by(|a, b| a.cycles.total_cmp(&b.cycles));
            rows.extend(best.into_iter().map(|one| {
                vec![
                    scene.name.to_owned(),
                    board.cpu.to_owned(),
                    one.point.contestant.to_string(),
                    format!("1/{}", one.point.rate),
                    format!("{:.0}", one.cycles),
                    small(one.point.error.angle),
                    small(one.point.error.pixels),
                ]
            }));
        }
    }
    Table {
        name: "frontier",
        title: String::from("What to take"),
        note: format!(
            "{} The rows: every method and step that nothing else is as good as in both, error and cycles per \
             simulated second. {ERROR_BAR}",
            advice(priced, boards).join(" ")
        ),
        columns: vec![
            "scene",
            "processor",
            "method",
            "step (s)",
            "cycles per s (estimate)",
            "error (rad)",
            "error (pixels)",
        ],
        rows,
    }
}
