//! The horizons of plans, proved.

mod horizon;
mod known_answers;

use clap::Parser;
use firmware::scenes::SceneName;
use reference::enclosure::Start;

use crate::commands::plan::{M3, M4F, PICO, SceneOptions};
use crate::commands::table::Table;
pub use horizon::{Frame, frames, open, right, words};
pub use known_answers::known_answers;

/// The scenes that move, if only in the end.
pub fn moving() -> impl Iterator<Item = &'static SceneName> {
    SceneName::ALL.iter().filter(|name| name.has_angles() && **name != SceneName::Upright)
}

/// Predicted and proved horizons; `tick` is called after each scene.
pub fn horizons<'a>(scenes: impl Iterator<Item = &'a SceneName>, tick: impl Fn()) -> anyhow::Result<Table> {
    let columns = &["scene", "M3: plan", "proved", "M4F: plan", "proved", "M0+: plan", "proved", "open"];
    let rows = scenes.map(|scene| horizon(scene.name()).inspect(|_| tick())).collect::<anyhow::Result<_>>()?;
    Ok(Table { columns, rows, ..Table::default() })
}

fn horizon(name: &str) -> anyhow::Result<Vec<String>> {
    let (mut cells, mut unproved) = (vec![name.to_owned()], 0);
    for chip in [M3, M4F, PICO] {
        let options = SceneOptions::try_parse_from(["plan", "--scene", name, "--target", chip.name])?;
        let (scene, plan) = options.plan()?;
        cells.extend(match plan {
            Err(_) => ["none", "none"].map(String::from),
            Ok(plan) => {
                let start = Start::of(&scene.pendulum, &scene.start);
                let frames: Vec<_> = frames(&scene, &start, plan.way())?.collect();
                unproved += open(&frames);
                [plan.horizon, scene.time(right(&frames))].map(|time| format!("{time:.2}"))
            }
        });
    }
    cells.push(unproved.to_string());
    Ok(cells)
}
