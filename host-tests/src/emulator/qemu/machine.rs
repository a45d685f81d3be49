//! Starting and ending an emulated board.

use std::env::temp_dir;
use std::io::ErrorKind;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use firmware::app::Key;
use firmware::protocol::{Answer, Frame, ToHost};
use tempfile::TempDir;

use super::qmp::Monitor;
use super::serial::Pipes;
use super::{Log, LogLine, Screenshot, Serial};
use crate::emulator::boards::Board;
use crate::emulator::process::{self, Running, remove_on_interrupt};

/// How often a connection that is not there yet is looked for.
const POLL: Duration = Duration::from_millis(2);

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

/// A running board. Dropping it ends QEMU.
#[derive(Debug)]
pub struct Machine {
    pub serial: Serial,
    pub log: Log,
    monitor: Monitor,
    process: Running,
    folder: TempDir,
}

impl Machine {
    /// Starts a board. Its first instruction is executed after the host is attached to it.
    pub fn start(settings: &Settings) -> anyhow::Result<Self> {
        let (mut machine, _) = Self::start_stopped(settings)?;
        // A firmware may end QEMU before QEMU can answer.
        let _: anyhow::Result<()> = machine.monitor.resume();
        Ok(machine)
    }

    /// Starts a board that stands still at its first instruction, and gives its debugger port.
    pub(super) fn start_stopped(settings: &Settings) -> anyhow::Result<(Self, UnixStream)> {
        let elf = settings.elf.canonicalize().with_context(|| settings.elf.display().to_string())?;
        let folder = tempfile::Builder::new().prefix("double-pendulum-").tempdir()?;
        remove_on_interrupt(folder.path());
        // QEMU connects to sockets that listen already: none of its bytes can be lost.
        let listen = |name| UnixListener::bind(folder.path().join(name));
        let (monitor, debugger) = (listen("monitor")?, listen("debugger")?);
        let pipes = Pipes::make(&folder.path().join("serial"))?;

        let mut command = Command::new(settings.qemu);
        command.current_dir(folder.path());
        command.args(["-machine", settings.board.machine, "-cpu", settings.board.cpu]).arg("-kernel").arg(elf);
        command.args(["-display", "none"]);
        command.args(["-serial", "null"].repeat(settings.board.serial_port));
        command.args(["-chardev", "pipe,id=serial,path=serial", "-serial", "chardev:serial"]);
        command.args(["-chardev", "socket,id=monitor,path=monitor", "-mon", "chardev=monitor,mode=control"]);
        command.args(["-chardev", "socket,id=debugger,path=debugger", "-gdb", "chardev:debugger", "-S"]);
        if settings.debugger {
            command.args(["-semihosting-config", "enable=on,target=native"]);
        }
        match settings.clock {
            Clock::Counted => {
                command.arg("-icount").arg(format!("shift={},sleep=off", settings.board.instruction_shift()))
            }
            // A host that holds QEMU up for seconds is no reason for the board to start again.
            Clock::Real => command.args(["-action", "watchdog=none"]),
        };
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());

