//! Where the stream comes from: an emulated board, at the speed of the real one or frame by frame, or a board at a serial port.

use firmware::protocol::{Command, MAX_WIRE, ToHost, encode_command};

use crate::emulator::boards::{Board, PICO};
use crate::emulator::pico::PicoMachine;
use crate::emulator::qemu::{LogLine, Machine, Screenshot};
use crate::link::{Counts, Port};

pub enum Source<'a> {
    /// Emulated by QEMU, its clock the host's.
    Live(Machine, &'a Board),
    /// Emulated by QEMU, run from frame to frame.
    Lockstep(Machine, &'a Board),
    Pico(Box<PicoMachine>),
    Port(Port),
}

impl Source<'_> {
    /// `None` at a port.
    fn board(&self) -> Option<&Board> {
        match self {
            Self::Live(_, board) | Self::Lockstep(_, board) => Some(board),
            Self::Pico(_) => Some(&PICO),
            Self::Port(_) => None,
        }
    }

    pub fn name(&self) -> &str {
        if let Self::Port(port) = self { &port.name } else { self.board().map_or("", |board| board.name) }
    }

    pub fn is_port(&self) -> bool {
        self.board().is_none()
    }

    pub fn has_panel(&self) -> bool {
        self.board().is_some_and(|board| board.has_panel)
    }

    /// The messages since the last call; of one that goes frame by frame those up to the next.
    pub fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        match self {
            Self::Live(machine, _) => machine.messages(),
            Self::Lockstep(machine, _) => machine.run_to_frame(),
            Self::Pico(machine) => machine.run_to_frame(),
            Self::Port(port) => Ok(port.messages()),
        }
    }

    pub fn send(&mut self, command: Command) -> anyhow::Result<()> {
        let mut wire = [0; MAX_WIRE];
        let wire = encode_command(0, command, &mut wire);
        match self {
            Self::Live(machine, _) | Self::Lockstep(machine, _) => machine.send_bytes(wire)?,
            Self::Pico(machine) => machine.send_bytes(wire)?,
            Self::Port(port) => port.send_bytes(wire),
        }
        Ok(())
    }

    /// The lines of the log since the last call; of a port what has become of it.
    pub fn lines(&mut self) -> Vec<LogLine> {
        let notice = |text: String| LogLine { level: Some("warn".to_owned()), text, place: None };
        match self {
            Self::Live(machine, _) | Self::Lockstep(machine, _) => machine.lines(),
            Self::Pico(machine) => machine.lines(),
            Self::Port(port) => port.notices.drain(..).map(notice).collect(),
        }
    }

    pub fn counts(&mut self) -> Counts {
        match self {
            Self::Live(machine, _) | Self::Lockstep(machine, _) => machine.counts(),
            Self::Pico(machine) => machine.counts()[0],
            Self::Port(port) => port.inbox.counts,
        }
    }

    /// What its panel shows; `None` where the host cannot see one.
    pub fn panel(&mut self) -> anyhow::Result<Option<Screenshot>> {
        let has_panel = self.has_panel();
        match self {
            Self::Live(machine, _) | Self::Lockstep(machine, _) if has_panel => machine.screenshot().map(Some),
            Self::Pico(machine) => machine.screenshot().map(Some),
            _ => Ok(None),
        }
    }
}
