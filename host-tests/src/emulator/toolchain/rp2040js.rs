//! The emulator of the Raspberry Pi Pico: a package of npm's, kept to one version, and Node.js, which runs it.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use super::detect::{find, number, says};
use super::install::{attempt, bring, install_packages};
use super::{missing, workspace};
use crate::console::cli::Refused;

const NPM: Duration = Duration::from_secs(120);
const LEAST: u32 = 18;
/// Fails if the version of the emulator that is there is not the one to be had.
const ASK: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'";

/// Where the emulator's own code is, and the package it needs.
fn folder() -> PathBuf {
    workspace().join("host-tests/rp2040")
}

fn node() -> Result<PathBuf, String> {
    let node = find("node").ok_or("there is no Node.js")?;
    let version = says(Command::new(&node).arg("--version"))?;
    let is_new = number(&version, 0).is_some_and(|number| number >= LEAST);
    if is_new { Ok(node) } else { Err(format!("Node.js {} is older than {LEAST}", version.trim())) }
}

fn no_node(why: String) -> Refused {
    missing("Node.js, of 18 or newer, with npm", &why, "this system's packages nodejs and npm")
}

fn no_emulator(why: String) -> Refused {
    missing("the emulator of the Raspberry Pi Pico", &why, "npm ci --prefix host-tests/rp2040")
}

fn fetched() -> Result<(), String> {
    let asked = says(Command::new("node").args(["--eval", ASK]).current_dir(folder()));
    asked.map(drop).map_err(|_| "npm has not fetched the version that is wanted".to_owned())
}

/// Node.js, where it has the emulator; or what is missing of them and why.
pub(super) fn detect() -> Result<PathBuf, Refused> {
    let node = node().map_err(no_node)?;
    fetched().map_err(no_emulator).map(|()| node)
}

/// The same, brought if need be.
pub(super) fn set_up() -> Result<PathBuf, Refused> {
    let with_npm = || find("npm").ok_or("there is no npm".to_owned()).and_then(|_| node());
    let packages = || install_packages(&["nodejs", "npm"]);
    let node = bring(with_npm, &[("apt-get installed nodejs, npm".to_owned(), &packages)]).map_err(no_node)?;
    let npm = || {
        let mut npm = Command::new("npm");
        npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(folder());
        attempt(&mut npm, NPM, "npm fetches the emulator of the Raspberry Pi Pico")
    };
    bring(fetched, &[("npm fetched rp2040js".to_owned(), &npm)]).map_err(no_emulator).map(|()| node)
}
