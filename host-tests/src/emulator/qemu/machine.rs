//! An emulated board: how it starts, what comes from it, and how it ends.

use std::collections::VecDeque;
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;

use anyhow::{Context, anyhow};
use firmware::protocol::{self, Answer, Frame, MAX_WIRE, ToHost, encode_command};
use serde_json::json;

use super::debugger::{DESCRIBE, Places};
use super::{LogDecoder, LogLine};
use crate::emulator::boards::Board;
use crate::emulator::process::{self, Running};
use crate::emulator::scratch::Scratch;
use crate::emulator::stream::{self, Channel, Stream};
use crate::link::{Counts, Inbox};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The host's clock: as fast as the real board, as long as the host keeps up.
    Real,
    /// The count of executed instructions, each of which takes [as long as any](Board::instruction), and no waiting while the
    /// board sleeps: repeatable bit for bit on any host however busy, and several times as fast as the real board.
    Counted,
}

#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    pub qemu: &'a Path,
    pub board: &'a Board,
    pub elf: &'a Path,
    pub clock: Clock,
    /// Whether there is a debugger that answers the firmware's calls and so takes its log.
    pub debugger: bool,
    /// It is ended at the latest after this long, by the host's clock.
    pub limit: Duration,
}

/// What QEMU says at every start of this machine and no one needs to read.
const CHATTER: [&str; 2] = ["Timer with period zero, disabling", "has no peer"];

/// An emulated board. Whoever waits for anything of it also reads all that comes, for QEMU stands still while no one does. Dropping it
/// ends QEMU.
pub struct Machine {
    /// If not, what the board sends fills the pipe, and then its port.
    pub listens: bool,
    pub(super) monitor: Channel,
    pub(super) debugger: Channel,
    serial: Channel,
    /// The firmware's log; and what QEMU says, and the firmware of a crash, in plain text.
    log: [Stream; 2],
    decoder: LogDecoder,
    inbox: Inbox,
    messages: VecDeque<ToHost>,
    lines: Vec<LogLine>,
    pub(super) places: Places,
    process: Running,
    /// Taken away once QEMU is gone.
    pub(super) folder: Scratch,
}

impl Machine {
    /// Starts a board. Its first instruction is executed after the host is attached to it.
    pub fn start(settings: &Settings) -> anyhow::Result<Self> {
        let mut machine = Self::boot(settings)?;
        machine.run()?;
        Ok(machine)
    }

    /// Starts a board that stands still at its first instruction.
    pub(super) fn boot(settings: &Settings) -> anyhow::Result<Self> {
        let elf = settings
            .elf
            .canonicalize()
            .with_context(|| settings.elf.display().to_string())?;
        let folder = Scratch::new()?;
        let mut command = Command::new(settings.qemu);
        command.current_dir(folder.path());
        command
            .args([
                "-machine",
                settings.board.machine,
                "-cpu",
                settings.board.cpu,
            ])
            .arg("-kernel")
            .arg(elf);
        let mut channel = |name: &str| {
            command.args(["-chardev", &format!("pipe,id={name},path={name}")]);
            Channel::make(&folder.path().join(name))
        };
        let (monitor, debugger, serial) = (
            channel("monitor")?,
            channel("debugger")?,
            channel("serial")?,
        );
        command.args([
            "-display",
            "none",
            "-mon",
            "chardev=monitor,mode=control",
            "-gdb",
            "chardev:debugger",
            "-S",
        ]);
        command
            .args(["-serial", "null"].repeat(settings.board.serial_port))
            .args(["-serial", "chardev:serial"]);
        if settings.debugger {
            command.args(["-semihosting-config", "enable=on,target=native"]);
        }
        match settings.clock {
            Clock::Counted => command.arg("-icount").arg(format!(
                "shift={},sleep=off",
                settings.board.instruction_shift()
            )),
            // A host that holds QEMU up for seconds is no reason for the board to start again.
            Clock::Real => command.args(["-action", "watchdog=none"]),
        };
        command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());

