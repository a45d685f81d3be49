//! Every decision of the set-up, in a world of stubs. No command is run here.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};
use std::time::Duration;

use super::error::Part;
use super::system::System;
use super::{ArmCore, SetupError, TARGETS, Toolchain, detect, install};
use crate::process::{Output, ProcessError};

/// How a stubbed command ends.
type Ending = Result<Output, ProcessError>;

/// How rustup takes `target add`.
#[derive(Clone, Copy, PartialEq)]
enum Rustup {
    Absent,
    Adds,
    Hangs,
    Refuses,
    SkipsInSilence,
}

/// How QEMU is.
#[derive(Clone, Copy, PartialEq)]
enum Emulator {
    Absent,
    Broken,
    Runs,
}

/// A machine, and what has been asked of it.
struct World {
    manager: Option<&'static str>,
    root: bool,
    rustup: Rustup,
    network: bool,
    disk_is_full: Cell<bool>,
    has_linker: bool,
    debian_compiler: &'static str,
    lists_are_there: Cell<bool>,
    dpkg_is_interrupted: Cell<bool>,
    dependencies_are_unmet: Cell<bool>,
    emulator: Cell<Emulator>,
    /// Another package is in the way of QEMU's.
    emulator_is_in_conflict: bool,
    emulator_is_unpacked: Cell<bool>,
    reinstall_helps: bool,
    has_package: fn(&str) -> bool,
    targets: Cell<bool>,
    debian_packages: RefCell<BTreeSet<String>>,
    changes: RefCell<Vec<String>>,
}

/// A Debian with rustup's toolchain and nothing else; rustup can reach no server of its own.
fn fresh_debian() -> World {
    World {
        manager: Some("apt-get"),
        root: true,
        rustup: Rustup::Hangs,
        network: true,
        disk_is_full: Cell::new(false),
        has_linker: true,
        debian_compiler: "rustc 1.96.0 (ac68faa20 2026-05-25)",
        lists_are_there: Cell::new(false),
        dpkg_is_interrupted: Cell::new(false),
        dependencies_are_unmet: Cell::new(false),
        emulator: Cell::new(Emulator::Absent),
        emulator_is_in_conflict: false,
        emulator_is_unpacked: Cell::new(false),
        reinstall_helps: true,
        has_package: |_| true,
        targets: Cell::new(false),
        debian_packages: RefCell::default(),
        changes: RefCell::default(),
    }
}

impl World {
    fn changes(&self) -> Vec<String> {
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
        if self.dpkg_is_interrupted.get() {
            return fails("E: dpkg was interrupted, you must manually run 'dpkg --configure -a'");
        }
        if self.dependencies_are_unmet.get() {
            self.dependencies_are_unmet.set(!packages.is_empty());
            return if packages.is_empty() { says("") } else { fails("E: Unmet dependencies. Try ...") };
        }
        if let Some(unknown) = packages.iter().find(|name| !self.lists_are_there.get() || !(self.has_package)(name)) {
            return fails(&format!("Reading package lists...\nE: Unable to locate package {unknown}"));
        }
        if !self.network {
            return fails("E: Failed to fetch: Temporary failure resolving 'deb.debian.org'");
        }
        if self.disk_is_full.get() {
            return fails(
                "dpkg: error processing archive qemu.deb (--unpack):\n cannot copy extracted data: failed to write (No \
                 space left on device)\nE: Sub-process /usr/bin/dpkg returned an error code (1)",
            );
        }
        if self.emulator_is_in_conflict && packages.contains(&"qemu-system-arm") {
            return fails("E: Packages need to be removed but remove is disabled.");
        }
        self.debian_packages.borrow_mut().extend(packages.iter().map(|&package| package.to_owned()));
        if packages.contains(&"qemu-system-arm") && (self.emulator.get() == Emulator::Absent || self.reinstall_helps) {
            self.emulator.set(Emulator::Runs);
        }
        says("")
    }

    fn dpkg_knows(&self, packages: &[&str]) -> Ending {
        let installed = self.debian_packages.borrow();
        if !packages.iter().all(|&package| installed.contains(package)) {
            return fails("dpkg-query: no packages found matching");
        }
        let state = if self.dpkg_is_interrupted.get() { "unpacked\n" } else { "installed\n" };
        says(&state.repeat(packages.len()))
    }

