//! Scenes on three chips.

use clap::Parser;
use firmware::scenes::SceneName;

use super::horizon::{Proof, follow};
use super::options::Options;
use crate::commands::plan::{M3, M4F, PICO};
use crate::commands::table::Table;

/// The scenes that move, if only in the end.
pub fn moving() -> impl Iterator<Item = &'static SceneName> {
    SceneName::ALL.iter().filter(|name| name.has_angles() && **name != SceneName::Upright)
}

/// Predicted and proved horizons; `tick` is called after each scene.
pub fn horizons<'a>(scenes: impl Iterator<Item = &'a SceneName>, tick: impl Fn()) -> anyhow::Result<Table> {
    let columns = &["scene", "M3: plan", "proved", "M4F: plan", "proved", "M0+: plan", "proved", "open"];
    let rows = scenes.map(|scene| row(scene.name()).inspect(|_| tick())).collect::<anyhow::Result<_>>()?;
    Ok(Table { columns, rows, ..Table::default() })
}

fn row(name: &str) -> anyhow::Result<Vec<String>> {
    let mut cells = vec![name.to_owned()];
    let mut plans = Vec::new();
    for chip in [M3, M4F, PICO] {
        plans.push(Options::try_parse_from(["prove", "--scene", name, "--target", chip.name])?.scene()?);
    }
    let (scene, start, _) = &plans[0];
    let ways = plans.iter().filter_map(|(.., plan)| Options::planned(plan));
    let mut proofs = ways.map(|way| Proof::new(scene, way)).collect::<Result<Vec<_>, _>>()?;
    follow(scene, start, &mut proofs, |_, _, _| Ok(true))?;
    let mut proved = proofs.iter().map(|proof| format!("{:.2}", scene.time(proof.right)));
    for (.., plan) in &plans {
        cells.extend(match plan {
            Ok(plan) => [format!("{:.2}", plan.horizon), proved.next().unwrap_or_default()],
            Err(_) => ["none", "none"].map(String::from),
        });
    }
    cells.push(proofs.iter().map(|proof| proof.open).sum::<u32>().to_string());
    Ok(cells)
}
