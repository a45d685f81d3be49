//! `cargo figures`: the book's figures 2 to 5 and 7 from the kernel, and what the panel shows in every scene.
//!
//! Nothing in these files depends on the machine, so two runs write the same files.

pub mod chaos;
pub mod panel;
mod sheet;
pub mod small;

use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;
use firmware::scenes::SceneName;

use crate::console::cli::{say, write};
use crate::emulator::toolchain::workspace;

/// Draws the book's figures 2 to 5 and 7 from the kernel, as SVG, and the panel's frame of every scene.
#[derive(Debug, Parser)]
#[command(name = "cargo figures", after_help = "Example: cargo figures --out /tmp/figures")]
pub struct FiguresOptions {
    /// Also record an animation of every scene, each by the `cargo demo` that is printed as it begins
    #[arg(long)]
    animations: bool,
    /// Where to write [default: host-tests/pictures of the project, over what the READMEs show]
    #[arg(long, alias = "folder", value_name = "FOLDER")]
    out: Option<PathBuf>,
}

pub fn folder() -> PathBuf {
    workspace().join("host-tests/pictures")
}

/// Every file that the command writes: its name in that folder and what is in it.
pub fn files() -> Result<Vec<(String, Vec<u8>)>> {
    let small = |number, mass_ratio| Ok((number, small::figure(number, mass_ratio)?));
    let figures =
        [Ok((2, small::frequencies()?)), small(3, 0.2), small(4, 1.0), small(5, 5.0), Ok((7, chaos::figure()?))];
    let figures = figures
        .into_iter()
        .map(|figure| figure.map(|(number, svg)| (format!("figures/figure-{number}.svg"), svg.into())));
    let panels = SceneName::ALL.iter().map(|&scene| Ok((panel::file(scene, "png"), panel::screenshot(scene)?)));
    figures.chain(panels).collect()
}

pub fn run(options: &FiguresOptions) -> Result<()> {
    let folder = options.out.clone().unwrap_or_else(folder);
    for (name, bytes) in files()? {
        write(&folder.join(name), &bytes)?;
    }
    if options.animations {
        SceneName::ALL.iter().try_for_each(|&scene| panel::record(scene, &folder))?;
    }
    Ok(say(folder.display())?)
}
