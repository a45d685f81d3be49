//! What the panel shows in every scene: frames drawn here, and animations recorded in QEMU.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Result, ensure};
use clap::Parser;
use firmware::config::TICK_RATE;
use firmware::scenes::SceneName;

use crate::commands::demo::{self, DemoOptions, record};
use crate::console::cli::complain;
use crate::emulator::host::Show;
use crate::emulator::qemu::Screenshot;

/// The moment of a scene's frame, ticks: what moves is well under way; the map of flips is finished.
fn moment(scene: SceneName) -> u32 {
    TICK_RATE * if scene == SceneName::Flips { 60 } else { 8 }
}

pub fn file(scene: SceneName, kind: &str) -> String {
    format!("panel/{}.{kind}", scene.name())
}

/// The screenshot of a scene as a PNG file. The panel of the emulated board shows the same (test `all_scenes`).
pub fn screenshot(name: SceneName) -> Result<Vec<u8>> {
    let mut scene = Show::new(name, &name.first_settings())?;
    (0..moment(name)).for_each(|_| scene.tick());
    record::png(&Screenshot::from(&scene.frame()))
}

/// How long the animation of a scene is, s: until all that it has to show has been seen.
pub fn seconds(scene: SceneName) -> f64 {
    match scene {
        SceneName::Figure7 => 20.0,
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => 4.0,
        SceneName::Frequencies => 3.0,
        SceneName::Flips => 60.0,
        _ => 10.0,
    }
}

/// Records the animation of a scene into `folder`, as `cargo demo --headless` does, and says by which command.
pub fn record(scene: SceneName, folder: &Path) -> Result<()> {
    let path = folder.join(file(scene, "gif"));
    let (name, seconds) = (scene.name(), seconds(scene).to_string());
    complain(format_args!("cargo demo --scene {name} --headless --seconds {seconds} --record {}", path.display()));
    let words = ["cargo demo", "--scene", name, "--headless", "--seconds", &seconds, "--record"];
    let options = DemoOptions::try_parse_from(words.iter().map(OsStr::new).chain([path.as_os_str()]))?;
    ensure!(demo::run(&options)?, "not all was well in {}", scene.name());
    Ok(())
}
