//! `cargo figures`: the book's figures 2 to 5 and 7 from the kernel, and what the panel shows in every scene.
//!
//! Nothing in these files depends on the machine, so two runs write the same files.

pub mod chaos;
pub mod frequencies;
pub mod panel;
pub mod sheet;
pub mod small;

use std::path::PathBuf;

use anyhow::Result;
use firmware::scenes::SceneName;
use sheet::Drawing;

use crate::emulator::toolchain::workspace;

/// The folder in which they are kept.
pub fn folder() -> PathBuf {
    workspace().join("host-tests/pictures")
}

/// Those in it.
pub const FOLDERS: [&str; 2] = ["figures", "panel"];

/// A file: its name in that folder and what is in it.
pub type File = (String, Vec<u8>);

/// Every file that the command writes.
pub fn files() -> Result<Vec<File>> {
    let mut files = Vec::new();
    files.extend(both("figures/figure-2", &frequencies::Frequencies::new()?)?);
    for (number, mass_ratio) in [(3, 0.2), (4, 1.0), (5, 5.0)] {
        files.extend(both(&format!("figures/figure-{number}"), &small::Small::new(number, mass_ratio)?)?);
    }
    files.extend(both("figures/figure-7", &chaos::Chaos::new(1)?)?);
    for &scene in SceneName::ALL {
        files.push((panel::file(scene, "png"), panel::screenshot(scene)?));
    }
    Ok(files)
}

fn both<D: Drawing>(name: &str, drawing: &D) -> Result<[File; 2]> {
    let svg = sheet::svg(drawing)?;
    let png = sheet::png(&svg)?;
    Ok([(format!("{name}.svg"), svg.into_bytes()), (format!("{name}.png"), png)])
}
