//! A board with the program that measures, and the stream of instructions that it executes, from
//! QEMU's log.
//!
//! QEMU runs one instruction per translation block (`-singlestep`, since 8.1 `one-insn-per-tb`) and
//! writes the processor's registers to its log before each of them (`-d cpu,nochain`). This needs
//! no plugin and no compilation, and the text has been the same since 2.x. The log is sent through
//! a pipe, with a few hundred thousand instructions per second.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use cycles::{Calls, Image, Registers, for_each_instruction};
use firmware::job::Request;

use super::COUNTED;
use boards::flash::image::flash_image;
use boards::process::{self, Running};
use boards::qemu::{send_packet, take_reply};
use boards::scratch::Scratch;
use boards::stream::{self, Channel};
use boards::toolchain::{QUICK, Toolchain};
use boards::{BOARDS, Board};

pub(super) const LIMIT: Duration = Duration::from_secs(1800);

const LOGGED: &str = "cpu,nochain";
const SIZE: u32 = 2;

#[derive(Debug)]
pub struct Target {
    pub board: &'static Board,
    qemu: PathBuf,
    elf: PathBuf,
    pub image: Image,
}

pub fn one_of_each_core() -> impl Iterator<Item = &'static Board> {
    BOARDS.iter().filter(|board| board.has_panel)
}

impl Target {
    pub fn build(toolchain: &Toolchain, board: &'static Board) -> Result<Self> {
        Self::of(toolchain, board, toolchain.build("measure", board.target)?)
    }

    /// Returns a target with another program, whose steps are made in `counted_steps`.
    pub fn of(toolchain: &Toolchain, board: &'static Board, elf: PathBuf) -> Result<Self> {
        let image = Image::read(&elf)?;
        Ok(Self {
            board,
            qemu: toolchain.qemu.clone(),
            elf,
            image,
        })
    }

    pub fn flash_bytes(&self) -> Result<usize> {
        Ok(flash_image(&std::fs::read(&self.elf)?)?.1.len())
    }

    pub fn build_all(toolchain: &Toolchain) -> Result<Vec<Self>> {
        one_of_each_core()
            .map(|board| Self::build(toolchain, board))
            .collect()
    }

    /// Runs `request` at full speed. Returns its CRC and the ticks of the board's SysTick. Under
    /// `-icount` an instruction takes 1 ns, so on the LM3S6965, at 12.5 MHz after reset, a tick is
    /// 80 instructions.
    pub fn run(&self, request: &Request) -> Result<(u32, u64)> {
        let output = self.output(request)?;
        let numbers = output.trim().split_once(' ');
        let numbers = numbers.and_then(|(crc, ticks)| {
            Some((u32::from_str_radix(crc, 16).ok()?, ticks.parse().ok()?))
        });
        numbers.with_context(|| format!("{}: {}", request.method, output.trim()))
    }

    /// Returns everything that the program prints, even if it or QEMU fails.
    pub fn output(&self, request: &Request) -> Result<String> {
        Ok(process::run(
            self.emulator(&request.to_string())
                .args(["-icount", "shift=0"]),
            LIMIT,
        )?
        .stdout)
    }

