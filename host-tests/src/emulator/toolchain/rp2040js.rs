//! The emulator of the Raspberry Pi Pico: a package of npm's, kept to one version, and Node.js, which runs it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::detect::{manager, says};
use super::error::{NODE_PACKAGES, Part, SetupError};
use super::install::{attempt, debian_allows, install_packages};
use super::system::System;
use super::workspace;

/// For npm to fetch one small package.
const NPM: Duration = Duration::from_secs(120);
/// The oldest Node.js that it runs under.
const LEAST: u32 = 18;
/// Says which version of the emulator is there, if it is the one to be had.
const ASK: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'; version";

/// The emulator, ready to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rp2040js {
    node: PathBuf,
    version: String,
}

impl Rp2040js {
    /// The program `node`.
    pub fn node(&self) -> &Path {
        &self.node
    }
}

impl std::fmt::Display for Rp2040js {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Raspberry Pi Pico: rp2040js {} under {}", self.version, self.node.display())
    }
}

/// Where the emulator's own code is, and the package it needs.
fn folder() -> PathBuf {
    workspace().join("host-tests/rp2040")
}

/// Node.js, if it is new enough.
fn node(system: &impl System) -> Result<PathBuf, String> {
    let node = system.find("node").ok_or("there is no Node.js")?;
    let version = says(system, Command::new(&node).arg("--version"))?;
    let major = version.trim_start_matches('v').split('.').next().and_then(|major| major.parse::<u32>().ok());
    if major.is_some_and(|major| major >= LEAST) {
        Ok(node)
    } else {
        Err(format!("Node.js {version} is older than {LEAST}"))
    }
}

/// The emulator, or what is missing of it and why.
pub(super) fn detect(system: &impl System) -> Result<Rp2040js, SetupError> {
    let refused = |part, reason| SetupError { missing: vec![part], reason, manager: manager(system), tried: true };
    let node = node(system).map_err(|reason| refused(Part::Node, reason))?;
    match says(system, Command::new(&node).args(["--print", ASK]).current_dir(folder())) {
        Ok(version) => Ok(Rp2040js { node, version }),
        Err(_) => Err(refused(Part::Rp2040js, "npm has not fetched the version that is wanted".to_owned())),
    }
}

/// Brings what is missing; a line for each thing that was done.
pub(super) fn set_up(system: &impl System) -> Result<(Rp2040js, Vec<String>), SetupError> {
    let mut done = Vec::new();
    let refused = |part, reason| SetupError { missing: vec![part], reason, manager: manager(system), tried: true };
    if node(system).is_err() || system.find("npm").is_none() {
        debian_allows(system)
            .and_then(|()| install_packages(system, &NODE_PACKAGES, false))
            .map_err(|reason| refused(Part::Node, reason))?;
        done.push(format!("apt-get installed {}", NODE_PACKAGES.join(", ")));
    }
    if detect(system).is_err() {
        let mut npm = Command::new("npm");
        npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(folder());
        let doing = "npm fetches the emulator of the Raspberry Pi Pico";
        attempt(system, &mut npm, NPM, doing).map_err(|reason| refused(Part::Rp2040js, reason))?;
        done.push("npm fetched rp2040js".to_owned());
    }
    Ok((detect(system)?, done))
}
