//! The table of known answers, made anew from its own scenes and times.

use anyhow::Context;
use reference::enclosure::Start;

use crate::commands::simulate::Number;
use crate::oracle::known_answers::KnownAnswer;

/// Frames per second: the table's times are whole seconds.
const RATE: u16 = 64;
/// The most digits written.
const DIGITS: f64 = 33.0;

/// The lines of one scene. Each number is off by at most two units of its last digit, but for how many times larger a small error
/// has become, which is about.
pub fn known_answers(scene: &[KnownAnswer]) -> anyhow::Result<Vec<String>> {
    let mut set = start(&scene[0]).context("more digits than can be enclosed")?.enclose(RATE);
    let mut frame = 0;
    let mut line = |row: &KnownAnswer| {
        while f64::from(frame) < row.time * f64::from(RATE) {
            set.advance().context("the set has grown too large to be followed")?;
            frame += 1;
        }
        let exact = set.directions().as_flattened().iter().map(|x| x.decimal(DIGITS)).collect::<Vec<_>>().join(",");
        Ok(format!("{},{exact},{:.2e}", row.given, set.growth()))
    };
    scene.iter().map(&mut line).collect()
}

fn start(row: &KnownAnswer) -> Option<Start> {
    let numbers = row.given.split(',').skip(1).take(9).map(|text| text.parse::<Number>().ok()?.exact());
    let fractions = numbers.collect::<Option<Vec<_>>>()?.try_into().ok()?;
    Some(Start { about: (row.parameters(), row.start()), fractions: Some(fractions), degrees: [true, false] })
}
