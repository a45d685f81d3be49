//! Questions to the board over its port, and to the person at the board, who alone can see its
//! panel and press its buttons.

use std::io::stdin;
use std::sync::mpsc;
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use anyhow::bail;
use firmware::app::Key;
use firmware::protocol::{Answer, Command, Frame, ToHost};
use firmware::scenes::SceneName;

use super::Section;
use boards::console::cli::complain;
use boards::console::progress::complain_above;
use boards::link::{Port, refusal};

/// The time limit of an answer. A board answers a command within a tick, and the slowest requested
/// motion has a sample every second.
const PATIENCE: Duration = Duration::from_secs(20);
const LOOK: Duration = Duration::from_millis(1);

pub struct Talk {
    pub port: Port,
    arrived: std::vec::IntoIter<ToHost>,
}

impl Talk {
    /// Waits for a frame of the board.
    pub fn new(port: Port) -> anyhow::Result<Self> {
        let mut talk = Self {
            port,
            arrived: Vec::new().into_iter(),
        };
        talk.next_frame()?;
        Ok(talk)
    }

    /// Returns the value of `kind` for the next message that it accepts, and drops the messages
    /// before it. A refusal by the board is an error.
    pub fn next<M>(&mut self, mut kind: impl FnMut(ToHost) -> Option<M>) -> anyhow::Result<M> {
        let since = Instant::now();
        let mut has_notice = false;
        let mut has_answered = false;
        let mut has_drawn = false;
        while since.elapsed() < PATIENCE {
            for message in self.arrived.by_ref() {
                if let ToHost::Answer(_, Answer::Refused(field)) = message {
                    bail!("the board refuses this {}", refusal(field));
                }
                if let Some(wanted) = kind(message) {
                    return Ok(wanted);
                }
                has_drawn |= message.frame().is_some();
                has_answered |= message.answer().is_some();
            }

            self.arrived = self.port.messages()?.into_iter();
            for new in self.port.notices.drain(..) {
                complain_above(&new);
                has_notice = true;
            }
            sleep(LOOK);
        }

        let name = &self.port.name;
        let seconds = PATIENCE.as_secs();
        if has_notice {
            bail!(
                "{name}: no expected message for {seconds} s, probably because of a problem reported \
                 above; solve it and start again"
            )
        }
        if has_drawn {
            bail!("{name}: the board sends frames but does not answer; flash it again")
        }
        if has_answered {
            bail!("{name}: the board answers but sends no frames for {seconds} s; flash it again")
        }
        bail!("{name}: no message for {seconds} s; is the board powered and connected?")
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.next(ToHost::frame)
    }

    /// Returns the value of `kind` for the next answer to the request of this number.
    pub fn answer<A>(
        &mut self,
        request: u16,
        kind: impl Fn(Answer) -> Option<A>,
    ) -> anyhow::Result<A> {
        self.next(|message| {
            message
                .answer()
                .filter(|(to, _)| *to == request)
                .and_then(|(_, answer)| kind(answer))
        })
    }

    /// Sends a command and returns the value of `kind` for its answer.
    pub fn ask<A>(
        &mut self,
        command: Command,
        kind: impl Fn(Answer) -> Option<A>,
    ) -> anyhow::Result<A> {
        self.port.send(0, command);
        self.answer(0, kind)
    }
}

const UNDER_WAY: u32 = 12;

/// Asks the person about the panel and the buttons of the board. A button is a fault if a line is
/// entered and the motion has not started again.
pub fn ask_person(talk: &mut Talk, name: &str) -> anyhow::Result<Section> {
    // The panel and the keys that each board has.
    let (has_panel, keys): (_, &[Key]) = match name {
        "lm3s6965evb" | "pico" => (true, Key::ALL),
        "stm32f405" => (true, &[Key::Select]),
        _ => (false, &[]),
    };

    talk.ask(Command::Choose(SceneName::Page), |answer| {
        (answer == Answer::Done).then_some(())
    })?;
    let mut section = Section::new(
        "Seen and pressed",
        "Answered by the person at the board.",
        &["what", "answer"],
    );
    let mut note = |what: String, is_so: Option<bool>| {
        let answer = is_so.map_or("not answered", |is_so| if is_so { "yes" } else { "no" });
        let fault = (is_so == Some(false)).then(|| format!("answered no: {what}"));
        section.add(vec![what, answer.to_owned()], fault);
    };

    if has_panel {
        let what = "the panel shows a swinging pendulum, upright and sharp";
        let (answer, _) = entered(talk, &format!("{what}? [y/n, anything else: cannot say]"))?;
        let is_so = match answer.trim() {
            "y" | "yes" => Some(true),
            "n" | "no" => Some(false),
            _ => None,
        };
        note(what.to_owned(), is_so);
    }

    for key in keys.iter().map(|key| key.name()) {
        let question = format!("tap the button '{key}', then press enter [n: no such button]");
        let (answer, restarted) = entered(talk, &question)?;
        let is_tapped = !matches!(answer.trim(), "n" | "no") && !answer.is_empty();
        note(
            format!("a tap on the button '{key}' starts the motion again"),
            is_tapped.then_some(restarted),
        );
    }

    Ok(section)
}

/// Returns the line that the person enters, and true if the motion started again meanwhile.
fn entered(talk: &mut Talk, question: &str) -> anyhow::Result<(String, bool)> {
    complain(question);
    // The line is read by a thread, because the board's frames must be read meanwhile.
    let (line, lines) = mpsc::channel();
    spawn(move || {
        let mut text = String::new();
        let read = stdin().read_line(&mut text);
        line.send(if read.is_ok() { text } else { String::new() })
    });
    let mut answer = None;

    // Frames continue to arrive for a short time after the answer. A restart is a frame with a
    // smaller step number.
    let mut restarted = false;
    let mut left = UNDER_WAY;
    let mut last = talk.next_frame()?.report.step;
    while left > 0 {
        let step = talk.next_frame()?.report.step;
        restarted |= step < last;
        last = step;
        answer = answer.or_else(|| lines.try_recv().ok());
        left -= u32::from(answer.is_some());
    }
    Ok((answer.unwrap_or_default(), restarted))
}
