//! The Raspberry Pi Pico in the emulator rp2040js, as a test instrument: its serial link, log,
//! panel and buttons.
//!
//! The emulator is controlled by lines of text, with bytes as hexadecimal digits; see
//! `host-tests/boards/rp2040/main.js`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, ensure};
use firmware::app::Key;
use firmware::graphics::PanelName;
use firmware::protocol::{self, Frame, MAX_WIRE, ToHost, encode_command};

use crate::flash::image::{flash_image, uf2};
use crate::link::{Counts, Inbox};
use crate::process::{self, Running};
use crate::qemu::{LogDecoder, LogLine, Screenshot};
use crate::scratch::Scratch;
use crate::toolchain::workspace;
use crate::up_to_frame;

const SLICE: Duration = Duration::from_millis(1);
const PATIENCE: u32 = 5000;

/// An emulated Pico. Its time advances only while the emulator processes a command, so its results
/// are bit-identical in every run.
pub struct PicoMachine {
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    _process: Running,
    _folder: Scratch,
    usb: Inbox,
    uart: Inbox,
    log: LogDecoder,
    lines: Vec<LogLine>,
    heard_by_usb: Vec<ToHost>,
    heard_by_uart: Vec<ToHost>,
    is_in_boot_loader: bool,
    panel: PanelName,
}

impl PicoMachine {
    pub fn start(
        node: &Path,
        elf: &Path,
        panel: PanelName,
        limit: Duration,
    ) -> anyhow::Result<Self> {
        let (start, image) = flash_image(&std::fs::read(elf)?)?;
        Self::flashed(node, &uf2(start, &image), elf, panel, limit)
    }

    /// The ELF file is used to decode the log.
    pub fn flashed(
        node: &Path,
        blocks: &[u8],
        elf: &Path,
        panel: PanelName,
        limit: Duration,
    ) -> anyhow::Result<Self> {
        let folder = Scratch::new()?;
        let file = folder.path().join("pico.uf2");
        std::fs::write(&file, blocks)?;

        let mut command = Command::new(node);
        // Other boards use the other processors, so Node.js compiles in its own thread.
        command
            .arg("--single-threaded")
            .arg(workspace().join("host-tests/boards/rp2040/main.js"))
            .arg(&file)
            .arg(panel.name());
        command.stdin(Stdio::piped()).stdout(Stdio::piped());

        let mut process = process::spawn(&mut command, limit)?;
        let pipes = process.child.stdin.take().zip(process.child.stdout.take());
        let (input, output) = pipes.context("the emulator of the Pico has no pipes")?;
        let output = BufReader::new(output);

        let log = LogDecoder::new(elf)?;
        let usb = Inbox::default();
        let uart = Inbox::default();
        let lines = Vec::new();
        let heard_by_usb = Vec::new();
        let heard_by_uart = Vec::new();
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
            panel,
        })
    }

    /// Advances the board's time.
    pub fn run(&mut self, time: Duration) -> anyhow::Result<Vec<ToHost>> {
        self.tell(&format!("run {}", time.as_micros()))?;
        Ok(std::mem::take(&mut self.heard_by_usb))
    }

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

    /// Bytes that are sent while the board is not on USB are lost.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.tell(&format!("usb {}", digits(bytes))).map(drop)
    }

    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    /// The bytes arrive at once, in a queue of 32.
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

    /// Opens the USB serial port at this speed, or closes it if `baud` is 0.
    pub fn set_port(&mut self, baud: u32) -> anyhow::Result<()> {
        self.tell(&format!("port {baud}")).map(drop)
    }

    pub fn is_in_boot_loader(&self) -> bool {
        self.is_in_boot_loader
    }

    pub fn heard_by_uart(&mut self) -> Vec<ToHost> {
        std::mem::take(&mut self.heard_by_uart)
    }

    pub fn lines(&mut self) -> Vec<LogLine> {
        std::mem::take(&mut self.lines)
    }

    pub fn counts(&self) -> [Counts; 2] {
        [self.usb.counts, self.uart.counts]
    }

    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        let bytes = self.tell("panel")?;
        Ok(match self.panel {
            PanelName::Oled => Screenshot::from_pages(&bytes),
            panel => Screenshot::from_colours(panel.format(), &bytes),
        })
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

    /// Sends a line of `main.js`.
    pub fn tell(&mut self, command: &str) -> anyhow::Result<Vec<u8>> {
        const GONE: &str = "the emulator of the Pico no longer answers";
        writeln!(self.input, "{command}")
            .and_then(|()| self.input.flush())
            .context(GONE)?;
        let mut result = Vec::new();

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
                // Bytes that were cut off by the restart are no damage of the link.
                "restarted" => (self.usb.decoder, self.uart.decoder) = Default::default(),
                "bootloader" => self.is_in_boot_loader = true,
                "done" => return Ok(result),
                _ => result = bytes,
            }
        }
    }
}

fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
