//! `cargo write-report`: every method's cost on the target against its error, as CSV files and charts.
//!
//! Costs are counted on the emulated targets, errors are computed on the host, which is allowed because the bits are the
//! same (test `identity`). Nothing is timed, so two runs write the same files.

pub mod accuracy;
mod c_peers;
mod chart;
mod frames;
pub mod join;
mod readme;
pub mod scene;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use firmware::scenes::SceneName;

use crate::commands::count::Target;
use crate::console::progress::Bar;
use crate::emulator::boards::BOARDS;
use crate::emulator::toolchain::Toolchain;
pub use readme::Blocks;
use scene::{LONG, SCENES, Scene};

/// Computes the report and writes it into `folder`, costs on one board for each kind of core.
///
/// All of it takes an hour; `quick`, some minutes: the first two scenes, and of frames a Cortex-M3's and a Cortex-M4F's. Gives what
/// the READMEs show of it, and what had to be left out, a line each.
pub fn write(quick: bool, toolchain: &Toolchain, folder: &Path, bar: &Bar) -> Result<(Blocks, Vec<String>)> {
    let [scenes, boards] = if quick { [2, 2] } else { [SCENES.len(), BOARDS.len()] };
    let targets = Target::build_all(toolchain)?;
    let scenes: Vec<&'static Scene> = SCENES.iter().take(scenes).chain([&LONG]).collect();
    let runs = join::methods().count() * (scenes.len() + targets.len()) + boards * SceneName::ALL.len();
    bar.set_length(runs as u64);
    let tick = || bar.advance(1);
    let save = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    };
    bar.say("comparing with the reference, counting");
    let (mut points, absent) = join::join(toolchain, &targets, &scenes, &tick)?;
    join::mark_dominated(&mut points);
    save("speed-against-error.csv", &join::table(&points).csv())?;
    let mut charts = Vec::new();
    for scene in scenes.into_iter().filter(|scene| **scene != LONG) {
        for target in &targets {
            let name = format!("{}-{}.svg", scene.name, target.board.cpu);
            let svg = chart::speed_against_error(&points, scene, target.board)?;
            save(&name, &svg)?;
            charts.push((name, svg));
        }
    }
    bar.say("counting frames");
    save("frames.csv", &frames::count(toolchain, boards, &tick)?.csv())?;
    charts.retain(|(name, _)| name.starts_with(SCENES[0].name));
    Ok((Blocks::new(&points, charts), absent))
}
