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
use console::cli::complain;
use console::progress::complain_above;
use emulator::link::{Port, refusal};

/// The time limit of an answer. A board answers a command within a tick, and the slowest requested
/// motion has a sample every second.
const PATIENCE: Duration = Duration::from_secs(20);
/// The time between two reads of the port.
const LOOK: Duration = Duration::from_millis(1);

/// A conversation with the board at a port.
pub struct Talk {
    /// The port, with its counts and the restarts of the board. Messages that are read from it
    /// directly are lost to the conversation. Its notices are printed by [`Talk::next`].
    pub port: Port,
    /// The messages that have arrived and are not yet examined.
    arrived: std::vec::IntoIter<ToHost>,
}

impl Talk {
    /// Waits for a frame of the board, which is dropped, and begins the conversation. Errors are as
    /// in [`Talk::next`]: no frame within 20 s, or a refusal.
    pub fn new(port: Port) -> anyhow::Result<Self> {
        let mut talk = Self {
            port,
            arrived: Vec::new().into_iter(),
        };
        talk.next_frame()?;
        Ok(talk)
    }

    /// Returns the value of `kind` for the next message that it accepts. The messages before it are
    /// dropped; later ones are kept. It is an error if none arrives within 20 s of the call, also
    /// if others do. The notices of the port are printed to stderr when they come; if there was one,
    /// the error refers to it. A refusal of any request by the board is an error, too, even if
    /// `kind` would accept it. After an error the conversation can continue.
    pub fn next<M>(&mut self, mut kind: impl FnMut(ToHost) -> Option<M>) -> anyhow::Result<M> {
        let since = Instant::now();
        let mut has_notice = false;
        let mut has_answered = false;
        let mut has_drawn = false;
        while since.elapsed() < PATIENCE {
            // The messages that have arrived, one by one.
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

            // More messages, and the notices of the port, which explain a silence best.
            self.arrived = self.port.messages()?.into_iter();
            for new in self.port.notices.drain(..) {
                complain_above(&new);
                has_notice = true;
            }
            sleep(LOOK);
        }

        // The reason, by the messages that have arrived.
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

    /// Returns the next frame and drops the other messages before it. Errors are as in
    /// [`Talk::next`].
    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.next(ToHost::frame)
    }

    /// Returns the value of `kind` for the next answer to the request of this number that `kind`
    /// accepts, also one that has already arrived. Drops the other messages before it. Errors are
    /// as in [`Talk::next`].
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

    /// Sends a command with the request number 0 and returns the value of `kind` for the first
    /// answer with this number that `kind` accepts. Not checked: that this is no late answer to an
    /// earlier command. Errors are as in [`Talk::next`].
    pub fn ask<A>(
        &mut self,
        command: Command,
        kind: impl Fn(Answer) -> Option<A>,
    ) -> anyhow::Result<A> {
        self.port.send(0, command);
        self.answer(0, kind)
    }
}

/// The number of frames that may still be in transmission when the person answers.
const UNDER_WAY: u32 = 12;

/// Asks the person about the panel and the buttons of the board `name`, in the scene `Page`, which
/// it starts. Prints the questions to stderr, reads a line from stdin for each, and waits without
/// limit while the board sends frames. There are questions for `lm3s6965evb`, `pico` and
/// `stm32f405` only; for another board the section has no rows.
///
/// The panel is a fault if the answer is `n` or `no`, and not answered unless it is that, `y` or
/// `yes`. A button is a fault if a line is entered, also an empty one, and the motion has not
/// started again between the question and shortly after the line; `n` or `no` means that there is
/// no such button, which is no fault. After the end of stdin nothing is a fault. Errors are as in
/// [`Talk::next`].
pub fn ask_person(talk: &mut Talk, name: &str) -> anyhow::Result<Section> {
    // The panel and the keys that each board has.
    let (has_panel, keys): (_, &[Key]) = match name {
        "lm3s6965evb" | "pico" => (true, Key::ALL),
        "stm32f405" => (true, &[Key::Select]),
        _ => (false, &[]),
    };

    // A known scene, so that the question about the panel has a definite answer.
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

    // The panel, then each key.
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

/// Returns the line that the person enters, empty if the input has ended, and true if the motion
/// started again meanwhile.
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
