//! `cargo figures`: the book's figures 2 to 5 and 7 from the kernel, and what the panel shows in every scene.
//!
//! Nothing in these files depends on the machine, so two runs write the same files.

pub mod chaos;
pub mod frequencies;
pub mod panel;
mod sheet;
pub mod small;

use std::fs;
use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;
use firmware::scenes::SceneName;

use crate::console::cli::{Refused, say};
use crate::emulator::toolchain::workspace;

/// Draws the book's figures 2 to 5 and 7 from the kernel, as SVG, and the panel's frame of every scene.
#[derive(Debug, Parser)]
#[command(name = "cargo figures", after_help = "Example: cargo figures --folder /tmp/figures")]
pub struct FiguresOptions {
    /// Also record an animation of every scene, each by the `cargo demo` that is printed as it begins
    #[arg(long)]
    animations: bool,
    /// Where to write [default: host-tests/pictures of the project]
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

pub fn folder() -> PathBuf {
    workspace().join("host-tests/pictures")
}

/// Every file that the command writes: its name in that folder and what is in it.
pub fn files() -> Result<Vec<(String, Vec<u8>)>> {
    let mut figures = vec![(2, frequencies::figure()?), (7, chaos::figure()?)];
    for (number, mass_ratio) in [(3, 0.2), (4, 1.0), (5, 5.0)] {
        figures.push((number, small::Small::new(number, mass_ratio)?.figure()?));
    }
    let figures =
        figures.into_iter().map(|(number, svg)| Ok((format!("figures/figure-{number}.svg"), svg.into_bytes())));
    let panels = SceneName::ALL.iter().map(|&scene| Ok((panel::file(scene, "png"), panel::screenshot(scene)?)));
    figures.chain(panels).collect()
}

pub fn run(options: &FiguresOptions) -> Result<()> {
    let folder = options.folder.clone().unwrap_or_else(folder);
    let unwritable =
        |path: PathBuf, error| Refused::because(format_args!("--folder: cannot write {}: {error}", path.display()));
    for subfolder in ["figures", "panel"].map(|name| folder.join(name)) {
        fs::create_dir_all(&subfolder).map_err(|error| unwritable(subfolder, error))?;
    }
    for (name, bytes) in files()? {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| unwritable(path, error))?;
    }
    if options.animations {
        SceneName::ALL.iter().try_for_each(|&scene| panel::record(scene, &folder))?;
    }
    Ok(say(folder.display())?)
}
