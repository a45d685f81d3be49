//! `cargo figures`: the book's figures 2 to 5 and 7 from the kernel, and what the panel shows in every scene.
//!
//! Nothing in these files depends on the machine, so two runs write the same files.

pub mod chaos;
pub mod frequencies;
pub mod panel;
mod sheet;
pub mod small;

use std::path::PathBuf;

use anyhow::Result;
use firmware::scenes::SceneName;

use crate::emulator::toolchain::workspace;

pub fn folder() -> PathBuf {
    workspace().join("host-tests/pictures")
}

pub const FOLDERS: [&str; 2] = ["figures", "panel"];

/// Every file that the command writes: its name in that folder and what is in it.
pub fn files() -> Result<Vec<(String, Vec<u8>)>> {
    let mut figures = vec![(2, frequencies::Frequencies::new()?.svg()?), (7, chaos::Chaos::new(1)?.svg()?)];
    for (number, mass_ratio) in [(3, 0.2), (4, 1.0), (5, 5.0)] {
        figures.push((number, small::Small::new(number, mass_ratio)?.svg()?));
    }
    let figures =
        figures.into_iter().map(|(number, svg)| Ok((format!("figures/figure-{number}.svg"), svg.into_bytes())));
    let panels = SceneName::ALL.iter().map(|&scene| Ok((panel::file(scene, "png"), panel::screenshot(scene)?)));
    figures.chain(panels).collect()
}
