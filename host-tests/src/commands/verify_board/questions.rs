//! What only the person at the board can see and do: its panel and its buttons.

use std::io::{BufRead, stdin};
use std::time::{Duration, Instant};

use firmware::app::controls::Key;
use firmware::protocol::{Choose, Done, Frame};
use firmware::scenes::SceneName;
use serde::Serialize;

use super::talk::Talk;
use crate::console::cli::complain;

/// For a button to be pressed.
const PATIENCE: Duration = Duration::from_secs(20);

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
        "lm3s6965evb" => (true, Key::ALL),
        "stm32f405" => (true, &[Key::Select]),
        _ => (false, &[]),
    };
    talk.ask::<Done>(&Choose { request: 0, scene: SceneName::Page.code() })?;
    let panel = has_panel.then(|| question("the panel shows a swinging pendulum, upright and sharp"));
    talk.forget();
    let keys: Vec<_> = keys.iter().map(|&key| press(talk, key)).collect::<anyhow::Result<_>>()?;
    Ok(panel.into_iter().chain(keys).collect())
}

fn question(what: &str) -> Asked {
    complain(format_args!("{what}? [y/n, anything else: cannot say]"));
    let mut line = String::new();
    let read = stdin().lock().read_line(&mut line);
    let is_so = match line.trim() {
        "y" | "yes" => Some(true),
        "n" | "no" => Some(false),
        _ => None,
    };
    Asked { what: what.to_owned(), is_so: is_so.filter(|_| read.is_ok()) }
}

/// Whether a tap on the button starts the motion again.
fn press(talk: &mut Talk, key: Key) -> anyhow::Result<Asked> {
    let what = format!("a tap on the button '{}' starts the motion again", key.name());
    complain(format_args!("please tap the button '{}' within {} s", key.name(), PATIENCE.as_secs()));
    let since = Instant::now();
    let mut last: Frame = talk.next()?;
    while since.elapsed() < PATIENCE {
        let frame: Frame = talk.next()?;
        if frame.step < last.step {
            return Ok(Asked { what, is_so: Some(true) });
        }
        last = frame;
    }
    Ok(Asked { what, is_so: Some(false) })
}
