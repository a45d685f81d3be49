//! Question and answer over a serial port.

use std::collections::VecDeque;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::bail;
use firmware::protocol::{Frame, Message};

use crate::link::{Port, Received};

/// A board answers a command within a tick; the slowest motion asked for has a sample every second.
const PATIENCE: Duration = Duration::from_secs(20);
const LOOK: Duration = Duration::from_millis(1);

pub struct Talk {
    pub port: Port,
    arrived: VecDeque<Received>,
}

impl Talk {
    pub fn new(port: Port) -> anyhow::Result<Self> {
        let mut talk = Self { port, arrived: VecDeque::new() };
        talk.next::<Frame>()?;
        Ok(talk)
    }

    pub fn receive(&mut self) -> anyhow::Result<Received> {
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
    pub fn next<M: Message>(&mut self) -> anyhow::Result<M> {
        let since = Instant::now();
        while since.elapsed() < PATIENCE {
            let message = self.receive()?;
            if let Some(wanted) = message.read() {
                return Ok(wanted);
            }
            if let Some(field) = message.refused() {
                bail!("the board refuses: {field}");
            }
        }
        bail!("{}: the board plays, and does not answer; flash it anew", self.port.name)
    }

    pub fn ask<A: Message>(&mut self, message: &impl Message) -> anyhow::Result<A> {
        self.port.send(message);
        self.next()
    }
}
