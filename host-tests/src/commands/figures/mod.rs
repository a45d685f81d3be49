//! `cargo figures`: the book's figures 2 to 5 and 7 from the kernel, and what the panel shows in every scene.
//!
//! Nothing in these files depends on the machine, so two runs write the same files.

pub mod chaos;
mod sheet;
pub mod small;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Parser;
use firmware::config::TICK_RATE;
use firmware::scenes::SceneName;

use crate::commands::demo::{self, DemoOptions, record::png};
use crate::console::cli::{complain, say, unwritable, write};
use crate::emulator::host::Show;
use crate::emulator::qemu::Screenshot;
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
    let panels = SceneName::ALL.iter().map(|&scene| Ok((panel_file(scene, "png"), screenshot(scene)?)));
    figures.chain(panels).collect()
}

pub fn run(options: &FiguresOptions) -> Result<()> {
    let folder = options.out.clone().unwrap_or_else(folder);
    std::fs::create_dir_all(&folder).map_err(|error| unwritable("--out", &folder, &error))?;
    for (name, bytes) in files()? {
        write(&folder.join(name), &bytes)?;
    }
    if options.animations {
        SceneName::ALL.iter().try_for_each(|&scene| record(scene, &folder))?;
    }
    Ok(say(folder.display())?)
}

/// The moment of a scene's frame, ticks: what moves is well under way; the map of flips is finished.
fn moment(scene: SceneName) -> u32 {
    TICK_RATE * if scene == SceneName::Flips { 60 } else { 8 }
}

pub fn panel_file(scene: SceneName, kind: &str) -> String {
    format!("panel/{}.{kind}", scene.name())
}

/// The screenshot of a scene as a PNG file. The panel of the emulated board shows the same (test `boards scenes`).
fn screenshot(name: SceneName) -> Result<Vec<u8>> {
    let mut scene = Show::new(name, &name.first_settings())?;
    (0..moment(name)).for_each(|_| scene.tick());
    png(&Screenshot::from(&scene.frame()))
}

/// How long the animation of a scene is, s: until all that it has to show has been seen.
fn seconds(scene: SceneName) -> f64 {
    match scene {
        SceneName::Figure7 => 20.0,
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => 4.0,
        SceneName::Frequencies => 3.0,
        SceneName::Flips => 60.0,
        _ => 10.0,
    }
}

/// Records the animation of a scene into `folder`, as `cargo demo --headless` does, and says by which command.
fn record(scene: SceneName, folder: &Path) -> Result<()> {
    let path = folder.join(panel_file(scene, "gif"));
    let (name, seconds) = (scene.name(), seconds(scene).to_string());
    complain(format_args!("cargo demo --scene {name} --headless --seconds {seconds} --record {}", path.display()));
    let words = ["cargo demo", "--scene", name, "--headless", "--seconds", &seconds, "--record"];
    let options = DemoOptions::try_parse_from(words.iter().map(OsStr::new).chain([path.as_os_str()]))?;
    ensure!(demo::run(&options)?, "not all was well in {}", scene.name());
    Ok(())
}
