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

use boards::pico::PicoMachine;
use boards::process::{Output, run};
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::{Board, LM3S6965EVB};
use firmware::protocol::{MAX_WIRE, ToHost, encode};
use nix::fcntl::OFlag;
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

use crate::support::{LIMIT, on};

pub const BOARD: &Board = &LM3S6965EVB;
pub const WAIT: Duration = Duration::from_millis(1);
pub trait Linked {
    fn take(&mut self, bytes: &[u8]) -> anyhow::Result<()>;

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

pub struct Bench<M = Machine> {
    pub machine: M,
    pub cable: Option<PtyMaster>,
    pub heard: bool,
    pub frame: u32,
    _folder: tempfile::TempDir,
    pub name: PathBuf,
}

impl Bench {
    pub fn new() -> Self {
        Self::of(BOARD)
    }

    pub fn of(board: &Board) -> Self {
        Self::with(machine(board))
    }
}

impl<M: Linked> Bench<M> {
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

    pub fn unplug(&mut self) {
        self.cable = None;
        fs::remove_file(&self.name).expect("the link");
    }

    pub fn is_heard(&mut self) -> bool {
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

pub fn board() -> Machine {
    machine(BOARD)
}

fn machine(board: &Board) -> Machine {
    // The board runs as fast as a real one, so that the host's messages reach it in time.
    let start = |settings: &MachineSettings| {
        Machine::start(&MachineSettings {
            clock: Clock::Real,
            ..*settings
        })
    };
    on(board, start).unwrap_or_else(|error| panic!("{error}"))
}

pub fn wire(message: ToHost) -> Vec<u8> {
    encode(&message, &mut [0; MAX_WIRE]).to_vec()
}

pub fn at_port<M: Linked>(
    bench: &mut Bench<M>,
    command: &mut Command,
    play: impl FnMut(&mut Bench<M>),
) -> Output {
    at_port_for(LIMIT, bench, command, play)
}

pub fn at_port_for<M: Linked>(
    limit: Duration,
    bench: &mut Bench<M>,
    command: &mut Command,
    mut play: impl FnMut(&mut Bench<M>),
) -> Output {
    command.arg("--port").arg(&bench.name);
    scope(|scope| {
        let run =
            scope.spawn(move || run(command, limit).unwrap_or_else(|error| panic!("{error}")));
        while !run.is_finished() {
            play(bench);
        }
        run.join().expect("it ended")
    })
}
