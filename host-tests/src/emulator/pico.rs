//! The Raspberry Pi Pico in rp2040js, as an instrument: its serial link, log, panel and buttons. A conversation of lines, bytes as
//! hexadecimal digits; see `host-tests/rp2040/main.js`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, ensure};
use firmware::app::Key;
use firmware::protocol::{self, Frame, MAX_WIRE, ToHost, encode_command};

use crate::emulator::flash::{flash_image, uf2};
use crate::emulator::process::{self, Running};
use crate::emulator::qemu::{LogDecoder, LogLine, Screenshot};
use crate::emulator::scratch::Scratch;
use crate::emulator::toolchain::workspace;
use crate::emulator::up_to_frame;
use crate::link::{Counts, Inbox};

const SLICE: Duration = Duration::from_millis(1);
/// A board that sends no frame for this many of them sends none.
const PATIENCE: u32 = 5000;

/// The board. Its time passes only in [`Self::run`], so all that it does is repeatable bit for bit. Dropping it ends it.
pub struct PicoMachine {
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    _process: Running,
    /// Of the program's file; removed after the emulator has ended.
    _folder: Scratch,
    usb: Inbox,
    uart: Inbox,
    log: LogDecoder,
    lines: Vec<LogLine>,
    heard_by_usb: Vec<ToHost>,
    heard_by_uart: Vec<ToHost>,
    is_in_boot_loader: bool,
}

impl PicoMachine {
    /// Switches a board on with this firmware in its flash: what `cargo pico` copies, and nothing else. Node.js runs it.
    pub fn start(node: &Path, elf: &Path, limit: Duration) -> anyhow::Result<Self> {
        let (start, image) = flash_image(&std::fs::read(elf)?)?;
        Self::flashed(node, &uf2(start, &image), elf, limit)
    }

    /// Switches a board on whose flash has been written by this UF2 file. Its log is read by the ELF
    /// file.
    pub fn flashed(
        node: &Path,
        blocks: &[u8],
        elf: &Path,
        limit: Duration,
    ) -> anyhow::Result<Self> {
        let folder = Scratch::new()?;
        let file = folder.path().join("pico.uf2");
        std::fs::write(&file, blocks)?;
        let mut command = Command::new(node);
        command
            .arg(workspace().join("host-tests/rp2040/main.js"))
            .arg(&file);
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = process::spawn(&mut command, limit)?;
        let pipes = process.child.stdin.take().zip(process.child.stdout.take());
        let (input, output) = pipes.context("the emulator of the Pico has no pipes")?;
        let output = BufReader::new(output);
        let log = LogDecoder::new(elf)?;
        let (usb, uart) = (Inbox::default(), Inbox::default());
        let (lines, heard_by_usb, heard_by_uart) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self {
            input,
            output,
            _process: process,
            _folder: folder,
            usb,
            uart,
            log,
            lines,
            heard_by_usb,
            heard_by_uart,
            is_in_boot_loader: false,
        })
    }

    /// Lets time pass by the board's clock; what it has sent over USB.
    pub fn run(&mut self, time: Duration) -> anyhow::Result<Vec<ToHost>> {
        self.tell(&format!("run {}", time.as_micros()))?;
        Ok(std::mem::take(&mut self.heard_by_usb))
    }

    /// Runs to the next frame: all messages up to it.
    pub fn run_to_frame(&mut self) -> anyhow::Result<Vec<ToHost>> {
        up_to_frame(PATIENCE, || self.run(SLICE))
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.run_to_frame()?
            .into_iter()
            .rev()
            .find_map(ToHost::frame)
            .context("it ends with one")
    }

    pub fn send_bytes(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.tell(&format!("usb {}", digits(bytes))).map(drop)
    }

    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    pub fn send_through_uart(
        &mut self,
        request: u16,
        command: protocol::Command,
    ) -> anyhow::Result<()> {
        self.tell(&format!(
            "uart {}",
            digits(encode_command(request, command, &mut [0; MAX_WIRE]))
        ))
        .map(drop)
    }

    /// Opens the port over USB at this speed, or closes it: 0. It is open at first.
    pub fn set_port(&mut self, baud: u32) -> anyhow::Result<()> {
        self.tell(&format!("port {baud}")).map(drop)
    }

    /// Returns true if the program has handed over to the chip's boot loader.
    pub fn is_in_boot_loader(&self) -> bool {
        self.is_in_boot_loader
    }

    pub fn heard_by_uart(&mut self) -> Vec<ToHost> {
        std::mem::take(&mut self.heard_by_uart)
    }

    pub fn lines(&mut self) -> Vec<LogLine> {
        std::mem::take(&mut self.lines)
    }

    /// What the USB link has been through, and the UART.
    pub fn counts(&self) -> [Counts; 2] {
        [self.usb.counts, self.uart.counts]
    }

    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        Ok(Screenshot::from_pages(&self.tell("panel")?))
    }

    pub fn set_key(&mut self, key: Key, down: bool) -> anyhow::Result<()> {
        let pin = match key {
            Key::Up => 10,
            Key::Down => 11,
            Key::Left => 12,
            Key::Right => 13,
            Key::Select => 14,
        };
        self.tell(&format!("button {pin} {}", u8::from(down)))
            .map(drop)
    }

    /// Gives the emulator a command; the bytes that it asks for, if it asks for any: the panel's memory, the board's.
    pub fn tell(&mut self, command: &str) -> anyhow::Result<Vec<u8>> {
        const GONE: &str = "the emulator of the Pico no longer answers";
        writeln!(self.input, "{command}")
            .and_then(|()| self.input.flush())
            .context(GONE)?;
        let mut asked = Vec::new();
        loop {
            let mut answer = String::new();
            ensure!(self.output.read_line(&mut answer).context(GONE)? > 0, GONE);
            let (word, digits) = answer
                .trim_end()
                .split_once(' ')
                .unwrap_or((answer.trim_end(), ""));
            let byte = |pair: &[u8]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
            let bytes = digits
                .as_bytes()
                .chunks(2)
                .map(byte)
                .collect::<Option<Vec<_>>>()
                .context(GONE)?;
            match word {
                "usb" => self
                    .heard_by_usb
                    .extend(bytes.iter().filter_map(|&byte| self.usb.take(byte))),
                "uart" => self
                    .heard_by_uart
                    .extend(bytes.iter().filter_map(|&byte| self.uart.take(byte))),
                "log" => self.lines.extend(self.log.take(&bytes)),
                // Bytes cut off by it are no damage of the link's.
                "restarted" => (self.usb.decoder, self.uart.decoder) = Default::default(),
                "bootloader" => self.is_in_boot_loader = true,
                "done" => return Ok(asked),
                _ => asked = bytes,
            }
        }
    }
}

/// Bytes as the emulator takes them.
fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
