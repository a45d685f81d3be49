//! An emulated board: its start, its output, and its end.

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
use crate::board::Board;
use crate::link::{Counts, Inbox};
use crate::process::{self, Running};
use crate::scratch::Scratch;
use crate::stream::{self, Channel, Stream};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The host's clock. The watchdog does not restart the board, because the host may delay QEMU
    /// for seconds.
    Real,
    /// The count of executed instructions. The results are bit-identical on any host under any
    /// load, and the board is several times as fast as a real one.
    Counted,
}

#[derive(Clone, Copy, Debug)]
pub struct MachineSettings<'a> {
    /// An absolute path, or a name that is found by `PATH`, because QEMU runs in another folder.
    pub qemu: &'a Path,
    pub board: &'a Board,
    pub elf: &'a Path,
    pub clock: Clock,
    /// The firmware sees a debugger: it sends its log, and a crash ends QEMU. Without one, a crash
    /// restarts the board.
    pub debugger: bool,
    pub limit: Duration,
}

/// Messages that QEMU prints at every start of this machine and that do not matter.
const CHATTER: [&str; 2] = ["Timer with period zero, disabling", "has no peer"];

/// An emulated board. Every method that waits also reads all output of the board, because QEMU
/// stops while its output is not read.
pub struct Machine {
    pub(super) monitor: Channel,
    pub(super) debugger: Channel,
    serial: Channel,
    log: [Stream; 2],
    decoder: LogDecoder,
    inbox: Inbox,
    messages: VecDeque<ToHost>,
    lines: Vec<LogLine>,
    pub(super) places: Places,
    process: Running,
    pub(super) folder: Scratch,
}

impl Machine {
    pub fn start(settings: &MachineSettings) -> anyhow::Result<Self> {
        let mut machine = Self::boot(settings)?;
        machine.run()?;
        Ok(machine)
    }

    pub(super) fn boot(settings: &MachineSettings) -> anyhow::Result<Self> {
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
        let monitor = channel("monitor")?;
        let debugger = channel("debugger")?;
        let serial = channel("serial")?;
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
            // A host that delays QEMU for seconds must not make the board's watchdog restart it.
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

    fn take_in(&mut self) -> anyhow::Result<()> {
        // If QEMU has ended, all its output is available now, so this is checked before reading.
        let ended = self.process.ended(&self.log)?;
        let Self {
            monitor,
            debugger,
            serial,
            log,
            ..
        } = self;

        for channel in [monitor, debugger, serial] {
            channel.stream.take_in();
        }
        for stream in log {
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
            .fold(anyhow!("QEMU ended ({status})"), |text, line| {
                anyhow!("{text}\n{line}")
            }))
    }

    pub(super) fn wait_until<T>(
        &mut self,
        mut found: impl FnMut(&mut Self) -> Option<T>,
    ) -> anyhow::Result<T> {
        loop {
            let taken = self.take_in();
            if let Some(found) = found(self) {
                return Ok(found);
            }
            taken?;

            let channels = [&self.monitor, &self.debugger, &self.serial];
            let streams = channels.map(|channel| &channel.stream);
            stream::wait(streams.into_iter().chain(&self.log));
        }
    }

    pub fn receive(&mut self) -> anyhow::Result<ToHost> {
        self.wait_until(|machine| machine.messages.pop_front())
    }

    /// The messages before it are dropped.
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

    pub fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        self.take_in()?;
        Ok(self.messages.drain(..).collect())
    }

    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    pub fn send_bytes(&mut self, mut bytes: &[u8]) -> anyhow::Result<()> {
        self.wait_until(|machine| {
            bytes = &bytes[machine.serial.sender.write(bytes).unwrap_or(0)..];
            bytes.is_empty().then_some(())
        })
    }

    pub fn counts(&self) -> Counts {
        self.inbox.counts
    }

    pub fn lines(&mut self) -> Vec<LogLine> {
        let _ = self.take_in();
        std::mem::take(&mut self.lines)
    }

    pub fn log_text(&mut self) -> String {
        self.lines()
            .iter()
            .map(|line| format!("{line}\n"))
            .collect()
    }

    pub fn id(&self) -> u32 {
        self.process.child.id()
    }

    pub fn wait(&mut self, mut each: impl FnMut(LogLine)) -> anyhow::Result<ExitStatus> {
        let _: anyhow::Result<()> = self.wait_until(|machine| {
            machine.lines.drain(..).for_each(&mut each);
            machine.messages.clear();
            None
        });
        Ok(self.process.wait()?)
    }
}
