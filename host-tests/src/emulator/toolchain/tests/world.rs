//! A machine of stubs: how it takes every command that the set-up may run, and what it has been asked to change.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::Duration;

use super::super::system::System;
use super::super::{TARGETS, detect};
use crate::emulator::process::{Output, ProcessError};

/// How a stubbed command ends.
type Ending = Result<Output, ProcessError>;

/// How rustup takes `target add`.
#[derive(Clone, Copy, PartialEq)]
pub enum Rustup {
    Absent,
    Adds,
    Hangs,
    Refuses,
    SkipsInSilence,
}

/// How QEMU is.
#[derive(Clone, Copy, PartialEq)]
pub enum Emulator {
    Absent,
    Broken,
    Runs,
}

/// A machine, and what has been asked of it.
pub struct World {
    pub manager: Option<&'static str>,
    pub root: bool,
    pub rustup: Rustup,
    pub network: bool,
    pub dpkg_is_interrupted: bool,
    pub emulator: Cell<Emulator>,
    /// Another package is in the way of QEMU's.
    pub emulator_is_in_conflict: bool,
    pub emulator_is_unpacked: Cell<bool>,
    /// The version of Node.js, and whether npm has brought the Pico's emulator.
    pub node: Cell<Option<&'static str>>,
    pub rp2040js: Cell<bool>,
    pub targets: Cell<bool>,
    pub debian_packages: RefCell<BTreeSet<String>>,
    pub changes: RefCell<Vec<String>>,
}

/// A Debian with rustup's toolchain and nothing else; rustup can reach no server of its own.
pub fn fresh_debian() -> World {
    World {
        manager: Some("apt-get"),
        root: true,
        rustup: Rustup::Hangs,
        network: true,
        dpkg_is_interrupted: false,
        emulator: Cell::new(Emulator::Absent),
        emulator_is_in_conflict: false,
        emulator_is_unpacked: Cell::new(false),
        node: Cell::new(None),
        rp2040js: Cell::new(false),
        targets: Cell::new(false),
        debian_packages: RefCell::default(),
        changes: RefCell::default(),
    }
}

impl World {
    pub fn changes(&self) -> Vec<String> {
        self.changes.take()
    }

    fn rustup_adds(&self) -> Ending {
        match self.rustup {
            Rustup::Absent => not_started("rustup"),
            Rustup::Adds if self.network => {
                self.targets.set(true);
                says("")
            }
            Rustup::Adds => fails("error: could not download file"),
            Rustup::Refuses => fails("info: syncing\nerror: toolchain 'stable' does not contain component 'rust-std'"),
            Rustup::SkipsInSilence => says(""),
            Rustup::Hangs => {
                Err(ProcessError::TimedOut { program: "rustup".to_owned(), limit: Duration::from_secs(60) })
            }
        }
    }

    fn apt_installs(&self, packages: &[&str]) -> Ending {
        if self.dpkg_is_interrupted {
            return fails("E: dpkg was interrupted, you must manually run 'dpkg --configure -a'");
        }
        if !self.network {
            return fails("E: Failed to fetch: Temporary failure resolving 'deb.debian.org'");
        }
        if self.emulator_is_in_conflict && packages.contains(&"qemu-system-arm") {
            return fails("E: Packages need to be removed but remove is disabled.");
        }
        self.debian_packages.borrow_mut().extend(packages.iter().map(|&package| package.to_owned()));
        if packages.contains(&"qemu-system-arm") {
            self.emulator.set(Emulator::Runs);
        }
        if packages.contains(&"nodejs") {
            self.node.set(Some("v18.19.0"));
        }
        says("")
    }

    fn dpkg_knows(&self, packages: &[&str]) -> Ending {
        let installed = self.debian_packages.borrow();
        if !packages.iter().all(|&package| installed.contains(package)) {
            return fails("dpkg-query: no packages found matching");
        }
        says(&"installed\n".repeat(packages.len()))
    }
}

