//! Question and answer over a serial port.

use std::collections::VecDeque;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::bail;
use firmware::protocol::{Answer, Command, Frame, ToHost};

use crate::link::{Port, refusal};

/// A board answers a command within a tick; the slowest motion asked for has a sample every second.
const PATIENCE: Duration = Duration::from_secs(20);
const LOOK: Duration = Duration::from_millis(1);

pub struct Talk {
    pub port: Port,
    arrived: VecDeque<ToHost>,
}

impl Talk {
    pub fn new(port: Port) -> anyhow::Result<Self> {
        let mut talk = Self { port, arrived: VecDeque::new() };
        talk.next_frame()?;
        Ok(talk)
    }

    pub fn receive(&mut self) -> anyhow::Result<ToHost> {
        let (since, mut told) = (Instant::now(), None);
        while since.elapsed() <= PATIENCE {
            if let Some(message) = self.arrived.pop_front() {
                return Ok(message);
            }
            self.arrived.extend(self.port.messages());
            told = self.port.notices().last().or(told);
            sleep(LOOK);
        }
        let silence = || format!("{}: no message for {} s", self.port.name, PATIENCE.as_secs());
        bail!(told.unwrap_or_else(silence))
    }

    /// The next message of one kind; others on the way to it are passed over, but not a refusal.
    pub fn next<M>(&mut self, kind: impl Fn(ToHost) -> Option<M>) -> anyhow::Result<M> {
        let since = Instant::now();
        while since.elapsed() < PATIENCE {
            let message = self.receive()?;
            if let ToHost::Answer(_, Answer::Refused(field)) = message {
                bail!("the board refuses: {}", refusal(field));
            }
            if let Some(wanted) = kind(message) {
                return Ok(wanted);
            }
        }
        bail!("{}: the board plays, and does not answer; flash it anew", self.port.name)
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.next(ToHost::frame)
    }

    /// The next answer of one kind to the command of this number.
    pub fn answer<A>(&mut self, request: u16, kind: impl Fn(Answer) -> Option<A>) -> anyhow::Result<A> {
        self.next(|message| message.answer().filter(|(to, _)| *to == request).and_then(|(_, answer)| kind(answer)))
    }

    pub fn ask<A>(&mut self, command: Command, kind: impl Fn(Answer) -> Option<A>) -> anyhow::Result<A> {
        self.port.send(0, command);
        self.answer(0, kind)
    }
}
