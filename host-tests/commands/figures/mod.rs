//! `cargo figures`: the book's figures 2 to 5 and 7 computed by the kernel, and animations of the
//! panel in every scene.
//!
//! The files do not depend on the machine, so two runs write the same files.

pub mod chaos;
mod sheet;
pub mod small;

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Parser;
use firmware::graphics::PanelName;
use firmware::scenes::SceneName;

use boards::console::cli::{say, unwritable};
use boards::out_file::{OutFile, write};
use boards::toolchain::workspace;

/// Draws figures 2 to 5 and 7 of math24.net's page on the double pendulum, as SVG.
#[derive(Debug, Parser)]
#[command(
    name = "cargo figures",
    after_help = "Example: cargo figures --out /tmp/figures"
)]
pub struct FiguresOptions {
    /// Also draw an animation of every scene, as a Pico with a colour panel shows it
    #[arg(long)]
    animations: bool,
    /// The folder to write to [default: host-tests/pictures, which the READMEs show]
    #[arg(long, alias = "folder", value_name = "FOLDER")]
    out: Option<PathBuf>,
}

pub fn folder() -> PathBuf {
    workspace().join("host-tests/pictures")
}

pub fn figures() -> Result<Vec<(String, String)>> {
    let [light, equal, heavy] = small::MASS_RATIOS;
    let figures = [
        (2, small::frequencies()?),
        (3, small::figure(3, light)?),
        (4, small::figure(4, equal)?),
        (5, small::figure(5, heavy)?),
        (7, chaos::figure()?),
    ];
    Ok(figures
        .into_iter()
        .map(|(number, svg)| (format!("figures/figure-{number}.svg"), svg))
        .collect())
}

pub fn run(options: &FiguresOptions) -> Result<()> {
    let folder = options.out.clone().unwrap_or_else(folder);
    for (name, svg) in figures()? {
        write("--out", &folder.join(name), svg)?;
    }

    // The animations take longer, so they are drawn only on request.
    if options.animations {
        std::fs::create_dir_all(folder.join("panel"))
            .map_err(|error| unwritable("--out", &folder, &error))?;
        SceneName::ALL
            .iter()
            .try_for_each(|&scene| record(scene, &folder))?;
    }
    let folder = folder.join("figures");
    Ok(say(format_args!("wrote {}", folder.display()))?)
}

pub fn animation(scene: SceneName, folder: &Path) -> PathBuf {
    folder.join(format!("panel/{}.gif", scene.name()))
}

/// Draws the animation of a scene into its file in a folder.
pub fn record(scene: SceneName, folder: &Path) -> Result<()> {
    // Each scene is recorded until it has shown everything. The first picture of the README is
    // larger than the others.
    let (seconds, scale) = match scene {
        SceneName::Page => (10, 2),
        SceneName::Figure7 => (12, 1),
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => (4, 1),
        SceneName::Frequencies => (3, 1),
        SceneName::Flips => (120, 1),
        _ => (10, 1),
    };
    let file = OutFile::create("--out", &animation(scene, folder))?;
    demo::animate(scene, PanelName::Lcd13, seconds, scale, file)
}
