//! `cargo demo --port`: a pseudo-terminal with an emulated board behind it, whose cable can be pulled.

mod support;

use std::fs;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::Command;
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use firmware::protocol::{Frame, MAX_WIRE, encode, frame};
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::process::{Output, run};
use host_tests::emulator::qemu::{Clock, Machine, Settings};
use host_tests::link::Received;

use nix::fcntl::OFlag;
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use support::{LIMIT, application, settings, toolchain};

/// A board that is quick to emulate, and has neither panel nor buttons.
const BOARD: &Board = &BOARDS[2];
/// From one look at the cable to the next.
const WAIT: Duration = Duration::from_millis(1);
/// A cable stays out for so long.
const OUT: Duration = Duration::from_millis(700);
/// A foreign device is there for so long.
const FOREIGN: Duration = Duration::from_secs(4);

/// A board at a port, by a name that stays when the cable is pulled.
struct Bench {
    machine: Machine,
    cable: Option<PtyMaster>,
    /// The host has said something.
    heard: bool,
    _folder: tempfile::TempDir,
    name: PathBuf,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let name = folder.path().join("ttyACM0");
        let mut bench = Self { machine: board(), cable: None, heard: false, _folder: folder, name };
        bench.plug();
        bench
    }

    fn plug(&mut self) {
        let flags = OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_NONBLOCK | OFlag::O_CLOEXEC;
        let cable = posix_openpt(flags).expect("a pseudo-terminal");
        grantpt(&cable).and_then(|()| unlockpt(&cable)).expect("a pseudo-terminal");
        symlink(ptsname_r(&cable).expect("its name"), &self.name).expect("a link");
        self.cable = Some(cable);
    }

    fn unplug(&mut self) {
        self.cable = None;
        fs::remove_file(&self.name).expect("the link");
    }

    /// Takes what the host has said; whether anybody listens at its end.
    fn is_heard(&mut self) -> bool {
        let Some(cable) = &mut self.cable else { return false };
        let mut bytes = [0; 256];
        match cable.read(&mut bytes) {
            Ok(count) => {
                self.machine.serial.send_bytes(&bytes[..count]).expect("the board takes it");
                self.heard = true;
                true
            }
            Err(error) => error.kind() == ErrorKind::WouldBlock,
        }
    }

    /// Sends bytes to the host, as fast as it takes them.
    fn say(&mut self, mut bytes: &[u8]) {
        let Some(cable) = &mut self.cable else { return };
        while !bytes.is_empty() {
            match cable.write(bytes) {
                Ok(count) => bytes = &bytes[count..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => sleep(WAIT),
                // It has stopped listening.
                Err(_) => return,
            }
        }
    }

    /// Carries what is there both ways; `wire` makes bytes of the board's messages.
    fn carry(&mut self, mut wire: impl FnMut(&Received) -> Vec<u8>) {
        let is_heard = self.is_heard();
        let messages: Vec<_> = self.machine.serial.all_arrived().collect();
        for message in messages.iter().filter(|_| is_heard) {
            self.say(&wire(message));
        }
        sleep(WAIT);
    }
}

fn board() -> Machine {
    let (toolchain, elf) = (toolchain(), application(BOARD));
    // As fast as a real one: what the host says must reach it in time.
    let settings = Settings { clock: Clock::Real, ..settings(&toolchain, BOARD, &elf) };
    Machine::start(&settings).unwrap_or_else(|error| panic!("{error}"))
}

/// A message as the board has sent it.
fn intact(message: &Received) -> Vec<u8> {
    frame(message.kind, &message.fields, &mut [0; MAX_WIRE]).to_vec()
}

/// Runs the demonstration beside `play`, which is called until it has ended.
fn demo(bench: &mut Bench, arguments: &[&str], mut play: impl FnMut(&mut Bench)) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_demo"));
    command.arg("--port").arg(&bench.name).args(["--headless"]).args(arguments);
    scope(|scope| {
        let demo = scope.spawn(move || run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}")));
        while !demo.is_finished() {
            play(bench);
        }
        demo.join().expect("it ended")
    })
}