        let mut process = process::spawn(&mut command, settings.limit)?;
        let log = Log::new(settings.elf, process.stdout.take(), process.stderr.take())?;
        let monitor = accept(&monitor, &mut process, &log)?;
        let debugger = accept(&debugger, &mut process, &log)?;
        // QEMU greets once all its connections are made.
        let monitor = Monitor::new(monitor)?;
        Ok((Self { serial: Serial::new(pipes)?, log, monitor, process, folder }, debugger))
    }

    pub fn receive(&mut self) -> anyhow::Result<ToHost> {
        self.serial.receive().ok_or_else(|| self.silence())
    }

    /// The next message of one kind; others on the way to it are passed over.
    pub fn wait_for<M>(&mut self, kind: impl Fn(ToHost) -> Option<M>) -> anyhow::Result<M> {
        loop {
            if let Some(message) = kind(self.receive()?) {
                return Ok(message);
            }
        }
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.wait_for(ToHost::frame)
    }

    pub fn next_answer(&mut self) -> anyhow::Result<(u16, Answer)> {
        self.wait_for(ToHost::answer)
    }

    pub fn said(&self) -> String {
        self.log.arrived().map(|line| format!("{line}\n")).collect()
    }

    /// What the panel shows now. While the board runs this may be a mixture of two frames.
    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        self.monitor.screenshot(self.folder.path()).map_err(|error| self.explain(error))
    }

    /// Gives QEMU's console a line that it has nothing to say to.
    pub(super) fn tell(&mut self, line: &str) -> anyhow::Result<()> {
        let said = self.monitor.console(line).map_err(|error| self.explain(error))?;
        let reason = said.trim();
        if reason.is_empty() { Ok(()) } else { bail!("QEMU refuses console: {reason}") }
    }

    pub fn set_key(&mut self, key: Key, down: bool) -> anyhow::Result<()> {
        self.monitor.set_key(key, down).map_err(|error| self.explain(error))
    }

    /// Presses and lets go of every button once, too early for the firmware to take it for a command: only then does
    /// this board's emulated hardware tell a released button from a pressed one.
    pub fn wake_keys(&mut self) -> anyhow::Result<()> {
        Key::ALL.iter().try_for_each(|&key| {
            self.set_key(key, true)?;
            self.set_key(key, false)
        })
    }

    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// Whether QEMU has ended by itself, and how.
    pub fn ended(&mut self) -> anyhow::Result<Option<ExitStatus>> {
        Ok(self.process.try_wait()?)
    }

    /// Waits until QEMU ends by itself: how, and what was said until then.
    pub fn wait(&mut self) -> anyhow::Result<(ExitStatus, Vec<LogLine>)> {
        let status = self.process.wait()?;
        Ok((status, self.log.rest().collect()))
    }

    /// What is behind `error` if QEMU has ended.
    pub(super) fn explain(&mut self, error: anyhow::Error) -> anyhow::Error {
        ended(&mut self.process, &self.log).unwrap_or(error)
    }

    pub fn silence(&mut self) -> anyhow::Error {
        self.explain(anyhow!("QEMU's serial port is closed"))
    }
}

/// The connection that QEMU makes as it starts.
fn accept(listener: &UnixListener, process: &mut Running, log: &Log) -> anyhow::Result<UnixStream> {
    listener.set_nonblocking(true)?;
    loop {
        match listener.accept() {
            Ok((socket, _)) => {
                socket.set_nonblocking(false)?;
                return Ok(socket);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => bail!(error),
        }
        if process.try_wait()?.is_some() {
            bail!(ended(process, log).context("it has ended")?);
        }
        sleep(POLL);
    }
}

/// How QEMU ended and the last it said; `None` if it runs on.
fn ended(process: &mut Running, log: &Log) -> Option<anyhow::Error> {
    /// A broken connection is noticed a moment before the process can be seen to end.
    const GRACE: Duration = Duration::from_millis(500);
    let mut waited = Duration::ZERO;
    let how = loop {
        match process.try_wait() {
            Ok(Some(status)) => break status.to_string(),
            Ok(None) if waited < GRACE => {}
            Ok(None) => return None,
            Err(error) => return Some(error.into()),
        }
        sleep(POLL);
        waited += POLL;
    };
    let lines: Vec<_> = log.rest().map(|line| line.to_string()).collect();
    let said = lines[lines.len().saturating_sub(4)..].join("\n");
    Some(if said.is_empty() { anyhow!("QEMU ended ({how})") } else { anyhow!("QEMU ended ({how}):\n{said}") })
}

/// Why no machine can have its folder of sockets, in one line that names `TMPDIR`: it is no folder, or no socket's name is so long.
pub(crate) fn check_folder() -> Result<(), String> {
    let listened =
        tempfile::tempdir().and_then(|folder| UnixListener::bind(folder.path().join("double-pendulum-debug")));
    listened.map(drop).map_err(|error| format!("QEMU's sockets cannot be in TMPDIR={}: {error}", temp_dir().display()))
}
