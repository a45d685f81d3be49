//! `cargo figures`: writes the book's figures and what the panel shows in every scene.

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use firmware::scenes::SceneName;
use host_tests::commands::figures;
use host_tests::console::cli::{self, say};

/// Draws the book's figures 2 to 5 and 7 from the kernel, as SVG and PNG, and the panel's frame of every scene.
#[derive(Debug, Parser)]
#[command(name = "cargo figures", after_help = "Example: cargo figures --folder /tmp/figures")]
struct Options {
    /// Also record an animation of every scene, each by the `cargo demo` that is printed as it begins
    #[arg(long)]
    animations: bool,
    /// Where to write
    #[arg(long, value_name = "FOLDER", default_value = figures::FOLDER)]
    folder: PathBuf,
}

fn main() -> ExitCode {
    cli::main(write)
}

fn write(Options { animations, folder }: &Options) -> anyhow::Result<()> {
    for (name, bytes) in figures::files()? {
        let path = folder.join(name);
        let unwritable = || format!("cannot write {}", path.display());
        path.parent().map_or(Ok(()), fs::create_dir_all).with_context(unwritable)?;
        fs::write(&path, bytes).with_context(unwritable)?;
    }
    let recorded = if *animations { SceneName::ALL } else { &[] };
    recorded.iter().try_for_each(|&scene| figures::panel::record(scene, folder))?;
    Ok(say(folder.display())?)
}
