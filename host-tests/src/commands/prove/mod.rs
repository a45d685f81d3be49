//! The horizons of plans, proved.

mod horizon;
mod known_answers;
mod options;

use clap::Parser;
use firmware::scenes::SceneName;

use crate::commands::plan::{M3, M4F, PICO};
use crate::commands::table::Table;
pub use horizon::{HEADING, Proof, row, words};
pub use known_answers::known_answers;
pub use options::Options;

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
    let (mut cells, mut open) = (vec![name.to_owned()], 0);
    for chip in [M3, M4F, PICO] {
        let options = Options::try_parse_from(["prove", "--scene", name, "--target", chip.name])?;
        let (scene, start, plan) = options.scene()?;
        let horizons = match (&plan, options.way(&plan)) {
            (Ok(plan), Some(way)) => {
                let proof = Proof::of(&scene, &start, way, |_, _, _| Ok(true))?;
                open += proof.open;
                [plan.horizon, scene.time(proof.right)].map(|time| format!("{time:.2}"))
            }
            _ => ["none", "none"].map(String::from),
        };
        cells.extend(horizons);
    }
    cells.push(open.to_string());
    Ok(cells)
}