    fn apt_updates(&self) -> Ending {
        if !self.network {
            return fails("E: Failed to fetch: Temporary failure resolving 'deb.debian.org'");
        }
        self.lists_are_there.set(true);
        says("")
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
            ["apt-get", "update", ..] => self.apt_updates(),
            ["apt-get", "install", ..] => {
                assert!(words.contains(&"--no-remove") && self.root, "the set-up must not hurt");
                let names = words[2..].iter().filter(|word| !word.starts_with('-') && !word.contains("::"));
                self.apt_installs(&names.copied().collect::<Vec<_>>())
            }
            ["sh", script, folder] => {
                assert!(script.ends_with("unpack-qemu.sh") && Path::new(folder) == detect::own_qemu_folder());
                self.emulator_is_unpacked.set(self.network);
                if self.network { says("") } else { fails("E: Failed to fetch") }
            }
            ["dpkg", "--configure", "-a"] => {
                self.dpkg_is_interrupted.set(false);
                if self.dependencies_are_unmet.get() { fails("dpkg: error: rustc-web") } else { says("") }
            }
            ["dpkg-query", "--show", ref query @ ..] => self.dpkg_knows(&query[1..]),
            ["/usr/bin/rustc", "--version"] => says(self.debian_compiler),
            ["/usr/bin/cargo", "--version"] => says("cargo 1.96.0"),
            ["/usr/bin/qemu-system-arm", "--version"] => match self.emulator.get() {
                Emulator::Runs => says("QEMU emulator version 7.2.22\nCopyright"),
                _ => fails("error while loading shared libraries: libfdt.so.1"),
            },
            [own, "--version"] if Path::new(own).starts_with(detect::own_qemu_folder()) => {
                says("QEMU emulator version 7.2.22")
            }
            _ => panic!("an unknown command: {words:?}"),
        }
    }

    fn find(&self, program: &str) -> Option<PathBuf> {
        let is_there = match program {
            "rustup" => self.rustup != Rustup::Absent,
            "qemu-system-arm" => self.emulator.get() != Emulator::Absent,
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
            () if is_linker && self.has_linker => "rust-lld",
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

fn set_up(world: &World) -> (Toolchain, Vec<String>) {
    install::set_up(world).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(world: &World) -> SetupError {
    install::set_up(world).expect_err("this cannot be set up")
}

/// The verbs of the changes, in order: `install`, `update`, ...
fn verbs(changes: &[String]) -> Vec<&str> {
    changes.iter().filter_map(|change| change.split(' ').nth(1)).collect()
}

fn is_from_source(toolchain: &Toolchain) -> bool {
    matches!(&toolchain.core, ArmCore::FromSource { linker, .. } if linker.ends_with("x86_64-unknown-linux-gnu/bin"))
}

#[test]
fn a_fresh_debian_gets_everything_in_one_go() {
    let world = fresh_debian();
    let (toolchain, done) = set_up(&world);
    assert!(is_from_source(&toolchain));
    assert_eq!(toolchain.qemu(), Path::new("/usr/bin/qemu-system-arm"));
    let changes = world.changes();
    assert_eq!(verbs(&changes), ["target", "update", "install"]);
    assert!(changes[2].ends_with("rustc-web cargo-web rust-web-src qemu-system-arm"), "{}", changes[2]);
    assert_eq!(done[0], "apt-get installed rustc-web, cargo-web, rust-web-src, qemu-system-arm");
    assert_eq!(done[1], "because rustup was still running after 60 s and was stopped");
}

#[test]
fn a_second_run_changes_nothing() {
    for rustup in [Rustup::Hangs, Rustup::Adds] {
        let world = World { rustup, ..fresh_debian() };
        let (first, _) = set_up(&world);
        world.changes();
        let (second, done) = set_up(&world);
        assert_eq!((first, done.len()), (second, 0));
        assert!(world.changes().is_empty());
    }
}

#[test]
fn present_targets_are_used_as_they_are() {
    let world = World { targets: Cell::new(true), emulator: Cell::new(Emulator::Runs), root: false, ..fresh_debian() };
    assert_eq!(set_up(&world).0.core, ArmCore::ReadyMade);
    assert!(world.changes().is_empty());
}

#[test]
fn rustup_is_preferred_and_spares_debians_compiler() {
    let world = World { rustup: Rustup::Adds, lists_are_there: Cell::new(true), ..fresh_debian() };
    assert_eq!(set_up(&world).0.core, ArmCore::ReadyMade);
    let changes = world.changes();
    assert_eq!(verbs(&changes), ["target", "update", "install"]);
    assert!(changes[2].ends_with("Acquire::Retries=1 --no-install-recommends --no-remove qemu-system-arm"));
}

#[test]
fn whatever_keeps_rustup_from_adding_leads_to_debians_sources() {
    for rustup in [Rustup::Absent, Rustup::Hangs, Rustup::Refuses, Rustup::SkipsInSilence] {
        let world = World { rustup, ..fresh_debian() };
        assert!(is_from_source(&set_up(&world).0));
    }
}

#[test]
fn where_installing_would_remove_a_package_the_emulator_is_unpacked() {
    for rustup in [Rustup::Hangs, Rustup::Adds] {
        let world = World { rustup, emulator_is_in_conflict: true, ..fresh_debian() };
        let (toolchain, _) = set_up(&world);
        assert_eq!(toolchain.qemu(), detect::own_qemu_folder().join("qemu-system-arm"));
        assert_eq!(is_from_source(&toolchain), rustup == Rustup::Hangs);
        world.changes();
        assert_eq!((set_up(&world).0, world.changes().len()), (toolchain, 0));
    }
}

#[test]
fn an_interrupted_dpkg_is_healed() {
    let world = World { lists_are_there: Cell::new(true), dpkg_is_interrupted: Cell::new(true), ..fresh_debian() };
    set_up(&world);
    assert_eq!(verbs(&world.changes()), ["target", "update", "install", "--configure", "install"]);
}

#[test]
fn what_lacks_its_dependencies_is_completed() {
    let world = World { dpkg_is_interrupted: Cell::new(true), ..fresh_debian() };
    world.dependencies_are_unmet.set(true);
    set_up(&world);
    let changes = world.changes();
    assert_eq!(verbs(&changes), ["target", "update", "install", "--configure", "install", "install", "install"]);
    assert!(changes[5].contains("--fix-broken") && changes[5].contains("--no-remove"), "{}", changes[5]);
}

#[test]
fn half_installed_packages_do_not_count() {
    let world = fresh_debian();
    set_up(&world);
    world.dpkg_is_interrupted.set(true);
    assert!(detect::toolchain(&world).is_err());
    world.changes();
    set_up(&world);
    assert_eq!(verbs(&world.changes()), ["target", "update", "install", "--configure", "install"]);
}

#[test]
fn a_broken_emulator_is_installed_anew() {
    let world = World { targets: Cell::new(true), lists_are_there: Cell::new(true), ..fresh_debian() };
    world.emulator.set(Emulator::Broken);
    set_up(&world);
    let changes = world.changes();
    assert!(changes[1].ends_with("--reinstall qemu-system-arm"), "{}", changes[1]);
}

#[test]
fn an_emulator_that_stays_broken_is_reported() {
    let world =
        World { targets: Cell::new(true), lists_are_there: Cell::new(true), reinstall_helps: false, ..fresh_debian() };
    world.emulator.set(Emulator::Broken);
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::Qemu]);
    assert!(error.reason.contains("/usr/bin/qemu-system-arm does not run: error while loading"), "{error}");
}

#[test]
fn without_root_nothing_is_begun() {
    let world = World { root: false, ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
    assert!(world.changes().is_empty());
    assert_eq!(
        error.to_string(),
        "error: the ARM core library and qemu-system-arm are missing: only root may install packages. What brings it:\n  \
         rustup target add thumbv7m-none-eabi thumbv7em-none-eabihf   or   \
         sudo apt-get install --no-install-recommends rustc-web cargo-web rust-web-src\n  \
         sudo apt-get install --no-install-recommends qemu-system-arm"
    );
}

#[test]
fn without_root_rustup_may_still_bring_the_core_library() {
    let world = World { root: false, rustup: Rustup::Adds, emulator: Cell::new(Emulator::Runs), ..fresh_debian() };
    assert_eq!(set_up(&world).0.core, ArmCore::ReadyMade);
}

#[test]
fn without_network_the_cause_is_named() {
    for lists in [false, true] {
        let world = World { network: false, lists_are_there: Cell::new(lists), ..fresh_debian() };
        let error = refusal(&world);
        assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
        assert!(error.reason.contains("Temporary failure resolving 'deb.debian.org'"), "{error}");
        assert!(!world.targets.get() && world.debian_packages.borrow().is_empty());
    }
}

#[test]
fn a_full_disk_is_named_and_the_next_run_heals_it() {
    let world = World { disk_is_full: Cell::new(true), ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
    assert!(error.reason.ends_with("apt-get: the disk is full"), "{error}");
    world.disk_is_full.set(false);
    assert!(is_from_source(&set_up(&world).0));
}

#[test]
fn another_system_is_told_its_own_command() {
    for (manager, command) in [
        (Some("dnf"), "\n  sudo dnf install qemu-system-arm"),
        (Some("pacman"), "\n  sudo pacman -S qemu-system-arm"),
        (Some("brew"), "\n  brew install qemu"),
        (None, "\n  brew install qemu"),
    ] {
        let world = World { manager, ..fresh_debian() };
        let text = refusal(&world).to_string();
        assert!(text.ends_with(command) && text.contains("rustup target add") && text.contains("no apt-get"), "{text}");
        assert_eq!(text.contains("apt-get install"), manager.is_none(), "{text}");
        assert!(world.changes().is_empty());
    }
}

#[test]
fn a_debian_without_these_packages_installs_none() {
    let world = World { has_package: |name| name == "qemu-system-arm", ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
    assert!(error.reason.ends_with("; apt-get: Unable to locate package rustc-web"), "{error}");
    assert!(error.reason.starts_with("rustup was still running after 60 s"), "{error}");
}

#[test]
fn an_old_debian_compiler_will_not_do() {
    let world = World { debian_compiler: "rustc 1.63.0", ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore]);
    assert!(error.reason.contains("1.63.0"), "{error}");
}

#[test]
fn without_a_linker_no_package_is_installed() {
    let world = World { has_linker: false, ..fresh_debian() };
    let error = refusal(&world);
    assert!(error.reason.contains("there is no rust-lld"), "{error}");
    assert_eq!(verbs(&world.changes()), ["target"]);
}

#[test]
fn looking_changes_nothing_and_points_at_the_set_up() {
    let world = fresh_debian();
    let error = detect::toolchain(&world).expect_err("nothing is there");
    assert!(world.changes().is_empty());
    let untried = SetupError { tried: false, ..error };
    assert!(untried.to_string().contains("\n  cargo setup   or else by hand:\n  rustup target add"), "{untried}");
}
