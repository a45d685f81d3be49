//! A pseudo-terminal with an emulated board behind it, whose cable can be pulled. Not every test
//! uses all of this module.
#![allow(dead_code)]

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::{OpenOptionsExt, symlink};
use std::path::PathBuf;
use std::process::Command;
use std::thread::{scope, sleep};
use std::time::Duration;

use emulator::boards::{Board, LM3S6965EVB};
use emulator::pico::PicoMachine;
use emulator::process::{Output, run};
use emulator::qemu::{Clock, Machine, Settings};
use firmware::protocol::{MAX_WIRE, ToHost, encode};
use nix::fcntl::OFlag;
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

use crate::support::{LIMIT, on};

/// The board of most tests.
pub const BOARD: &Board = &LM3S6965EVB;
/// The interval between two checks of the cable.
pub const WAIT: Duration = Duration::from_millis(1);
/// An emulated board that receives bytes and sends messages.
pub trait Linked {
    /// Takes bytes from the host. An error means that the emulator has ended.
    fn take(&mut self, bytes: &[u8]) -> anyhow::Result<()>;

    /// Returns the messages that have arrived since the last call.
    fn sent(&mut self) -> anyhow::Result<Vec<ToHost>>;
}

impl Linked for Machine {
    fn take(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.send_bytes(bytes)
    }

    fn sent(&mut self) -> anyhow::Result<Vec<ToHost>> {
        self.messages()
    }
}

/// The Pico's time advances only while messages are requested.
impl Linked for PicoMachine {
    fn take(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.send_bytes(bytes)
    }

    fn sent(&mut self) -> anyhow::Result<Vec<ToHost>> {
        self.run(SLICE)
    }
}

/// The time that a Pico runs between two checks of the cable, by its own clock.
const SLICE: Duration = Duration::from_millis(4);

/// A board at a port whose name stays the same when the cable is pulled.
pub struct Bench<M = Machine> {
    /// The board.
    pub machine: M,
    /// The board's end of the cable; `None` while it is pulled.
    pub cable: Option<PtyMaster>,
    /// True if the host has sent something.
    pub heard: bool,
    /// The sequence number of the last frame that was transferred.
    pub frame: u32,
    _folder: tempfile::TempDir,
    /// The path of the port.
    pub name: PathBuf,
}

impl Bench {
    /// Returns a bench with a new [`BOARD`], plugged in.
    pub fn new() -> Self {
        Self::of(BOARD)
    }

    /// Returns a bench with a new emulated board in QEMU, plugged in.
    pub fn of(board: &Board) -> Self {
        Self::with(machine(board))
    }
}

impl<M: Linked> Bench<M> {
    /// Returns a bench with this board, plugged in.
    pub fn with(machine: M) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let name = folder.path().join("ttyACM0");
        let mut bench = Self {
            machine,
            cable: None,
            heard: false,
            frame: 0,
            _folder: folder,
            name,
        };

        bench.plug();
        bench
    }

    /// Plugs the cable in; it must be pulled.
    pub fn plug(&mut self) {
        let flags = OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_NONBLOCK | OFlag::O_CLOEXEC;
        let cable = posix_openpt(flags).expect("a pseudo-terminal");
        grantpt(&cable)
            .and_then(|()| unlockpt(&cable))
            .expect("a pseudo-terminal");
        let port = ptsname_r(&cable).expect("its name");

        // Open and close the other end once, so that it counts as closed until a program opens it.
        // Make it raw, so that it neither echoes nor changes bytes.
        let terminal = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(OFlag::O_NOCTTY.bits())
            .open(&port)
            .expect("the other end");
        let mut settings = tcgetattr(&terminal).expect("its settings");
        cfmakeraw(&mut settings);
        tcsetattr(&terminal, SetArg::TCSANOW, &settings).expect("a terminal");
        drop(terminal);

        symlink(port, &self.name).expect("a link");
        self.cable = Some(cable);
    }

    /// Pulls the cable; the port no longer exists.
    pub fn unplug(&mut self) {
        self.cable = None;
        fs::remove_file(&self.name).expect("the link");
    }

    /// Receives the host's bytes. Returns true if a program has the other end open.
    pub fn is_heard(&mut self) -> bool {
        // An unplugged board hears nothing.
        let Some(cable) = &mut self.cable else {
            return false;
        };
        let mut bytes = [0; 256];
        match cable.read(&mut bytes) {
            Ok(count) => {
                self.machine
                    .take(&bytes[..count])
                    .expect("the board takes it");
                self.heard = true;
                true
            }
            Err(error) => error.kind() == ErrorKind::WouldBlock,
        }
    }

    /// Sends bytes to the host as fast as it reads them.
    pub fn say(&mut self, mut bytes: &[u8]) {
        while let Some(cable) = self.cable.as_mut().filter(|_| !bytes.is_empty()) {
            match cable.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                // The host may be waiting for its own bytes to be received.
                Err(error) if error.kind() == ErrorKind::WouldBlock && self.is_heard() => {
                    sleep(WAIT)
                }

                // The host has stopped reading.
                Err(_) => return,
            }
        }
    }

    /// Transfers the available data in both directions. `wire` converts the board's messages to
    /// bytes.
    pub fn carry(&mut self, mut wire: impl FnMut(ToHost) -> Vec<u8>) {
        // Messages that no program can hear are lost.
        let is_heard = self.is_heard();
        let messages = self
            .machine
            .sent()
            .unwrap_or_else(|error| panic!("{error}"));
        for message in messages.into_iter().filter(|_| is_heard) {
            self.frame = message.frame().map_or(self.frame, |frame| frame.sequence);
            self.say(&wire(message));
        }
        sleep(WAIT);
    }
}

/// Starts a [`BOARD`] with its application.
pub fn board() -> Machine {
    machine(BOARD)
}

/// Starts a board with its application, by the host's clock.
fn machine(board: &Board) -> Machine {
    // The board runs as fast as a real one, so that the host's messages reach it in time.
    let start = |settings: &Settings| {
        Machine::start(&Settings {
            clock: Clock::Real,
            ..*settings
        })
    };
    on(board, start).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the bytes of a message as the board has sent it.
pub fn wire(message: ToHost) -> Vec<u8> {
    encode(&message, &mut [0; MAX_WIRE]).to_vec()
}

/// Runs a command at the bench's port while `play` is called repeatedly until the command has
/// ended. Panics if the command exceeds [`LIMIT`].
pub fn at_port<M: Linked>(
    bench: &mut Bench<M>,
    command: &mut Command,
    play: impl FnMut(&mut Bench<M>),
) -> Output {
    at_port_for(LIMIT, bench, command, play)
}

/// Runs a command that takes up to `limit` at the bench's port, like [`at_port`]. Panics if it
/// takes longer.
pub fn at_port_for<M: Linked>(
    limit: Duration,
    bench: &mut Bench<M>,
    command: &mut Command,
    mut play: impl FnMut(&mut Bench<M>),
) -> Output {
    command.arg("--port").arg(&bench.name);
    scope(|scope| {
        // The command runs in a thread, while the board is played here.
        let run =
            scope.spawn(move || run(command, limit).unwrap_or_else(|error| panic!("{error}")));
        while !run.is_finished() {
            play(bench);
        }
        run.join().expect("it ended")
    })
}
