//! The emulator of the Raspberry Pi Pico: a package of npm's, kept to one version, and Node.js, which runs it.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::detect::{find, says};
use super::install::{attempt, install_packages};
use super::{missing, workspace};
use crate::console::cli::Refused;

const NPM: Duration = Duration::from_secs(120);
const LEAST: u32 = 18;
/// Says which version of the emulator is there, if it is the one to be had.
const ASK: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'; version";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rp2040js {
    node: PathBuf,
    version: String,
}

impl Rp2040js {
    pub fn node(&self) -> &Path {
        &self.node
    }
}

impl fmt::Display for Rp2040js {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Raspberry Pi Pico: rp2040js {} under {}", self.version, self.node.display())
    }
}

/// Where the emulator's own code is, and the package it needs.
fn folder() -> PathBuf {
    workspace().join("host-tests/rp2040")
}

fn node() -> Result<PathBuf, String> {
    let node = find("node").ok_or("there is no Node.js")?;
    let version = says(Command::new(&node).arg("--version"))?;
    let major = version.trim_start_matches('v').split('.').next().and_then(|major| major.parse::<u32>().ok());
    let is_new = major.is_some_and(|major| major >= LEAST);
    if is_new { Ok(node) } else { Err(format!("Node.js {} is older than {LEAST}", version.trim())) }
}

fn no_node(why: impl AsRef<str>) -> Refused {
    missing("Node.js, of 18 or newer, with npm", why.as_ref(), "this system's packages nodejs and npm")
}

fn no_emulator(why: impl AsRef<str>) -> Refused {
    let by_hand = "npm ci --prefix host-tests/rp2040";
    missing("the emulator of the Raspberry Pi Pico", why.as_ref(), by_hand)
}

/// The emulator, or what is missing of it and why.
pub(super) fn detect() -> Result<Rp2040js, Refused> {
    let node = node().map_err(no_node)?;
    let version = says(Command::new(&node).args(["--print", ASK]).current_dir(folder()))
        .map_err(|_| no_emulator("npm has not fetched the version that is wanted"))?;
    Ok(Rp2040js { node, version: version.trim().to_owned() })
}

/// Brings what is missing; a line for each thing that was done.
pub(super) fn set_up() -> Result<(Rp2040js, Vec<String>), Refused> {
    let mut done = Vec::new();
    if node().is_err() || find("npm").is_none() {
        install_packages(&["nodejs", "npm"]).map_err(no_node)?;
        done.push("apt-get installed nodejs, npm".to_owned());
    }
    if detect().is_err() {
        let mut npm = Command::new("npm");
        npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]).current_dir(folder());
        attempt(&mut npm, NPM, "npm fetches the emulator of the Raspberry Pi Pico").map_err(no_emulator)?;
        done.push("npm fetched rp2040js".to_owned());
    }
    Ok((detect()?, done))
}
