//! The executed stream, out of QEMU's log.
//!
//! QEMU runs one instruction per translation block (`-singlestep`, since 8.1 `one-insn-per-tb`) and, before each,
//! writes the processor's registers to its log (`-d cpu,nochain`): no plugin, nothing to compile, the same text since
//! 2.x. The log comes through a pipe, a few hundred thousand instructions per second.

use std::io::{self, BufRead, BufReader, Read};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use firmware::measure::{Outcome, Request};

use super::{CountError, Target};
use crate::emulator::process;

/// How long one run may take.
const LIMIT: Duration = Duration::from_secs(1800);
/// How long QEMU may take to tell its version.
const VERSION_LIMIT: Duration = Duration::from_secs(10);

/// The registers that matter, before the instruction at `pc` is executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Registers {
    /// The stack pointer.
    pub sp: u32,
    /// The link register.
    pub lr: u32,
    /// The address of the instruction.
    pub pc: u32,
}

impl Registers {
    /// Reads the log's line of registers 12 to 15; `None` for any other line.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let mut words = line.strip_prefix("R12=")?.split_ascii_whitespace().skip(1);
        let mut register = |name| u32::from_str_radix(words.next()?.strip_prefix(name)?, 16).ok();
        Some(Self { sp: register("R13=")?, lr: register("R14=")?, pc: register("R15=")? })
    }
}

impl Target {
    /// Runs `request` at full speed: its outcome, and the ticks of the board's clock under `-icount`, where an
    /// instruction takes 1 ns.
    pub fn run(&self, request: &Request) -> Result<(Outcome, u64), CountError> {
        let output = self.output(request)?;
        let refused = || CountError::Refused { request: request.to_string(), reason: output.trim().to_owned() };
        let (outcome, ticks) = output.trim().rsplit_once(' ').ok_or_else(refused)?;
        Ok((Outcome::parse(outcome).map_err(|_| refused())?, ticks.parse().map_err(|_| refused())?))
    }

    /// Runs `request` at full speed: what it prints.
    pub fn output(&self, request: &Request) -> Result<String, CountError> {
        Ok(process::run(self.emulator(request).args(["-icount", "shift=0"]), LIMIT)?.stdout)
    }

    /// Runs `request` and calls `each` before every instruction, in order.
    pub fn trace(
        &self,
        request: &Request,
        mut each: impl FnMut(Registers) -> Result<(), CountError>,
    ) -> Result<(), CountError> {
        let mut command = self.emulator(request);
        command.args(self.single_step()?).args(["-d", "cpu,nochain", "-D", "/dev/stderr"]);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = process::spawn(&mut command, LIMIT)?;
        let stdout = child.stdout.take().map(|mut stdout| {
            thread::spawn(move || {
                let mut text = String::new();
                stdout.read_to_string(&mut text).map(|_| text)
            })
        });
        if let Some(log) = child.stderr.take() {
            for_each_line(log, |line| Registers::parse(line).map_or(Ok(()), &mut each))?;
        }
        if child.wait()?.success() {
            return Ok(());
        }
        let reason = stdout.and_then(|reader| reader.join().ok()).and_then(Result::ok).unwrap_or_default();
        Err(CountError::Refused { request: request.to_string(), reason: reason.trim().to_owned() })
    }

    /// QEMU with nothing attached but the semihosting console.
    fn emulator(&self, request: &Request) -> Command {
        let mut command = Command::new(&self.qemu);
        command.args(["-machine", self.board.machine, "-cpu", self.board.cpu]);
        command.args(["-display", "none", "-monitor", "none", "-serial", "null"]);
        command.args(["-semihosting-config", &format!("enable=on,target=native,arg={request}")]);
        command.arg("-kernel").arg(&self.elf);
        command
    }

    /// The options for one instruction per translation block, which QEMU 8.1 renamed.
    fn single_step(&self) -> Result<&'static [&'static str], CountError> {
        let version = process::run(Command::new(&self.qemu).arg("--version"), VERSION_LIMIT)?.stdout;
        let mut words = version.split_ascii_whitespace();
        let number = words.find(|word| word.starts_with(|first: char| first.is_ascii_digit()));
        let mut parts = number.unwrap_or_default().split('.').map_while(|part| part.parse::<u32>().ok());
        match (parts.next(), parts.next()) {
            (Some(major), Some(minor)) if (major, minor) < (8, 1) => Ok(&["-singlestep"]),
            (Some(_), Some(_)) => Ok(&["-accel", "tcg,one-insn-per-tb=on"]),
            _ => Err(CountError::UnknownVersion { version }),
        }
    }
}

/// Calls `each` with every line of a log, until it refuses one.
pub(super) fn for_each_line(
    log: impl Read,
    mut each: impl FnMut(&str) -> Result<(), CountError>,
) -> Result<(), CountError> {
    let mut log = BufReader::with_capacity(1 << 20, log);
    let mut line = String::new();
    loop {
        line.clear();
        match log.read_line(&mut line) {
            Ok(0) => return Ok(()),
            Ok(_) => each(&line)?,
            // the log is ASCII; a stray byte in a line of no interest is none either
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {}
            Err(source) => return Err(CountError::Log { source }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_line_of_registers_is_read() {
        let log = "R12=fffffbfd R13=2000fc98 R14=000009c7 R15=000025e2\n";
        assert_eq!(Registers::parse(log), Some(Registers { sp: 0x2000_fc98, lr: 0x9c7, pc: 0x25e2 }));
        assert_eq!(Registers::parse("R08=fffffbfc R09=00000000 R10=00000000 R11=00000000\n"), None);
        assert_eq!(Registers::parse("XPSR=81000000 N--- T priv-thread\n"), None);
    }
}
