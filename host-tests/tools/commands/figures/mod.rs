//! `cargo figures`: the book's figures 2 to 5 and 7 computed by the kernel, and animations of the
//! panel in every scene.
//!
//! The files do not depend on the machine, so two runs write the same files.

pub mod chaos;
mod sheet;
pub mod small;

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Parser;
use firmware::scenes::SceneName;

use console::cli::{complain, say, unwritable};
use demo::DemoOptions;
use emulator::out_file::write;
use emulator::toolchain::workspace;

/// Draws figures 2 to 5 and 7 of math24.net's page on the double pendulum, as SVG.
#[derive(Debug, Parser)]
#[command(
    name = "cargo figures",
    after_help = "Example: cargo figures --out /tmp/figures"
)]
pub struct FiguresOptions {
    /// Also record an animation of every scene; prints the `cargo demo` command of each
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

    // The animations take minutes, so they are recorded only on request.
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

fn record(scene: SceneName, folder: &Path) -> Result<()> {
    // Each scene is recorded until it has shown everything.
    let seconds = match scene {
        SceneName::Figure7 => "20",
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => "4",
        SceneName::Frequencies => "3",
        SceneName::Flips => "60",
        _ => "10",
    };
    let file = animation(scene, folder);
    let words = [
        "cargo demo",
        "--scene",
        scene.name(),
        "--headless",
        "--seconds",
        seconds,
    ];
    complain(format_args!(
        "{} --record {}",
        words.join(" "),
        file.display()
    ));
    let options = DemoOptions {
        record: Some(file),
        ..DemoOptions::try_parse_from(words)?
    };
    ensure!(
        demo::run(&options)?,
        "{} was recorded with the problems above",
        scene.name()
    );
    Ok(())
}
