//! `cargo figures`: writes the book's figures and what the panel shows in every scene.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use firmware::scenes::SceneName;
use host_tests::commands::figures;
use host_tests::console::cli::{self, Refused, say};

/// Draws the book's figures 2 to 5 and 7 from the kernel, as SVG, and the panel's frame of every scene.
#[derive(Debug, Parser)]
#[command(name = "cargo figures", after_help = "Example: cargo figures --folder /tmp/figures")]
struct Options {
    /// Also record an animation of every scene, each by the `cargo demo` that is printed as it begins
    #[arg(long)]
    animations: bool,
    /// Where to write [default: host-tests/pictures of the project]
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,
}

fn main() -> ExitCode {
    cli::main(write)
}

fn write(Options { animations, folder }: &Options) -> anyhow::Result<()> {
    let folder = &folder.clone().unwrap_or_else(figures::folder);
    let unwritable =
        |path: &Path, error| Refused::because(format_args!("--folder: cannot write {}: {error}", path.display()));
    for subfolder in figures::FOLDERS.map(|name| folder.join(name)) {
        fs::create_dir_all(&subfolder).map_err(|error| unwritable(&subfolder, error))?;
    }
    for (name, bytes) in figures::files()? {
        let path = folder.join(name);
        fs::write(&path, bytes).map_err(|error| unwritable(&path, error))?;
    }
    let recorded = if *animations { SceneName::ALL } else { &[] };
    recorded.iter().try_for_each(|&scene| figures::panel::record(scene, folder))?;
    Ok(say(folder.display())?)
}
