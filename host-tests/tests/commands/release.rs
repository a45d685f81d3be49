//! The firmware's images are the same on any machine and in any folder. They contain no folder of
//! the builder, and `cargo release-files` makes the same files in another checkout with another
//! cargo folder.

use std::env;
use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use emulator::boards::{PICO, every_board};
use emulator::flash::flash_image;
use emulator::pico::PicoMachine;
use emulator::process::{self, Output};
use emulator::toolchain::{self, target, workspace};

use super::cli::{output, program};
use crate::support::bench::{Bench, at_port_for, wire};
use crate::support::{application, toolchain};

/// A small image that every kind of core runs.
const SMALL: (&str, &str) = ("inject-panic", "thumbv7m-none-eabi");

/// The time limit of a command in the copy, which may build all images, and of the emulated Pico: a
/// whole verification takes 25 s of its own time, and minutes of real time.
const LONG: Duration = Duration::from_secs(3600);

/// Returns cargo's home folder.
fn cargo_home() -> PathBuf {
    let home = || Path::new(&env::var_os("HOME").expect("a home")).join(".cargo");
    env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

/// A copy of the checkout with its own cargo folder and target folder.
struct Elsewhere(tempfile::TempDir);

impl Elsewhere {
    /// Copies the checkout, and shares the downloaded crates and the unpacked QEMU by links.
    fn new(history: History) -> io::Result<Self> {
        let folder = tempfile::tempdir()?;
        let left_out: &[&str] = match history {
            History::Copied => &LEFT_OUT,
            History::LeftOut => &[&LEFT_OUT[..], &[".git"]].concat(),
        };
        copy(workspace(), &folder.path().join("checkout"), left_out)?;

        // The downloaded crates, under other names.
        let home = folder.path().join("cargo");
        fs::create_dir_all(&home)?;
        for name in ["registry", "config.toml"] {
            let there = cargo_home().join(name);
            if there.exists() {
                symlink(there, home.join(name))?;
            }
        }
        // The tools are shared; only the builds are separate.
        let elsewhere = Self(folder);
        fs::create_dir_all(elsewhere.target())?;
        symlink(target().join("qemu"), elsewhere.target().join("qemu"))?;
        Ok(elsewhere)
    }

    /// Returns the folder of the copy.
    fn checkout(&self) -> PathBuf {
        self.0.path().join("checkout")
    }

    /// Returns the target folder of the copy.
    fn target(&self) -> PathBuf {
        self.checkout().join("target")
    }

    /// Runs a command of the project there.
    fn output(&self, command: &mut Command) -> Output {
        command
            .current_dir(self.checkout())
            .env("CARGO_MANIFEST_DIR", self.checkout().join("host-tests"))
            .env("CARGO_HOME", self.0.path().join("cargo"))
            .env_remove("CARGO_TARGET_DIR");
        process::run(command, LONG).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// The folders that are built or downloaded.
const LEFT_OUT: [&str; 2] = ["target", "node_modules"];

/// The commits of a checkout. The packaged kernel contains the last one.
enum History {
    /// The commits are copied.
    Copied,
    /// The copy has no commits.
    LeftOut,
}

/// Copies the files of a folder, except those with these names. A link stays a link: a file in its
/// place would be an uncommitted change.
fn copy(from: &Path, to: &Path, left_out: &[&str]) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default();
        let to = to.join(name);
        if left_out.iter().any(|not| *not == name) {
            continue;
        } else if path.is_symlink() {
            symlink(fs::read_link(&path)?, &to)?;
        } else if path.is_dir() {
            copy(&path, &to, left_out)?;
        } else {
            fs::copy(&path, &to)?;
        }
    }
    Ok(())
}

/// The ELF file of no board's application contains the path of the workspace, the target folder,
/// cargo's home or the compiler.
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

/// A small program is built here and in a copy of the checkout. Both ELF files are equal as a
/// whole, and so are the bytes that are loaded. The copy's program runs.
#[test]
#[ignore = "compiles for half a minute; `.ci/run` runs it"]
fn an_image_built_elsewhere_has_the_same_bytes() -> anyhow::Result<()> {
    let (binary, chip) = SMALL;
    let here = toolchain()
        .build(binary, chip)
        .unwrap_or_else(|error| panic!("{error}"));
    let elsewhere = Elsewhere::new(History::LeftOut)?;

    // The command also runs the image, which ends with a panic as intended.
    let mut command = program("fw");
    command.arg(binary);
    let ran = elsewhere.output(&mut command);
    assert!(
        ran.stdout.contains("injected with the number 42"),
        "{ran:?}"
    );

    // The image is compared as loaded bytes and as a whole file.
    let there = elsewhere
        .target()
        .join("firmware")
        .join(chip)
        .join("release")
        .join(binary);
    let [here, there] = [here, there].map(fs::read);
    let [here, there] = [here?, there?];
    assert!(flash_image(&here)? == flash_image(&there)?, "loaded bytes");
    assert!(here == there, "the ELF file");
    Ok(())
}

/// The release files that are made here and elsewhere are equal, and a board that was flashed with
/// the other's file is verified.
#[test]
#[ignore = "builds every image twice, and a board answers for minutes"]
fn a_release_made_elsewhere_is_the_same_and_is_verified_here() -> anyhow::Result<()> {
    let elsewhere = Elsewhere::new(History::Copied)?;
    let here = output(&mut program("release-files"));
    assert!(here.status.success(), "{}", here.stderr);
    let there = elsewhere.output(&mut program("release-files"));
    assert!(there.status.success(), "{}", there.stderr);

    // The checksums of both releases are equal.
    let sums = |folder: PathBuf| fs::read_to_string(folder.join("release-files/SHA256SUMS"));
    let here = sums(target())?;
    let there = sums(elsewhere.target())?;
    assert_eq!(here, there);
    assert_eq!(here.lines().count(), every_board().count() + 3, "{here}");

    // A board with the image from elsewhere is verified by this checkout.
    let blocks = fs::read(elsewhere.target().join("release-files/pico.uf2"))?;
    let node = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    let board = PicoMachine::flashed(&node, &blocks, &application(&PICO), LONG)?;
    let folder = tempfile::tempdir()?;
    let mut command = program("verify-board");
    command
        .args(["--no-questions", "--report"])
        .arg(folder.path().join("pico"));
    let verified = at_port_for(LONG, &mut Bench::with(board), &mut command, |bench| {
        bench.carry(wire);
    });
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    let report = fs::read_to_string(folder.path().join("pico.md"))?;
    assert!(report.contains(": built from commit "), "{report}");
    Ok(())
}
