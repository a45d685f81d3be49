//! The table of known answers, made anew from its own scenes and times.

use std::io;

use anyhow::Context;
use reference::enclosure::{Fineness, Given, Start};

use crate::commands::simulate::Number;
use crate::oracle::known_answers::{HEADING, KnownAnswer, table};

/// Frames per second: the table's times are whole seconds.
const RATE: u16 = 64;
/// The most digits written.
const DIGITS: f64 = 33.0;

/// Every line of these scenes in turn, the heading first. Each number is off by at most two units of its last digit, but for how many times
/// larger a small error has become, which is about.
pub fn known_answers(
    is_asked: impl Fn(&str) -> bool,
    mut say: impl FnMut(String) -> io::Result<()>,
) -> anyhow::Result<()> {
    say(HEADING.to_owned())?;
    let rows: Vec<_> = table()?.into_iter().filter(|row| is_asked(row.scene)).collect();
    for scene in rows.chunk_by(|one, next| one.scene == next.scene) {
        let mut set = start(&scene[0]).context("more digits than can be enclosed")?.enclose(RATE, Fineness::default());
        let mut time = 0.0;
        for row in scene {
            while time < row.time {
                set.advance().context("the set has grown too large to be followed")?;
                time += 1.0 / f64::from(RATE);
            }
            let exact = set.directions().as_flattened().iter().map(|x| x.decimal(DIGITS)).collect::<Vec<_>>().join(",");
            say(format!("{},{exact},{:.2e}", row.given, set.growth()))?;
        }
    }
    Ok(())
}

fn start(row: &KnownAnswer) -> Option<Start> {
    let numbers = row.given.split(',').skip(1).take(9).map(|text| text.parse::<Number>().ok()?.exact());
    let mut given: [Given; 9] = numbers.collect::<Option<Vec<_>>>()?.try_into().ok()?;
    given.rotate_left(4);
    Some(Start { about: (row.parameters(), row.start()), given, degrees: [true, false] })
}
