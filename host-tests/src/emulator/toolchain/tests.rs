//! Every decision of the set-up, in a world of stubs. No command is run here.

mod world;

use std::cell::Cell;
use std::path::Path;

use super::error::Part;
use super::{ArmCore, SetupError, Toolchain, detect, install, rp2040js};
use world::{Emulator, Rustup, World, fresh_debian};

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
    let world = World { rustup: Rustup::Adds, ..fresh_debian() };
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
fn an_interrupted_dpkg_is_told_by_its_own_words() {
    let world = World { dpkg_is_interrupted: true, ..fresh_debian() };
    let error = refusal(&world);
    assert!(error.reason.contains("you must manually run 'dpkg --configure -a'"), "{error}");
    assert_eq!(verbs(&world.changes()), ["target", "update", "install"]);
}

#[test]
fn a_broken_emulator_is_installed_anew() {
    let world = World { targets: Cell::new(true), ..fresh_debian() };
    world.emulator.set(Emulator::Broken);
    set_up(&world);
    let changes = world.changes();
    assert!(changes[1].ends_with("--reinstall qemu-system-arm"), "{}", changes[1]);
}

#[test]
fn without_root_nothing_is_begun() {
    let world = World { root: false, ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
    assert!(world.changes().is_empty());
    assert_eq!(
        error.to_string(),
        "the ARM core library and qemu-system-arm are missing: only root may install packages. What brings it:\n  \
         rustup target add thumbv6m-none-eabi thumbv7m-none-eabi thumbv7em-none-eabihf   or   \
         sudo apt-get install --no-install-recommends rustc-web cargo-web rust-web-src\n  \
         sudo apt-get install --no-install-recommends qemu-system-arm"
    );
}

#[test]
fn without_network_the_cause_is_named() {
    let world = World { network: false, ..fresh_debian() };
    let error = refusal(&world);
    assert_eq!(error.missing, [Part::ArmCore, Part::Qemu]);
    assert!(error.reason.contains("Temporary failure resolving 'deb.debian.org'"), "{error}");
    assert!(!world.targets.get() && world.debian_packages.borrow().is_empty());
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
fn looking_changes_nothing_and_points_at_the_set_up() {
    let world = fresh_debian();
    let error = detect::toolchain(&world).expect_err("nothing is there");
    assert!(world.changes().is_empty());
    let untried = SetupError { tried: false, ..error };
    assert!(untried.to_string().contains("\n  cargo setup   or else by hand:\n  rustup target add"), "{untried}");
}

#[test]
fn the_picos_emulator_is_fetched_by_npm_which_debian_brings() {
    let world = fresh_debian();
    let (emulator, done) = rp2040js::set_up(&world).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(emulator.node(), Path::new("/usr/bin/node"));
    assert_eq!(done, ["apt-get installed nodejs, npm", "npm fetched rp2040js"]);
    assert_eq!(verbs(&world.changes()), ["update", "install", "ci"]);
    let (again, done) = rp2040js::set_up(&world).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((again, done.len(), world.changes().len()), (emulator, 0, 0));
}

#[test]
fn what_keeps_the_picos_emulator_away_is_said_with_what_brings_it() {
    let refused = |world: World| rp2040js::set_up(&world).expect_err("this cannot be set up").to_string();
    let told = refused(World { root: false, ..fresh_debian() });
    assert!(told.contains("only root may install packages") && told.contains("apt-get install"), "{told}");
    let told = refused(World { node: Cell::new(Some("v20.0.0")), network: false, ..fresh_debian() });
    assert!(told.contains("npm error network") && told.contains("npm ci --prefix host-tests/rp2040"), "{told}");
    // One that is too old does not count.
    let world = World { node: Cell::new(Some("v12.22.9")), root: false, ..fresh_debian() };
    assert!(refused(world).starts_with("Node.js, of 18 or newer"));
}
