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
use crate::boards::Board;
use crate::link::{Counts, Inbox};
use crate::process::{self, Running};
use crate::scratch::Scratch;
use crate::stream::{self, Channel, Stream};

/// The clock of an emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// The host's clock. The board is as fast as a real one if the host can keep up. Its watchdog
    /// does not restart it, because the host may delay QEMU for seconds.
    Real,
    /// The count of executed instructions. Every instruction takes the [same
    /// time](Board::instruction), and no time passes on the host while the board sleeps. The
    /// results are bit-identical on any host under any load, and the board is several times as fast
    /// as a real one. Its watchdog acts on a hang, if QEMU emulates it.
    Counted,
}

/// Everything that a machine needs at its start.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// The program QEMU: an absolute path, or a name that is found by `PATH`. QEMU runs in another
    /// folder, so a relative path does not find it.
    pub qemu: &'a Path,
    /// The board to emulate.
    pub board: &'a Board,
    /// The ELF file of the board's program.
    pub elf: &'a Path,
    /// The clock of the board.
    pub clock: Clock,
    /// True if the firmware sees a debugger, which answers its semihosting calls: it receives the
    /// log, and a crash ends QEMU. If false, there is no log but QEMU's own plain text, and a crash
    /// restarts the board. The machine can be stopped in both cases.
    pub debugger: bool,
    /// QEMU is ended after this time at the latest, by the host's clock. Waits then end with an
    /// error.
    pub limit: Duration,
}

/// Messages that QEMU prints at every start of this machine and that do not matter.
const CHATTER: [&str; 2] = ["Timer with period zero, disabling", "has no peer"];

/// An emulated board.
///
/// Every method that waits also reads all output of the board, because QEMU stops while its output
/// is not read; between the calls nothing reads it. Dropping the machine ends QEMU. A command or a
/// memory access that QEMU refuses is an error. While the machine is stopped, a wait for a message
/// that has not arrived yet lasts until QEMU's time limit.
///
/// All methods that wait for output return an error if QEMU ends first, with its last lines that
/// have not been fetched. At the time limit that is an [`io::Error`](std::io::Error) of kind
/// `TimedOut`, without the lines; output that was not read before is then lost.
pub struct Machine {
    /// True, as at the start, if the link is read. If not, the board's output fills the pipe and
    /// then its serial port, and a wait for a message that has not arrived yet lasts until QEMU
    /// ends.
    pub listens: bool,
    /// QEMU's control channel.
    pub(super) monitor: Channel,
    /// QEMU's port for a debugger.
    pub(super) debugger: Channel,
    serial: Channel,
    /// The firmware's log, and the plain text of QEMU and of the firmware's crash reports.
    log: [Stream; 2],
    decoder: LogDecoder,
    inbox: Inbox,
    /// The messages that have not been fetched, oldest first.
    messages: VecDeque<ToHost>,
    /// The lines of the log that have not been fetched, oldest first.
    lines: Vec<LogLine>,
    /// The places where the machine can be stopped.
    pub(super) places: Places,
    process: Running,
    /// The folder is removed after QEMU has ended.
    pub(super) folder: Scratch,
}

impl Machine {
    /// Starts a board and lets it run. The host is attached before the first instruction is
    /// executed. An error means that the ELF file is unusable, that QEMU cannot be started, that it
    /// ends at once, as for the Pico, or that there is no place for temporary files
    /// ([`Scratch::new`]).
    pub fn start(settings: &Settings) -> anyhow::Result<Self> {
        let mut machine = Self::boot(settings)?;
        machine.run()?;
        Ok(machine)
    }

    /// Starts a board that is stopped at its first instruction. Its `places` are empty. Errors are
    /// as in [`Self::start`].
    pub(super) fn boot(settings: &Settings) -> anyhow::Result<Self> {
        let elf = settings
            .elf
            .canonicalize()
            .with_context(|| settings.elf.display().to_string())?;

        let folder = Scratch::new()?;
        // QEMU runs in its own folder, which has the pipes.
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

        // The pipes to QEMU.
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

        // The serial port of the link, the log and the clock.
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

        // The start. QEMU accepts commands after these two requests.
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

    /// Reads everything that has arrived. Returns an error with QEMU's exit status and last lines
    /// if QEMU has ended.
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

        // A link that is not read fills its pipe, as a host does that has stopped reading.
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

        // Decode the messages of the link and the lines of the log.
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

        // A machine that has ended reports its status and its last lines.
        let Some(status) = ended else { return Ok(()) };
        let last = &self.lines[self.lines.len().saturating_sub(4)..];
        Err(last
            .iter()
            .fold(anyhow!("QEMU ended ({status})"), |text, line| {
                anyhow!("{text}\n{line}")
            }))
    }

