//! What the panel shows in every scene: pictures drawn here, and animations recorded in QEMU.

use std::path::Path;

use anyhow::{Result, bail};
use firmware::config::TICK_RATE;
use firmware::scenes::SceneName;

use crate::board::BOARDS;
use crate::demo::{self, Options, record};
use crate::qemu::Picture;
use crate::show::Show;

/// The moment of the pictures, ticks.
const MOMENT: u32 = 8 * TICK_RATE;

/// The file of a scene in the folder of pictures.
pub fn file(scene: SceneName, kind: &str) -> String {
    format!("panel/{}.{kind}", scene.name())
}

/// The picture of a scene as a PNG file. The panel of the emulated board shows the same (test `qemu_scenes`).
pub fn picture(name: SceneName) -> Result<Vec<u8>> {
    let mut scene = Show::new(name, &name.first_settings())?;
    (0..MOMENT).for_each(|_| scene.tick());
    let mut file = Vec::new();
    record::png(&Picture::from(&scene.picture()), &mut file)?;
    Ok(file)
}

/// How long the animation of a scene is, s: until all that it has to show has been seen.
pub fn seconds(scene: SceneName) -> f64 {
    match scene {
        SceneName::Figure7 => 20.0,
        SceneName::SmallLight | SceneName::SmallEqual | SceneName::SmallHeavy => 4.0,
        SceneName::Frequencies => 3.0,
        _ => 10.0,
    }
}

/// Records the animation of a scene into `folder`, as `cargo demo --headless` does.
pub fn record(scene: SceneName, folder: &Path) -> Result<()> {
    let options = Options {
        board: &BOARDS[0],
        scene,
        headless: true,
        seconds: Some(seconds(scene)),
        record: Some(folder.join(file(scene, "gif"))),
        screenshot: None,
        window: false,
    };
    match demo::run(&options) {
        Ok(Ok(true)) => Ok(()),
        Ok(Ok(false)) => bail!("not all was well in {}", scene.name()),
        Ok(Err(error)) => Err(error),
        Err(unavailable) => bail!("{unavailable}"),
    }
}
