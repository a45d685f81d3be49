//! Every scene that moves, on three chips.

use std::convert::Infallible;

use clap::Parser;
use firmware::scenes::SceneName;

use super::frames::{Proof, follow};
use super::options::Options;
use crate::commands::plan::{Chip, M3, M4F, PICO};
use crate::commands::table::Table;
use reference::enclosure::Fineness;

/// The scenes that move, if only in the end.
pub fn moving() -> impl Iterator<Item = &'static SceneName> {
    SceneName::ALL.iter().filter(|name| name.has_angles() && **name != SceneName::Upright)
}

/// Predicted and proved horizons; `tick` is called after each scene.
pub fn horizons(tick: impl Fn()) -> anyhow::Result<Table> {
    let row = |name: &SceneName| {
        let cells = row(name.name());
        tick();
        cells
    };
    Ok(Table {
        title: "Horizons",
        note: String::from(
            "Until when every frame is right to half a pixel, s: as the plan predicts, and as is proved.",
        ),
        columns: &[
            "scene",
            "M3: predicted",
            "proved",
            "M4F: predicted",
            "proved",
            "M0+: predicted",
            "proved",
            "open frames",
        ],
        rows: moving().map(row).collect::<anyhow::Result<_>>()?,
    })
}

fn row(name: &str) -> anyhow::Result<Vec<String>> {
    let on = |chip: Chip| {
        Options::try_parse_from(["prove", "--scene", name, "--target", chip.name]).map(|options| options.scene())
    };
    let plans = [on(M3)??, on(M4F)??, on(PICO)??];
    let (scene, start, _) = &plans[0];
    let ways = plans.iter().filter_map(|(.., plan)| Options::planned(plan));
    let mut proofs = ways.map(|way| Proof::new(scene, way)).collect::<Result<Vec<_>, _>>()?;
    let Ok(_) =
        follow(scene, start.enclose(scene.rate, Fineness::default()), &mut proofs, |_, _, _| Ok::<_, Infallible>(true));
    let open: u32 = proofs.iter().map(|proof| proof.open).sum();
    let mut proved = proofs.iter().map(|proof| format!("{:.2}", scene.time(proof.right)));
    let cells = plans.iter().flat_map(|(.., plan)| match plan {
        Ok(plan) => [format!("{:.2}", plan.horizon), proved.next().unwrap_or_default()],
        Err(_) => [(); 2].map(|()| String::from("none")),
    });
    let cells: Vec<_> = cells.collect();
    Ok([vec![name.to_owned()], cells, vec![open.to_string()]].concat())
}
