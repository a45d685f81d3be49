//! `cargo figures`: writes the book's figures.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::Parser;
use host_tests::{cli, figures};

/// Draws the book's figures 2 to 5 and 7 from the kernel, as SVG and PNG.
#[derive(Debug, Parser)]
#[command(name = "cargo figures")]
struct Options {
    /// Where to write
    #[arg(long, default_value = figures::FOLDER)]
    folder: PathBuf,
}

fn main() -> ExitCode {
    let options: Options = match cli::parse() {
        Ok(options) => options,
        Err(code) => return code,
    };
    match write(&options.folder) {
        Ok(()) => {
            println!("{}", options.folder.display());
            ExitCode::SUCCESS
        }
        Err(error) => cli::refuse(format!("{error:#}")),
    }
}

fn write(folder: &Path) -> anyhow::Result<()> {
    for (name, bytes) in figures::files()? {
        let path = folder.join(name);
        let unwritable = || format!("cannot write {}", path.display());
        path.parent().map_or(Ok(()), fs::create_dir_all).with_context(unwritable)?;
        fs::write(&path, bytes).with_context(unwritable)?;
    }
    Ok(())
}
