//! Every scene for a second: its frames beside the host's, and the time that they take.

use anyhow::ensure;
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Command, ToHost};
use firmware::scenes::SceneName;

use super::Section;
use super::talk::Talk;
use crate::commands::demo::comparison::Comparison;

const FRAMES: u32 = TICK_RATE;
/// By so many it must have said what it plays.
const PATIENCE: usize = 10 * FRAMES as usize;

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
    talk.port.send(0, Command::Choose(name));
    let (mut comparison, mut frames, mut compared) = (Comparison::default(), Vec::new(), 0);
    while compared < FRAMES && comparison.difference().is_none() {
        let frame = match talk.receive()? {
            ToHost::Frame(frame) if frame.scene == name => frame,
            ToHost::Answer(_, Answer::Status(status)) => {
                comparison.status(&status);
                continue;
            }
            _ => continue,
        };
        frames.push(frame);
        ensure!(frames.len() < PATIENCE, "{}: of {} frames {compared} could be compared", name.name(), frames.len());
        if comparison.frame(&frame) {
            talk.port.send(0, Command::Ask);
        }
        while comparison.follow().is_some() {
            compared += 1;
        }
    }
    let difference = comparison.difference().map(|difference| difference.to_string());
    let bits = difference.clone().unwrap_or_else(|| "the host's".to_owned());
    let dropped = frames[frames.len() - 1].dropped.wrapping_sub(frames[0].dropped);
    let longest =
        |cycles: Option<u32>| format!("{:.2}", 1e3 * f64::from(cycles.unwrap_or(0)) / f64::from(hertz.max(1)));
    let computing = longest(frames.iter().map(|frame| frame.scene_cycles).max());
    // It is told of the frame before, which is another scene's at first.
    let whole = longest(frames[1..].iter().map(|frame| frame.busy_cycles).max());
    let row = vec![name.name().into(), compared.to_string(), bits, dropped.to_string(), computing, whole];
    Ok((row, difference))
}
