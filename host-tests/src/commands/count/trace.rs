//! A board with the program that measures, and the stream that it executes, out of QEMU's log.
//!
//! QEMU runs one instruction per translation block (`-singlestep`, since 8.1 `one-insn-per-tb`) and, before each,
//! writes the processor's registers to its log (`-d cpu,nochain`): no plugin, nothing to compile, the same text since
//! 2.x. The log comes through a pipe, a few hundred thousand instructions per second.

use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result};
use cycles::{Core, Image, Registers, for_each_instruction};
use firmware::job::Request;

use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::process;
use crate::emulator::toolchain::Toolchain;

pub(super) const LIMIT: Duration = Duration::from_secs(1800);
const VERSION_LIMIT: Duration = Duration::from_secs(10);

#[derive(Debug)]
pub struct Ended {
    /// What QEMU's exit says of it; `None` if its time was up.
    pub status: Option<ExitStatus>,
    pub output: String,
}

const PROGRAM: &str = "measure";

/// An emulated board and a program built for it.
#[derive(Debug)]
pub struct Target {
    pub board: &'static Board,
    pub(super) qemu: PathBuf,
    pub(super) elf: PathBuf,
    image: Image,
}

impl Target {
    pub fn build(toolchain: &Toolchain, board: &'static Board) -> Result<Self> {
        Self::of(toolchain, board, toolchain.build(PROGRAM, board.target)?)
    }

    /// Another program. One that takes the same requests makes its steps in a function called `counted_steps`.
    pub fn of(toolchain: &Toolchain, board: &'static Board, elf: PathBuf) -> Result<Self> {
        let image = Image::read(&elf)?;
        Ok(Self { board, qemu: toolchain.qemu().to_owned(), elf, image })
    }

    /// One board for each kind of core: the same machine with a Cortex-M3, a Cortex-M4F and a Cortex-M0+.
    pub fn build_all(toolchain: &Toolchain) -> Result<Vec<Self>> {
        BOARDS.iter().filter(|board| board.has_panel).map(|board| Self::build(toolchain, board)).collect()
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    pub fn core(&self) -> Core {
        self.board.core()
    }

    /// Runs `request` at full speed: its CRC, and the ticks of the board's clock under `-icount`, where an
    /// instruction takes 1 ns.
    pub fn run(&self, request: &Request) -> Result<(u32, u64)> {
        let output = self.output(request)?;
        let numbers = output.trim().split_once(' ');
        let numbers = numbers.and_then(|(crc, ticks)| Some((u32::from_str_radix(crc, 16).ok()?, ticks.parse().ok()?)));
        numbers.with_context(|| format!("{}: {}", request.method, output.trim()))
    }

    /// Runs `request` at full speed: what it prints.
    pub fn output(&self, request: &Request) -> Result<String> {
        Ok(process::run(self.emulator(&request.to_string()).args(["-icount", "shift=0"]), LIMIT)?.stdout)
    }

    /// Runs the program with `argument` on its semihosting command line and calls `each` before every instruction, in
    /// order.
    pub(super) fn trace(
        &self,
        argument: &str,
        limit: Duration,
        each: &mut dyn FnMut(Registers) -> Result<()>,
    ) -> Result<Ended> {
        let mut command = self.emulator(argument);
        command.args(self.single_step()?).args(["-d", "cpu,nochain", "-D", "/dev/stderr"]);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = process::spawn(&mut command, limit)?;
        let stdout = child.stdout.take().map(|stdout| thread::spawn(move || std::io::read_to_string(stdout)));
        if let Some(mut log) = child.stderr.take() {
            for_each_instruction(&mut log, each)?;
        }
        let status = match child.wait() {
            Ok(status) => Some(status),
            Err(error) if error.kind() == ErrorKind::TimedOut => None,
            Err(error) => return Err(error.into()),
        };
        let output = stdout.and_then(|reader| reader.join().ok()).and_then(Result::ok).unwrap_or_default();
        Ok(Ended { status, output })
    }

    /// QEMU with nothing attached but the semihosting console.
    fn emulator(&self, argument: &str) -> Command {
        let mut command = Command::new(&self.qemu);
        command.args(["-machine", self.board.machine, "-cpu", self.board.cpu]);
        command.args(["-display", "none", "-monitor", "none", "-serial", "null"]);
        let argument = if argument.is_empty() { String::new() } else { format!(",arg={argument}") };
        command.args(["-semihosting-config", &format!("enable=on,target=native{argument}")]);
        command.arg("-kernel").arg(&self.elf);
        command
    }

    /// The options for one instruction per translation block, which QEMU 8.1 renamed.
    fn single_step(&self) -> Result<&'static [&'static str]> {
        let version = process::run(Command::new(&self.qemu).arg("--version"), VERSION_LIMIT)?.stdout;
        let mut words = version.split_ascii_whitespace();
        let number = words.find(|word| word.starts_with(|first: char| first.is_ascii_digit()));
        let mut parts = number.unwrap_or_default().split('.').map_while(|part| part.parse::<u32>().ok());
        let parts = parts.next().zip(parts.next());
        let number = parts.with_context(|| format!("cannot tell QEMU's version from {version:?}"))?;
        Ok(if number < (8, 1) { &["-singlestep"] } else { &["-accel", "tcg,one-insn-per-tb=on"] })
    }
}
