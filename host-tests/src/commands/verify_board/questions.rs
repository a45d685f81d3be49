//! What only the person at the board can see and do: its panel and its buttons.

use std::io::stdin;
use std::sync::mpsc;
use std::thread;

use firmware::app::controls::Key;
use firmware::protocol::{Choose, Done, Frame};
use firmware::scenes::SceneName;
use serde::Serialize;

use super::talk::Talk;
use crate::console::cli::complain;

/// Frames that may still be on their way when the person answers.
const UNDER_WAY: u32 = 12;

/// A question and its answer.
#[derive(Clone, Debug, Serialize)]
pub struct Asked {
    /// What was asked for.
    pub what: String,
    /// Whether it is so; `None` if that was not answered.
    pub is_so: Option<bool>,
}

/// Asks about what the board `name` has.
pub fn ask(talk: &mut Talk, name: &str) -> anyhow::Result<Vec<Asked>> {
    let (has_panel, keys): (_, &[Key]) = match name {
        "lm3s6965evb" | "pico" => (true, Key::ALL),
        "stm32f405" => (true, &[Key::Select]),
        _ => (false, &[]),
    };
    talk.ask::<Done>(&Choose { request: 0, scene: SceneName::Page.code() })?;
    let panel = has_panel.then(|| panel(talk));
    panel.into_iter().chain(keys.iter().map(|&key| button(talk, key))).collect()
}

fn panel(talk: &mut Talk) -> anyhow::Result<Asked> {
    let what = "the panel shows a swinging pendulum, upright and sharp";
    let (answer, _) = answer(talk, &format!("{what}? [y/n, anything else: cannot say]"))?;
    let is_so = match answer.trim() {
        "y" | "yes" => Some(true),
        "n" | "no" => Some(false),
        _ => None,
    };
    Ok(Asked { what: what.to_owned(), is_so })
}

/// Whether a tap on the button starts the motion again.
fn button(talk: &mut Talk, key: Key) -> anyhow::Result<Asked> {
    let name = key.name();
    let (answer, restarted) = answer(talk, &format!("tap the button '{name}', then press enter [n: there is none]"))?;
    let is_tapped = !matches!(answer.trim(), "n" | "no") && !answer.is_empty();
    let what = format!("a tap on the button '{name}' starts the motion again");
    Ok(Asked { what, is_so: is_tapped.then_some(restarted) })
}

/// The line that the person enters, empty where input has ended, and whether the motion started again meanwhile.
fn answer(talk: &mut Talk, question: &str) -> anyhow::Result<(String, bool)> {
    complain(question);
    let (entered, answers) = mpsc::channel();
    thread::spawn(move || {
        let mut line = String::new();
        let read = stdin().read_line(&mut line);
        entered.send(if read.is_ok() { line } else { String::new() })
    });
    let (mut answer, mut restarted) = (None, false);
    let mut last: Frame = talk.next()?;
    let mut left = UNDER_WAY;
    while left > 0 {
        let frame: Frame = talk.next()?;
        restarted |= frame.step < last.step;
        last = frame;
        answer = answer.or_else(|| answers.try_recv().ok());
        left -= u32::from(answer.is_some());
    }
    Ok((answer.unwrap_or_default(), restarted))
}
