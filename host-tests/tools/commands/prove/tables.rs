//! Tables whose every line is proved: horizons and known answers.

use std::sync::atomic::AtomicUsize;

use anyhow::{Context, Result};
use clap::Parser;
use firmware::scenes::SceneName;
use reference::enclosure::Start;

use super::horizon::{counts, frames, time};
use crate::commands::plan::SceneOptions;
use crate::commands::simulate::StartOptions;
use crate::oracle::known_answers::KnownAnswer;
use console::number::Number;

/// Returns the scenes with a motion to plan, in the order of [`SceneName::ALL`]: all with angles
/// ([`SceneName::has_angles`]) except `upright`, which shows two given arithmetics.
pub fn moving() -> impl Iterator<Item = &'static SceneName> {
    SceneName::ALL
        .iter()
        .filter(|name| name.has_angles() && **name != SceneName::Upright)
}

/// The heading of the table of horizons: two lines of Markdown, without a newline at the end. The
/// columns are those of [`horizons`]; times are in s.
pub const HEADING: &str = "\
| scene | M3: plan | proved | M4F: plan | proved | M0+: plan | proved | open |
| --- | --- | --- | --- | --- | --- | --- | --- |";

/// Returns the table's line of one scene, in Markdown and without a newline, with its predicted and
/// proved horizons on the chips `m3`, `m4f` and `pico` of `cargo plan`. Times are in s; "none" in
/// both cells means that no method is fast enough for the chip. The last cell is the number of
/// undecided frames on all three chips. It takes seconds. An error means that the scene has no
/// motion to plan.
pub fn horizons(name: SceneName) -> Result<String> {
    // Each chip adds the predicted and the proved horizon.
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

/// The frames per second. The times of the known answers are whole seconds.
const RATE: u16 = 64;
/// The largest number of digits that are written.
const DIGITS: f64 = 33.0;

/// Returns the known answers of one scene, one line each, computed from the given numbers. The
/// lines are as in the file `reference/known_answers.csv`, without newlines. Each number has an
/// error of at most two units of its last digit, except the last one, the factor by which a small
/// error of the start has grown, which is approximate.
///
/// `scene` has at least one row, else this panics. Not checked: its rows have the same start, and
/// their times ascend and are multiples of 1/64 s. An error means that a number has too many
/// digits, or that the enclosure becomes too wide.
pub fn known_answers(scene: &[KnownAnswer]) -> Result<Vec<String>> {
    // The nine numbers after the name of the scene: the start and the pendulum.
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

    // The table has angles in degrees and velocities in radians per second.
    let about = (scene[0].parameters, scene[0].start.motion());
    let mut set = Start {
        about,
        fractions: Some(fractions),
        degrees: [true, false],
    }
    .enclose(RATE);

    let mut frame = 0;
    let line = |row: &KnownAnswer| {
        // The set advances to the row's time.
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
