//! `cargo release-files`: all files of a release, in one folder. The same commit and compiler make
//! the same bytes on any machine.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use clap::Parser;

use crate::web;
use boards::console::cli::{Refused, say};
use boards::every_board;
use boards::flash;
use boards::out_file;
use boards::process;
use boards::toolchain::{self, QUICK, target, workspace};
use firmware::graphics::PanelName;

const FOLDER: &str = "release-files";
/// The file of checksums, in the format that `sha256sum --check` reads.
const SUMS: &str = "SHA256SUMS";
const PACKAGE: Duration = Duration::from_secs(300);
const KERNEL: &str = "double-pendulum-kernel";
/// The programs that print checksums in that format, with their arguments.
const HASHERS: [(&str, &[&str]); 2] = [("sha256sum", &[]), ("shasum", &["-a", "256"])];

/// Makes target/release-files/: the Pico's UF2 for each panel, the ELF file of every board, the page for a
/// browser, the packaged kernel, and their SHA-256 sums.
///
/// The files depend only on the commit and the compiler, not on folders or the machine. Uncommitted
/// changes are included.
#[derive(Debug, Parser)]
#[command(name = "cargo release-files")]
pub struct ReleaseOptions {}

pub fn run(_: &ReleaseOptions) -> anyhow::Result<()> {
    let hasher = HASHERS
        .iter()
        .find(|(program, _)| toolchain::find(program).is_some());
    let Some((hasher, arguments)) = hasher else {
        bail!(Refused::because(
            "neither sha256sum nor shasum is installed: a release needs one, as in the package \
             coreutils"
        ));
    };
    let toolchain = toolchain::set_up_to_flash()?;
    let folder = target().join(FOLDER);
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;

    for board in every_board() {
        let elf = toolchain.build_for(board)?;
        copy(&elf, &folder.join(format!("{}.elf", board.name)))?;
    }
    for panel in PanelName::ALL {
        let (_, file) = flash::uf2_file(&toolchain, *panel)?;
        copy(&file, &folder.join(flash::file_name(*panel)))?;
    }

    copy(&web::write_page()?, &folder.join(web::FILE))?;

    let scratch = tempfile::tempdir_in(target())?;
    package(scratch.path())?;
    let archive = format!("{KERNEL}-{}.crate", env!("CARGO_PKG_VERSION"));
    copy(
        &scratch.path().join("package").join(&archive),
        &folder.join(archive),
    )?;

    let mut names: Vec<_> = fs::read_dir(&folder)?
        .map(|entry| Ok(entry?.file_name()))
        .collect::<Result<_, std::io::Error>>()?;
    names.sort();
    let mut command = Command::new(hasher);
    command.args(*arguments).args(names).current_dir(&folder);
    let sums = process::run(&mut command, QUICK)?;
    ensure!(sums.status.success(), "{hasher}: {}", sums.stderr);
    out_file::write("the sums", &folder.join(SUMS), &sums.stdout)?;
    say(sums.stdout.trim_end())?;
    Ok(say(folder.display())?)
}

fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    fs::copy(from, to).with_context(|| from.display().to_string())?;
    Ok(())
}

/// Cargo contacts the registry only if the data on this machine is not sufficient.
fn package(into: &Path) -> anyhow::Result<()> {
    let attempt = |more: &[&str]| {
        let mut cargo = Command::new("cargo");
        cargo
            .args([
                "package",
                "--package",
                KERNEL,
                "--no-verify",
                "--allow-dirty",
            ])
            .arg("--target-dir")
            .arg(into)
            .args(more)
            .current_dir(workspace());
        process::run(&mut cargo, PACKAGE)
    };
    // Without the network the package is the same, if the index is on this machine.
    if attempt(&["--offline"])?.status.success() {
        return Ok(());
    }
    let output = attempt(&[])?;
    ensure!(
        output.status.success(),
        "the kernel cannot be packaged\n{}",
        output.stderr
    );
    Ok(())
}
