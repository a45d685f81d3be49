//! Every scene for a second: its frames beside the host's, and the time that they take.

use anyhow::ensure;
use firmware::config::TICK_RATE;
use firmware::protocol::{Ask, Choose, Frame, Status};
use firmware::scenes::SceneName;
use serde::Serialize;

use super::talk::Talk;
use crate::commands::demo::comparison::Comparison;

/// Frames of each.
const FRAMES: u32 = TICK_RATE;
/// By so many it must have said what it plays.
const PATIENCE: u32 = 10 * FRAMES;

/// A scene's frames.
#[derive(Clone, Debug, Serialize)]
pub struct Scene {
    /// Its name.
    pub scene: &'static str,
    /// Frames compared.
    pub frames: u32,
    /// The first number that differs.
    pub difference: Option<String>,
    /// Ticks without a frame in that time.
    pub dropped: u32,
    /// Moving and drawing a frame, at most, ms.
    pub computing: f64,
    /// The same and sending it to the panel and over the link.
    pub whole: f64,
}

/// Plays every scene on the board, whose processor has a clock of `hertz`.
pub fn watch(talk: &mut Talk, hertz: u32) -> anyhow::Result<Vec<Scene>> {
    SceneName::ALL.iter().map(|&name| play(talk, name, hertz)).collect()
}

fn play(talk: &mut Talk, name: SceneName, hertz: u32) -> anyhow::Result<Scene> {
    talk.port.send(&Choose { request: 0, scene: name.code() });
    let mut comparison = Comparison::default();
    let mut scene = Scene { scene: name.name(), frames: 0, difference: None, dropped: 0, computing: 0.0, whole: 0.0 };
    let milliseconds = |cycles: u32| 1e3 * f64::from(cycles) / f64::from(hertz.max(1));
    let mut first = None;
    while scene.frames < FRAMES && scene.difference.is_none() {
        let message = talk.receive()?;
        if let Some(status) = message.read::<Status>() {
            comparison.status(&status);
        }
        let Some(frame) = message.read::<Frame>().filter(|frame| frame.scene == name.code()) else { continue };
        if comparison.frame(&frame) {
            talk.port.send(&Ask { request: 0 });
        }
        let first: &Frame = first.get_or_insert(frame);
        let arrived = frame.sequence.wrapping_sub(first.sequence);
        ensure!(arrived < PATIENCE, "{}: of {arrived} frames {} could be compared", name.name(), scene.frames);
        scene.dropped = frame.dropped.wrapping_sub(first.dropped);
        scene.computing = scene.computing.max(milliseconds(frame.scene_cycles));
        // It is told of the frame before, which is another scene's at first.
        if frame.sequence != first.sequence {
            scene.whole = scene.whole.max(milliseconds(frame.busy_cycles));
        }
        while comparison.follow().is_some() {
            scene.frames += 1;
        }
        scene.difference = comparison.difference().map(|difference| difference.to_string());
    }
    Ok(scene)
}