    /// Waits until `found` returns a value from the output, and returns it. `found` is called after
    /// each reading of the output, the first time at once and the last time after QEMU's end.
    /// Returns an error if QEMU ends before it returns a value.
    pub(super) fn wait_until<T>(
        &mut self,
        mut found: impl FnMut(&mut Self) -> Option<T>,
    ) -> anyhow::Result<T> {
        loop {
            let taken = self.take_in();
            // The output may have the value even if QEMU has ended.
            if let Some(found) = found(self) {
                return Ok(found);
            }
            taken?;

            // Unread bytes of a link that is not read must not end the wait.
            let serial = self.listens.then_some(&self.serial.stream);
            let channels = [&self.monitor.stream, &self.debugger.stream];
            stream::wait(channels.into_iter().chain(&self.log).chain(serial));
        }
    }

    /// Waits for the next message and returns it: the oldest one that has not been fetched, at once
    /// if there is one.
    pub fn receive(&mut self) -> anyhow::Result<ToHost> {
        self.wait_until(|machine| machine.messages.pop_front())
    }

    /// Waits for the next message for which `kind` returns `Some`, and returns that value. Messages
    /// that have not been fetched count, the oldest first. The messages before it are dropped;
    /// later ones are kept. A refusal by the board is a message like others.
    pub fn wait_for<M>(&mut self, kind: impl Fn(ToHost) -> Option<M>) -> anyhow::Result<M> {
        self.wait_until(|machine| {
            std::iter::from_fn(|| machine.messages.pop_front()).find_map(&kind)
        })
    }

    /// Waits for the next frame as [`Self::wait_for`] does: the oldest that has not been fetched.
    /// Other messages before it are dropped.
    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.wait_for(ToHost::frame)
    }

    /// Waits for the next answer as [`Self::wait_for`] does, also a refusal, and returns it with
    /// the number of its request. Other messages before it, such as frames, are dropped.
    pub fn next_answer(&mut self) -> anyhow::Result<(u16, Answer)> {
        self.wait_for(ToHost::answer)
    }

    /// Returns the messages that have arrived and have not been fetched by any method, oldest
    /// first, without waiting. Returns an error if QEMU has ended; [`Self::receive`] still returns
    /// the messages.
    pub fn messages(&mut self) -> anyhow::Result<Vec<ToHost>> {
        self.take_in()?;
        Ok(self.messages.drain(..).collect())
    }

    /// Sends a command with this request number, as [`Self::send_bytes`] does.
    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    /// Sends all bytes. Blocks until everything is written to the pipe to QEMU, from which the
    /// board may take it later, or until QEMU exits, which is an error. But bytes for which the
    /// pipe has room, 64 KiB on Linux, are accepted without an error, even if QEMU has ended.
    pub fn send_bytes(&mut self, mut bytes: &[u8]) -> anyhow::Result<()> {
        self.wait_until(|machine| {
            bytes = &bytes[machine.serial.sender.write(bytes).unwrap_or(0)..];
            bytes.is_empty().then_some(())
        })
    }

    /// Returns the counts of messages, damage and restarts on the link since the start, in the
    /// output that has been read.
    pub fn counts(&self) -> Counts {
        self.inbox.counts
    }

    /// Returns the lines of the log that have arrived since the last call, oldest first, without
    /// waiting. They can be fetched after QEMU has ended, too; after its time limit, those that
    /// were read before.
    pub fn lines(&mut self) -> Vec<LogLine> {
        // The lines of a machine that has ended are returned, too.
        let _ = self.take_in();
        std::mem::take(&mut self.lines)
    }

    /// Returns the same lines as [`Self::lines`] as one text, with a newline after each. They count
    /// as fetched.
    pub fn log_text(&mut self) -> String {
        self.lines()
            .iter()
            .map(|line| format!("{line}\n"))
            .collect()
    }

    /// Returns the process ID of QEMU, also after its end, when another process may have it.
    pub fn id(&self) -> u32 {
        self.process.child.id()
    }

    /// Waits until QEMU ends, passes every log line that has not been fetched to `each`, and
    /// returns the exit status, which may be a failure. Messages of the link are dropped. An
    /// [`io::Error`](std::io::Error) of kind `TimedOut` means that the time limit ended QEMU. A
    /// further call has the same result at once.
    pub fn wait(&mut self, mut each: impl FnMut(LogLine)) -> anyhow::Result<ExitStatus> {
        // The closure never returns a value, so the wait ends with the error that QEMU has ended.
        let _: anyhow::Result<()> = self.wait_until(|machine| {
            machine.lines.drain(..).for_each(&mut each);
            machine.messages.clear();
            None
        });
        Ok(self.process.wait()?)
    }
}