        let decoder = LogDecoder::new(settings.elf)?;
        let mut process = process::spawn(&mut command, settings.limit)?;
        let log = process.streams()?;
        let mut machine = Self {
            listens: true,
            monitor,
            debugger,
            serial,
            log,
            decoder,
            inbox: Inbox::default(),
            messages: VecDeque::new(),
            lines: Vec::new(),
            places: Places::default(),
            process,
            folder,
        };
        machine.execute("qmp_capabilities", json!({}))?;
        machine.ask(DESCRIBE)?;
        Ok(machine)
    }

    /// Takes all that has come; the error tells how QEMU has ended, and the last it said.
    fn take_in(&mut self) -> anyhow::Result<()> {
        // What was said before the end is all there then.
        let ended = self.process.ended(&self.log)?;
        let Self {
            monitor,
            debugger,
            serial,
            log,
            ..
        } = self;
        let serial = if self.listens {
            Some(&mut serial.stream)
        } else {
            None
        };
        for stream in [&mut monitor.stream, &mut debugger.stream]
            .into_iter()
            .chain(log)
            .chain(serial)
        {
            stream.take_in();
        }
        let received = self.serial.stream.bytes.drain(..);
        self.messages
            .extend(received.filter_map(|byte| self.inbox.take(byte)));
        let [firmware, plain] = &mut self.log;
        self.lines
            .extend(self.decoder.take(&std::mem::take(&mut firmware.bytes)));
        while let Some(line) = plain.line() {
            if !CHATTER.iter().any(|chatter| line.contains(chatter)) {
                self.lines.push(LogLine::plain(&line));
            }
        }
        let Some(status) = ended else { return Ok(()) };
        let last = &self.lines[self.lines.len().saturating_sub(4)..];
        Err(last
            .iter()
            .fold(anyhow!("QEMU ended ({status})"), |said, line| {
                anyhow!("{said}\n{line}")
            }))
    }

    /// Waits until `found` finds something in what has come; the error tells how QEMU has ended.
    pub(super) fn wait_until<T>(
        &mut self,
        mut found: impl FnMut(&mut Self) -> Option<T>,
    ) -> anyhow::Result<T> {
        loop {
            let goes_on = self.take_in();
            if let Some(found) = found(self) {
                return Ok(found);
            }
            goes_on?;
            let channels =
                [&self.monitor, &self.debugger, &self.serial].map(|channel| &channel.stream);
            stream::wait(channels.into_iter().chain(&self.log));
        }
    }

    pub fn receive(&mut self) -> anyhow::Result<ToHost> {
        self.wait_until(|machine| machine.messages.pop_front())
    }

    /// The next message of one kind; others on the way to it are passed over.
    pub fn wait_for<M>(&mut self, kind: impl Fn(ToHost) -> Option<M>) -> anyhow::Result<M> {
        self.wait_until(|machine| {
            std::iter::from_fn(|| machine.messages.pop_front()).find_map(&kind)
        })
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.wait_for(ToHost::frame)
    }

    pub fn next_answer(&mut self) -> anyhow::Result<(u16, Answer)> {
        self.wait_for(ToHost::answer)
    }

    /// The messages that have come; the error tells how QEMU has ended.
    pub fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        self.take_in()?;
        Ok(self.messages.drain(..).collect())
    }

    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    /// Waits while the board takes none and the pipe is full, until QEMU ends at the latest.
    pub fn send_bytes(&mut self, mut bytes: &[u8]) -> anyhow::Result<()> {
        self.wait_until(|machine| {
            bytes = &bytes[machine.serial.sender.write(bytes).unwrap_or(0)..];
            bytes.is_empty().then_some(())
        })
    }

    /// What the link has been through.
    pub fn counts(&self) -> Counts {
        self.inbox.counts
    }

    /// The lines of the log that have come.
    pub fn lines(&mut self) -> Vec<LogLine> {
        // Of one that has ended, too.
        let _ = self.take_in();
        std::mem::take(&mut self.lines)
    }

    pub fn said(&mut self) -> String {
        self.lines()
            .iter()
            .map(|line| format!("{line}\n"))
            .collect()
    }

    pub fn id(&self) -> u32 {
        self.process.child.id()
    }

    /// Waits until QEMU ends by itself: how. Gives `each` line that is said until then.
    pub fn wait(&mut self, mut each: impl FnMut(LogLine)) -> anyhow::Result<ExitStatus> {
        // Nothing is found, so it ends by an error.
        let _: anyhow::Result<()> = self.wait_until(|machine| {
            machine.lines.drain(..).for_each(&mut each);
            machine.messages.clear();
            None
        });
        Ok(self.process.wait()?)
    }
}
