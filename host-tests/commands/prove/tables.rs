//! Tables whose every line is proved: horizons and known answers.

use std::sync::atomic::AtomicUsize;

use anyhow::{Context, Result};
use clap::Parser;
use exact::enclosure::Start;
use firmware::scenes::SceneName;

use super::horizon::{counts, frames, time};
use crate::plan::SceneOptions;
use crate::simulate::StartOptions;
use boards::console::number::Number;
use exact::known_answers::KnownAnswer;

/// Returns the scenes with angles, except `upright`, which shows two given arithmetics.
pub fn moving() -> impl Iterator<Item = &'static SceneName> {
    SceneName::ALL
        .iter()
        .filter(|name| name.has_angles() && **name != SceneName::Upright)
}

pub const HEADING: &str = "\
| scene | M3: plan | proved | M4F: plan | proved | M0+: plan | proved | open |
| --- | --- | --- | --- | --- | --- | --- | --- |";

/// Returns the line of one scene, with its predicted and proved horizons on three chips.
pub fn horizons(name: SceneName) -> Result<String> {
    let mut cells = vec![name.name().to_owned()];
    let mut unproved = 0;
    for chip in ["lm3s6965evb", "stm32f405", "pico"] {
        let words = ["plan", "--scene", name.name(), "--board", chip];
        let (scene, plan) = SceneOptions::try_parse_from(words)?.plan()?;
        cells.extend(match plan {
            Err(_) => ["none", "none"].map(String::from),
            Ok(plan) => {
                let start = StartOptions::of(&name.first_settings()).exact();
                let start = start.context("a number with too many digits")?;
                let never = AtomicUsize::new(0);
                let (right, open) =
                    counts(&frames(&scene, &start, plan.stepping(), &never)?.collect::<Vec<_>>());
                unproved += open;
                [plan.horizon, time(&scene, right)].map(|time| format!("{time:.2}"))
            }
        });
    }
    Ok(format!("| {} | {unproved} |", cells.join(" | ")))
}

/// The times of the known answers are multiples of a frame.
const RATE: u16 = 64;
const DIGITS: f64 = 33.0;

/// Returns the lines of one scene in `exact/known_answers.csv`. Each number has an error of at
/// most two units of its last digit; the last one, the growth of a small error, is approximate.
pub fn known_answers(scene: &[KnownAnswer]) -> Result<Vec<String>> {
    let exact = |text: &str| text.parse::<Number>().ok()?.exact();
    let fractions = scene[0]
        .given
        .split(',')
        .skip(1)
        .take(9)
        .map(exact)
        .collect::<Option<Vec<_>>>();
    let fractions = fractions
        .and_then(|all| all.try_into().ok())
        .context("more digits than can be enclosed")?;

    let about = (scene[0].parameters, scene[0].start.motion());
    let mut set = Start {
        about,
        fractions: Some(fractions),
        degrees: [true, false],
    }
    .enclose(RATE);

    let mut frame = 0;
    let line = |row: &KnownAnswer| {
        while f64::from(frame) < row.time * f64::from(RATE) {
            set.advance()
                .context("the set has grown too large to be followed")?;
            frame += 1;
        }
        let exact = set
            .directions()
            .as_flattened()
            .iter()
            .map(|x| x.decimal(DIGITS))
            .collect::<Vec<_>>()
            .join(",");
        Ok(format!("{},{exact},{:.2e}", row.given, set.growth()))
    };
    scene.iter().map(line).collect()
}
