//! What only the person at the board can see and do: its panel and its buttons.

use std::io::stdin;
use std::sync::mpsc;
use std::thread;

use firmware::app::Key;
use firmware::protocol::{Answer, Command};
use firmware::scenes::SceneName;

use super::Section;
use super::talk::Talk;
use crate::console::cli::complain;

/// Frames that may still be on their way when the person answers.
const UNDER_WAY: u32 = 12;

/// Asks about what the board `name` has.
pub fn ask(talk: &mut Talk, name: &str) -> anyhow::Result<Section> {
    let (has_panel, keys): (_, &[Key]) = match name {
        "lm3s6965evb" | "pico" => (true, Key::ALL),
        "stm32f405" => (true, &[Key::Select]),
        _ => (false, &[]),
    };
    talk.ask(Command::Choose(SceneName::Page), |answer| (answer == Answer::Done).then_some(()))?;
    let mut section = Section::new("Seen and pressed", "By the person at the board.", &["what", "is so"]);
    let mut note = |what: String, is_so: Option<bool>| {
        let answer = is_so.map_or("not answered", |is_so| if is_so { "yes" } else { "no" });
        section.faults.extend((is_so == Some(false)).then(|| format!("not so: {what}")));
        section.table.rows.push(vec![what, answer.to_owned()]);
    };
    if has_panel {
        let what = "the panel shows a swinging pendulum, upright and sharp";
        let (answer, _) = answer(talk, &format!("{what}? [y/n, anything else: cannot say]"))?;
        let is_so = match answer.trim() {
            "y" | "yes" => Some(true),
            "n" | "no" => Some(false),
            _ => None,
        };
        note(what.to_owned(), is_so);
    }
    for key in keys.iter().map(|key| key.name()) {
        let (answer, restarted) =
            answer(talk, &format!("tap the button '{key}', then press enter [n: there is none]"))?;
        let is_tapped = !matches!(answer.trim(), "n" | "no") && !answer.is_empty();
        note(format!("a tap on the button '{key}' starts the motion again"), is_tapped.then_some(restarted));
    }
    Ok(section)
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
    let mut last = talk.next_frame()?.report;
    let mut left = UNDER_WAY;
    while left > 0 {
        let report = talk.next_frame()?.report;
        restarted |= report.step < last.step;
        last = report;
        answer = answer.or_else(|| answers.try_recv().ok());
        left -= u32::from(answer.is_some());
    }
    Ok((answer.unwrap_or_default(), restarted))
}