impl System for World {
    fn run(&self, command: &mut Command, _: Duration, doing: Option<&str>) -> Ending {
        let words: Vec<_> =
            [command.get_program()].into_iter().chain(command.get_args()).map(|word| word.to_str().unwrap()).collect();
        if doing.is_some() {
            self.changes.borrow_mut().push(words.join(" "));
        }
        match words[..] {
            ["rustc", "--print", "sysroot", ..] => says("/sysroot\nx86_64-unknown-linux-gnu\n"),
            ["rustup", "target", "add", ..] => self.rustup_adds(),
            ["apt-get", "update", ..] if self.network => says(""),
            ["apt-get", "update", ..] => fails("E: Failed to fetch: Temporary failure resolving 'deb.debian.org'"),
            ["apt-get", "install", ..] => {
                assert!(words.contains(&"--no-remove") && self.root, "the set-up must not hurt");
                let names = words[2..].iter().filter(|word| !word.starts_with('-') && !word.contains("::"));
                self.apt_installs(&names.copied().collect::<Vec<_>>())
            }
            ["sh", script, folder] => {
                assert!(Path::new(script).is_file(), "{script}");
                assert!(Path::new(folder) == detect::own_qemu_folder());
                self.emulator_is_unpacked.set(self.network);
                if self.network { says("") } else { fails("E: Failed to fetch") }
            }
            ["dpkg-query", "--show", ref query @ ..] => self.dpkg_knows(&query[1..]),
            ["/usr/bin/rustc", "--version"] => says("rustc 1.96.0 (ac68faa20 2026-05-25)"),
            ["/usr/bin/cargo", "--version"] => says("cargo 1.96.0"),
            ["/usr/bin/qemu-system-arm", "--version"] => match self.emulator.get() {
                Emulator::Runs => says("QEMU emulator version 7.2.22\nCopyright"),
                _ => fails("error while loading shared libraries: libfdt.so.1"),
            },
            [own, "--version"] if Path::new(own).starts_with(detect::own_qemu_folder()) => {
                says("QEMU emulator version 7.2.22")
            }
            ["/usr/bin/node", "--version"] => says(self.node.get().unwrap_or_default()),
            ["/usr/bin/node", "--print", _] if self.rp2040js.get() => says("1.4.1"),
            ["/usr/bin/node", "--print", _] => fails("Error: Cannot find module"),
            ["npm", "ci", ..] if self.network => {
                assert!(words.contains(&"--ignore-scripts"), "nothing foreign is run");
                self.rp2040js.set(true);
                says("")
            }
            ["npm", "ci", ..] => fails("npm error network"),
            _ => panic!("an unknown command: {words:?}"),
        }
    }

    fn find(&self, program: &str) -> Option<PathBuf> {
        let is_there = match program {
            "rustup" => self.rustup != Rustup::Absent,
            "qemu-system-arm" => self.emulator.get() != Emulator::Absent,
            "node" | "npm" => self.node.get().is_some(),
            other => self.manager == Some(other),
        };
        is_there.then(|| Path::new("/usr/bin").join(program))
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        if folder == detect::own_qemu_folder() && self.emulator_is_unpacked.get() {
            return vec!["qemu-system-arm".to_owned()];
        }
        let folder = folder.to_str().unwrap();
        let is_target = TARGETS.iter().any(|target| folder == format!("/sysroot/lib/rustlib/{target}/lib"));
        let is_linker = folder == "/sysroot/lib/rustlib/x86_64-unknown-linux-gnu/bin";
        let name = match () {
            () if is_target && self.targets.get() => "libcore-0123.rlib",
            () if is_linker => "rust-lld",
            () => return Vec::new(),
        };
        vec![name.to_owned()]
    }

    fn is_root(&self) -> bool {
        self.root
    }
}

fn says(stdout: &str) -> Ending {
    Ok(Output { status: ExitStatus::from_raw(0), stdout: stdout.to_owned(), stderr: String::new() })
}

fn fails(stderr: &str) -> Ending {
    Ok(Output { status: ExitStatus::from_raw(1 << 8), stdout: String::new(), stderr: stderr.to_owned() })
}

fn not_started(program: &str) -> Ending {
    Err(ProcessError::NotStarted { program: program.to_owned(), source: io::ErrorKind::NotFound.into() })
}