#[test]
fn every_frame_of_a_board_at_a_port_is_compared_and_a_damaged_one_counted() {
    let mut bench = Bench::new();
    let damaged = |message: &Received| {
        let mut wire = intact(message);
        if message.read::<Frame>().is_some_and(|frame| frame.sequence == 400) {
            wire[30] ^= 0x10;
        }
        wire
    };
    let output = demo(&mut bench, &["--scene", "butterfly", "--seconds", "8"], |bench| bench.carry(damaged));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.contains("frames, every bit the host's"), "{}", output.stdout);
    assert!(output.stdout.contains("CRC errors            1\nlost frames           1\n"), "{}", output.stdout);
}

#[test]
fn one_flipped_bit_is_named_and_fails() {
    let mut bench = Bench::new();
    let flipped = |message: &Received| match message.read::<Frame>() {
        Some(mut frame) if frame.sequence == 300 => {
            frame.state[2] = f32::from_bits(frame.state[2].to_bits() ^ 1);
            encode(&frame, &mut [0; MAX_WIRE]).to_vec()
        }
        _ => intact(message),
    };
    let output = demo(&mut bench, &["--seconds", "8"], |bench| bench.carry(flipped));
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(
        output.stderr.contains("not well: frame 300, step ") && output.stderr.contains(": p1 is 0x"),
        "{}",
        output.stderr
    );
}

#[test]
fn a_board_that_restarts_is_followed_again() {
    let mut bench = Bench::new();
    let mut restarted = false;
    let output = demo(&mut bench, &["--seconds", "8"], |bench| {
        let mut frames = 0;
        bench.carry(|message| {
            frames = message.read::<Frame>().map_or(frames, |frame| frame.sequence);
            intact(message)
        });
        if !restarted && bench.heard && frames > 200 {
            (bench.machine, restarted) = (board(), true);
        }
    });
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stderr.contains("the board has been switched on or reset"), "{}", output.stderr);
    assert!(output.stdout.contains("frames, every bit the host's"), "{}", output.stdout);
}

#[test]
fn a_pulled_cable_is_said_and_waited_for() {
    let mut bench = Bench::new();
    let mut pulled = None;
    let output = demo(&mut bench, &["--seconds", "8"], |bench| {
        let mut frames = 0;
        bench.carry(|message| {
            frames = message.read::<Frame>().map_or(frames, |frame| frame.sequence);
            intact(message)
        });
        match pulled {
            None if bench.heard && frames > 200 => {
                bench.unplug();
                pulled = Some(Instant::now());
            }
            Some(since) if bench.cable.is_none() && since.elapsed() > OUT => bench.plug(),
            _ => {}
        }
    });
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let told: Vec<_> = output.stderr.lines().filter(|line| line.contains("ttyACM0 is ")).collect();
    assert!(told.len() == 2 && told[0].contains("is gone") && told[1].ends_with("is back"), "{}", output.stderr);
    assert!(output.stdout.contains("frames, every bit the host's"), "{}", output.stdout);
}

#[test]
fn a_foreign_device_is_said_and_a_board_in_its_place_is_taken() {
    let mut bench = Bench::new();
    let mut foreign = None;
    let output = demo(&mut bench, &["--seconds", "2"], |bench| {
        if bench.is_heard() && foreign.get_or_insert_with(Instant::now).elapsed() < FOREIGN {
            bench.say(b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n");
            sleep(Duration::from_millis(20));
        } else {
            bench.carry(intact);
        }
    });
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(output.stderr.matches("no message: another device").count(), 1, "{}", output.stderr);
    assert_eq!(output.stderr.matches("the board sends again").count(), 1, "{}", output.stderr);
}

#[test]
fn a_port_where_nothing_comes_is_given_up() {
    let mut bench = Bench::new();
    let output = demo(&mut bench, &[], |_| sleep(WAIT));
    assert_eq!((output.status.code(), output.stdout.as_str()), (Some(1), ""), "{output:?}");
    assert!(
        output.stderr.contains("nothing comes") && output.stderr.contains("no frame for 10 s"),
        "{}",
        output.stderr
    );
}
