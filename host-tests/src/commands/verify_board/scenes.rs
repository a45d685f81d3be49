//! Every scene for a second: its frames beside the host's, and the time that they take.

use anyhow::ensure;
use firmware::config::TICK_RATE;
use firmware::protocol::{Ask, Choose, Frame, Status};
use firmware::scenes::SceneName;

use super::Section;
use super::talk::Talk;
use crate::commands::demo::comparison::Comparison;

const FRAMES: u32 = TICK_RATE;
/// By so many it must have said what it plays.
const PATIENCE: u32 = 10 * FRAMES;

/// Plays every scene on the board, whose processor has a clock of `hertz`.
pub fn watch(talk: &mut Talk, hertz: u32) -> anyhow::Result<Section> {
    let columns = &["scene", "frames", "bits", "dropped", "moving and drawing (ms)", "with panel and link (ms)"];
    let mut section = Section::new("Scenes", "The longest of a second's frames, by the board's tick clock.", columns);
    for &scene in SceneName::ALL {
        let (row, difference) = play(talk, scene, hertz)?;
        section.table.rows.push(row);
        section.faults.extend(difference.map(|difference| format!("{}: {difference}", scene.name())));
    }
    Ok(section)
}

/// A scene's row, and the first number that differs.
fn play(talk: &mut Talk, name: SceneName, hertz: u32) -> anyhow::Result<(Vec<String>, Option<String>)> {
    talk.port.send(&Choose { request: 0, scene: name.code() });
    let mut comparison = Comparison::default();
    let (mut first, mut compared, mut dropped, mut computing, mut whole) = (None, 0, 0, 0, 0);
    while compared < FRAMES && comparison.difference().is_none() {
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
        ensure!(arrived < PATIENCE, "{}: of {arrived} frames {compared} could be compared", name.name());
        dropped = frame.dropped.wrapping_sub(first.dropped);
        computing = computing.max(frame.scene_cycles);
        // It is told of the frame before, which is another scene's at first.
        if frame.sequence != first.sequence {
            whole = whole.max(frame.busy_cycles);
        }
        while comparison.follow().is_some() {
            compared += 1;
        }
    }
    let difference = comparison.difference().map(|difference| difference.to_string());
    let milliseconds = |cycles: u32| format!("{:.2}", 1e3 * f64::from(cycles) / f64::from(hertz.max(1)));
    let [compared, dropped] = [compared, dropped].map(|count| count.to_string());
    let bits = difference.clone().unwrap_or_else(|| "the host's".to_owned());
    let row = vec![name.name().into(), compared, bits, dropped, milliseconds(computing), milliseconds(whole)];
    Ok((row, difference))
}
