//! Where the stream comes from: an emulated board, at the speed of the real one or frame by frame, or a board at a serial port.

use std::process::ExitStatus;
use std::thread::sleep;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;
use firmware::protocol::{MAX_WIRE, Message, encode};

use crate::emulator::boards::{Board, PICO};
use crate::emulator::pico;
use crate::emulator::qemu::{Lockstep, LogLine, Machine, QemuError, Screenshot};
use crate::link::{Counts, Port, Received};

/// A board that plays.
pub enum Source<'a> {
    /// Emulated, its clock the host's.
    Live(Machine, &'a Board),
    /// Emulated, run from frame to frame.
    Lockstep(Lockstep, &'a Board),
    /// The emulated Pico; in a terminal no faster than the real one, whose next frame is due then.
    Pico(Box<pico::Machine>, Option<Instant>),
    /// At a serial port.
    Port(Port),
}

impl Source<'_> {
    /// What the user calls it.
    pub fn name(&self) -> &str {
        match self {
            Self::Live(_, board) | Self::Lockstep(_, board) => board.name,
            Self::Pico(..) => PICO.name,
            Self::Port(port) => port.name(),
        }
    }

    /// The messages since the last call; of one that goes frame by frame those up to the next.
    pub fn messages(&mut self) -> anyhow::Result<Vec<Received>> {
        match self {
            Self::Live(machine, _) => Ok(machine.serial.all_arrived().collect()),
            Self::Lockstep(lockstep, _) => lockstep.run_to_frame().map_err(broken),
            Self::Pico(machine, pace) => {
                if let Some(due) = pace {
                    sleep(due.saturating_duration_since(Instant::now()));
                    // What is late is not made up for.
                    *due = Instant::now().max(*due) + Duration::from_secs(1) / TICK_RATE;
                }
                Ok(machine.run_to_frame()?)
            }
            Self::Port(port) => Ok(port.messages()),
        }
    }

    /// Sends a message.
    pub fn send(&mut self, message: &impl Message) -> anyhow::Result<()> {
        let mut wire = [0; MAX_WIRE];
        let wire = encode(message, &mut wire);
        match self {
            Self::Port(port) => {
                port.send_bytes(wire);
                Ok(())
            }
            Self::Pico(machine, _) => Ok(machine.send_bytes(wire)?),
            Self::Live(machine, _) => machine.serial.send_bytes(wire).map_err(broken),
            Self::Lockstep(lockstep, _) => lockstep.machine().serial.send_bytes(wire).map_err(broken),
        }
    }

    /// The lines of the log since the last call; of a port what has become of it.
    pub fn lines(&mut self) -> Vec<LogLine> {
        match self {
            Self::Live(machine, _) => machine.log.arrived().collect(),
            Self::Lockstep(lockstep, _) => lockstep.machine().log.arrived().collect(),
            Self::Pico(machine, _) => machine.lines(),
            Self::Port(port) => port.notices().map(notice).collect(),
        }
    }

    /// What the link has been through.
    pub fn counts(&mut self) -> Counts {
        match self {
            Self::Live(machine, _) => machine.serial.counts(),
            Self::Lockstep(lockstep, _) => lockstep.machine().serial.counts(),
            Self::Pico(machine, _) => machine.counts()[0],
            Self::Port(port) => port.counts(),
        }
    }

    /// Whether the host can see its panel.
    pub fn has_panel(&self) -> bool {
        match self {
            Self::Live(_, board) | Self::Lockstep(_, board) => board.has_panel,
            Self::Pico(..) => true,
            Self::Port(_) => false,
        }
    }

    /// What its panel shows; `None` where the host cannot see one.
    pub fn panel(&mut self) -> anyhow::Result<Option<Screenshot>> {
        if !self.has_panel() {
            return Ok(None);
        }
        match self {
            Self::Live(machine, _) => machine.screenshot().map(Some).map_err(broken),
            Self::Lockstep(lockstep, _) => lockstep.screenshot().map(Some).map_err(broken),
            Self::Pico(machine, _) => Ok(Some(machine.screenshot()?)),
            Self::Port(_) => Ok(None),
        }
    }

    /// Whether it is a board in the hand.
    pub fn is_port(&self) -> bool {
        matches!(self, Self::Port(_))
    }

    /// How an emulated board has ended by itself, if it has: the firmware has crashed.
    pub fn ended(&mut self) -> anyhow::Result<Option<ExitStatus>> {
        match self {
            Self::Live(machine, _) => machine.ended().map_err(broken),
            Self::Lockstep(..) | Self::Pico(..) | Self::Port(_) => Ok(None),
        }
    }

    /// Lines of the log to its very end, once it has ended.
    pub fn rest(&mut self) -> Vec<LogLine> {
        match self {
            Self::Live(machine, _) => machine.log.rest().collect(),
            _ => self.lines(),
        }
    }
}

fn notice(text: String) -> LogLine {
    LogLine { level: Some("warn".to_owned()), text, place: None }
}

/// What went wrong, as the demonstration says it.
pub fn broken(error: QemuError) -> anyhow::Error {
    anyhow::Error::msg(error.to_string())
}
