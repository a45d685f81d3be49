//! The firmware's images are the same on any machine and in any folder, and contain no folder of
//! the builder.

use std::env;
use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use boards::flash::image::flash_image;
use boards::process::{self, Output};
use boards::toolchain::{target, workspace};
use boards::{LM3S6965EVB, every_board};

use super::cli::{output, program};
use crate::support::application;

const LONG: Duration = Duration::from_secs(3600);

fn cargo_home() -> PathBuf {
    let home = || Path::new(&env::var_os("HOME").expect("a home")).join(".cargo");
    env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

struct Elsewhere(tempfile::TempDir);

impl Elsewhere {
    fn new() -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        copy(workspace(), &folder.path().join("checkout"))?;

        let home = folder.path().join("cargo");
        fs::create_dir_all(&home)?;
        for name in ["registry", "config.toml"] {
            let there = cargo_home().join(name);
            if there.exists() {
                symlink(there, home.join(name))?;
            }
        }
        let elsewhere = Self(folder);
        fs::create_dir_all(elsewhere.target())?;
        symlink(target().join("qemu"), elsewhere.target().join("qemu"))?;
        Ok(elsewhere)
    }

    fn checkout(&self) -> PathBuf {
        self.0.path().join("checkout")
    }

    fn target(&self) -> PathBuf {
        self.checkout().join("target")
    }

    fn output(&self, command: &mut Command) -> Output {
        command
            .current_dir(self.checkout())
            .env("CARGO_MANIFEST_DIR", self.checkout().join("host-tests"))
            .env("CARGO_HOME", self.0.path().join("cargo"))
            .env_remove("CARGO_TARGET_DIR");
        process::run(command, LONG).unwrap_or_else(|error| panic!("{error}"))
    }
}

const LEFT_OUT: [&str; 3] = ["target", "node_modules", ".git"];

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default();
        let to = to.join(name);
        if LEFT_OUT.iter().any(|not| *not == name) {
            continue;
        } else if path.is_symlink() {
            symlink(fs::read_link(&path)?, &to)?;
        } else if path.is_dir() {
            copy(&path, &to)?;
        } else {
            fs::copy(&path, &to)?;
        }
    }
    Ok(())
}

#[test]
fn no_folder_of_the_builder_is_in_an_image() {
    let sysroot = output(Command::new("rustc").args(["--print", "sysroot"])).stdout;
    let folders = [
        workspace().display().to_string(),
        target().display().to_string(),
        cargo_home().display().to_string(),
        sysroot.trim().to_owned(),
    ];
    for board in every_board() {
        let elf = fs::read(application(board)).expect("an ELF file");
        let text = String::from_utf8_lossy(&elf);
        for folder in &folders {
            // An empty path would be found in every file.
            assert!(folder.len() > 1);
            assert!(!text.contains(folder), "{}: {folder}", board.name);
        }
    }
}

#[test]
#[ignore = "compiles for half a minute; `.ci/run` runs it"]
fn an_image_built_elsewhere_has_the_same_bytes() -> anyhow::Result<()> {
    let board = &LM3S6965EVB;
    let here = application(board);
    let elsewhere = Elsewhere::new()?;

    let mut command = program("fw");
    command.args([board.binary, "--seconds", "5"]);
    let ran = elsewhere.output(&mut command);
    assert!(ran.stdout.contains("boot: lm3s6965evb"), "{ran:?}");

    let there = elsewhere
        .target()
        .join("firmware")
        .join(board.target)
        .join("release")
        .join(board.binary);
    let [here, there] = [here, there].map(fs::read);
    let [here, there] = [here?, there?];
    assert!(flash_image(&here)? == flash_image(&there)?, "loaded bytes");
    assert!(here == there, "the ELF file");
    Ok(())
}
