//! `cargo write-report`: every method's cost on the target against its error, as CSV and charts.
//!
//! Costs are counted on the emulated targets, errors are computed on the host, which is allowed because the bits are the
//! same (test `identity`). Nothing is timed, so two runs write the same files.

pub mod accuracy;
mod c_peers;
mod chart;
pub mod join;
mod readme;

use std::fs;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use clap::Parser;

use crate::commands::count::Target;
use crate::console::cli::{say, unwritable, write};
use crate::console::progress::Progress;
use crate::emulator::toolchain;
use accuracy::SCENES;

/// Measures every method's cost on the target and its error, and writes them as CSV and as charts.
#[derive(Debug, Parser)]
#[command(name = "cargo write-report", after_help = "Example: cargo write-report --out /tmp/report")]
pub struct ReportOptions {
    /// Puts what to take, the main table and the charts into the READMEs
    #[arg(long)]
    readme: bool,
    /// Where to write [default: host-tests/report of the project]
    #[arg(long, alias = "folder", value_name = "FOLDER")]
    out: Option<PathBuf>,
}

pub fn run(options: &ReportOptions) -> Result<()> {
    let toolchain = toolchain::set_up()?;
    let folder = options.out.clone().unwrap_or_else(|| toolchain::workspace().join("host-tests/report"));
    fs::create_dir_all(&folder).map_err(|error| unwritable("--out", &folder, &error))?;
    let targets = Target::build_all(&toolchain)?;
    let bar = Progress::of("comparing and counting", join::methods().count() as u64);
    let (mut points, absent) = join::join(&toolchain, &targets, &|| bar.advance(1))?;
    drop(bar);
    join::mark_dominated(&mut points);
    write(&folder.join("speed-against-error.csv"), join::table(&points).csv())?;
    let mut charts = Vec::new();
    for (scene, target) in SCENES.iter().flat_map(|scene| targets.iter().map(move |target| (scene, target))) {
        let svg = chart::speed_against_error(&points, scene, target.board)?;
        charts.push((format!("{}-{}.svg", scene.name, target.board.cpu), svg));
    }
    charts.iter().try_for_each(|(name, svg)| write(&folder.join(name), svg))?;
    let advice = readme::advice(&points);
    absent.iter().chain(&advice).try_for_each(say)?;
    let pages = readme::pages(&advice, &points)?;
    if options.readme {
        ensure!(absent.is_empty(), "the READMEs keep their figures: some are missing in these");
        pages.iter().try_for_each(|(path, [_, made])| fs::write(path, made))?;
        let shown = toolchain::workspace().join(readme::CHARTS);
        let mut regular = charts.iter().filter(|(name, _)| name.starts_with(SCENES[0].name));
        regular.try_for_each(|(name, svg)| write(&shown.join(name), svg))?;
    } else if pages.iter().any(|(_, [page, made])| page != made) {
        say("the READMEs show other figures; cargo write-report --readme puts these there")?;
    }
    Ok(say(folder.display())?)
}