    /// Runs the program with `argument`, which contains no comma, on its semihosting command line
    /// and calls `each` before every instruction from the first one at any of these addresses on.
    pub(super) fn trace(
        &self,
        argument: &str,
        entries: &BTreeSet<u32>,
        each: &mut dyn FnMut(Registers) -> Result<()>,
    ) -> Result<()> {
        let mut command = self.emulator(argument);
        command
            .args(self.single_step()?)
            .args(["-D", "/dev/stderr"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());

        // A debugger switches the log on at the first of the addresses, which saves most of the
        // time.
        let folder = Scratch::new()?;
        let path = folder.path().join("debugger");
        command
            .args(["-S", "-gdb", "chardev:debugger", "-chardev"])
            .arg(format!("pipe,id=debugger,path={}", path.display()));
        let mut debugger = Channel::make(&path)?;

        // The output is read by a thread, because a full pipe would stop the program.
        let mut child = process::spawn(&mut command, LIMIT)?;
        let stdout = child
            .child
            .stdout
            .take()
            .map(|stdout| thread::spawn(move || io::read_to_string(stdout)));
        log_from(entries, &mut debugger, &mut child)?;
        if let Some(mut log) = child.child.stderr.take() {
            for_each_instruction(&mut log, each)?;
        }

        let status = child.wait()?;
        let output = stdout
            .and_then(|reader| reader.join().ok())
            .and_then(Result::ok)
            .unwrap_or_default();
        ensure!(status.success(), "{argument}: {}", output.trim());
        Ok(())
    }

    fn emulator(&self, argument: &str) -> Command {
        let mut command = Command::new(&self.qemu);
        command.args(["-machine", self.board.machine, "-cpu", self.board.cpu]);
        command.args(["-display", "none", "-monitor", "none", "-serial", "null"]);
        let argument = if argument.is_empty() {
            String::new()
        } else {
            format!(",arg={argument}")
        };
        command.args([
            "-semihosting-config",
            &format!("enable=on,target=native{argument}"),
        ]);
        command.arg("-kernel").arg(&self.elf);
        command
    }

    /// QEMU 8.1 has renamed the options.
    fn single_step(&self) -> Result<&'static [&'static str]> {
        static IS_RENAMED: Mutex<Option<(PathBuf, bool)>> = Mutex::new(None);
        let mut known = IS_RENAMED.lock().unwrap_or_else(PoisonError::into_inner);
        let is_renamed = match &*known {
            Some((qemu, is_renamed)) if *qemu == self.qemu => *is_renamed,
            _ => {
                let help = process::run(Command::new(&self.qemu).arg("--help"), QUICK)?.stdout;
                let is_renamed = help.contains("one-insn-per-tb");
                *known = Some((self.qemu.clone(), is_renamed));
                is_renamed
            }
        };
        Ok(if is_renamed {
            &["-accel", "tcg,one-insn-per-tb=on"]
        } else {
            &["-singlestep"]
        })
    }
}

/// Lets QEMU, which waits for its debugger, run to the first of these addresses, and switches its
/// log on. Does nothing if the program ends before.
fn log_from(entries: &BTreeSet<u32>, debugger: &mut Channel, child: &mut Running) -> Result<()> {
    let mut ask = |packet: &str| -> Result<Option<String>> {
        send_packet(&mut debugger.sender, packet)?;
        loop {
            debugger.stream.take_in();
            if let Some(reply) = take_reply(&mut debugger.stream.bytes) {
                debugger.sender.write_all(b"+")?;
                return Ok(Some(reply));
            }
            if child.try_wait()?.is_some() {
                return Ok(None);
            }
            stream::wait([&debugger.stream].into_iter());
        }
    };
    let log: String = format!("log {LOGGED}")
        .bytes()
        .map(|byte| format!("{byte:02x}"))
        .collect();

    let breakpoints = |change| {
        let packet = move |entry| (format!("{change}0,{entry:x},{SIZE}"), "OK");
        entries.iter().map(packet)
    };
    let steps = breakpoints('Z')
        .chain([("c".to_owned(), "T05")])
        .chain(breakpoints('z'))
        .chain([(format!("qRcmd,{log}"), "OK")]);
    for (packet, expected) in steps {
        match ask(&packet)? {
            // The program has ended: QEMU is gone, or says so before it goes.
            None => return Ok(()),
            Some(reply) if reply.starts_with('W') => return Ok(()),
            Some(reply) => ensure!(
                reply.starts_with(expected),
                "QEMU refuses the debugger: {packet} was answered with {reply:?}"
            ),
        }
    }
    Ok(send_packet(&mut debugger.sender, "c")?)
}

pub fn counted<'a>(target: &'a Target, request: &Request) -> Result<Calls<'a>> {
    // The compiler makes one copy of the function for each method.
    let entries: BTreeSet<_> = target
        .image
        .functions_named(COUNTED)
        .map(|function| function.address)
        .collect();

    let mut calls = Calls::of(&target.image, target.board.core(), entries.clone());
    target.trace(&request.to_string(), &entries, &mut |registers| {
        calls.see(registers)
    })?;
    ensure!(!calls.ended.is_empty(), "{COUNTED} was never called");
    Ok(calls)
}
