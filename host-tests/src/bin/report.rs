//! `cargo write-report`: writes tables and charts of cost against error.

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::ensure;
use clap::Parser;
use host_tests::commands::report;
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;
use host_tests::emulator::toolchain;

/// Measures every method's cost on the target and its error, and writes them as CSV and as charts.
#[derive(Debug, Parser)]
#[command(name = "cargo write-report", after_help = "Example: cargo write-report --quick --folder /tmp/report")]
struct Options {
    /// Two scenes and two boards, in some minutes
    #[arg(long)]
    quick: bool,
    /// Puts what to take, the main table and the charts into the READMEs
    #[arg(long)]
    readme: bool,
    /// Where to write [default: host-tests/report of the project]
    #[arg(long)]
    folder: Option<PathBuf>,
}

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<()> {
    let (toolchain, _) = toolchain::set_up()?;
    let folder = options.folder.clone().unwrap_or_else(|| toolchain::workspace().join("host-tests/report"));
    let created = fs::create_dir_all(&folder);
    created.map_err(|error| Refused::because(format_args!("--folder: cannot write {}: {error}", folder.display())))?;
    let bar = Bar::start("report", 0);
    let written = report::write(options.quick, &toolchain, &folder, &bar);
    drop(bar);
    let (blocks, absent) = written?;
    absent.iter().chain(&blocks.advice).try_for_each(say)?;
    if options.readme {
        ensure!(absent.is_empty(), "the READMEs keep their figures: some are missing in these");
        blocks.put_into_readmes()?;
    } else if !blocks.is_in_readmes()? {
        say("the READMEs show other figures; cargo write-report --readme puts these there")?;
    }
    Ok(say(folder.display())?)
}
