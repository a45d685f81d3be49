//! The Raspberry Pi Pico in the emulator rp2040js, as a test instrument: its serial link, log,
//! panel and buttons.
//!
//! The emulator is controlled by lines of text, with bytes as hexadecimal digits; see
//! `host-tests/emulator/rp2040/main.js`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, ensure};
use firmware::app::Key;
use firmware::protocol::{self, Frame, MAX_WIRE, ToHost, encode_command};

use crate::flash::{flash_image, uf2};
use crate::link::{Counts, Inbox};
use crate::process::{self, Running};
use crate::qemu::{LogDecoder, LogLine, Screenshot};
use crate::scratch::Scratch;
use crate::toolchain::workspace;
use crate::up_to_frame;

/// The time that the board is run at once while a frame is awaited.
const SLICE: Duration = Duration::from_millis(1);
/// The number of slices without a frame after which the board counts as silent.
const PATIENCE: u32 = 5000;

/// An emulated Pico.
///
/// Its time advances only while the emulator processes a command such as that of [`Self::run`], so
/// its results are bit-identical in every run. Every method with `&mut self` that returns a
/// `Result` waits until the emulator has processed its command. Dropping it ends the emulator. An
/// emulator that has ended, such as at its time limit, is an error of every such method.
pub struct PicoMachine {
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    _process: Running,
    /// The folder of the program's file. It is removed after the emulator has ended.
    _folder: Scratch,
    /// The decoders of the two links.
    usb: Inbox,
    uart: Inbox,
    log: LogDecoder,
    /// The lines of the log that have not been fetched.
    lines: Vec<LogLine>,
    /// The messages of either link that have not been fetched.
    heard_by_usb: Vec<ToHost>,
    heard_by_uart: Vec<ToHost>,
    is_in_boot_loader: bool,
}

impl PicoMachine {
    /// Starts a board with this firmware in its flash, exactly as `cargo pico` copies it. Node.js
    /// runs the emulator. `limit` is a time of the host, after which the emulator is killed. No
    /// time passes on the board yet. An error means that the ELF file is unusable, that Node.js
    /// cannot be started, or that there is no place for a temporary file ([`Scratch::new`]). A
    /// missing rp2040js shows as an error of the next command. If the project's folder is not
    /// found, this ends the process ([`workspace`]).
    pub fn start(node: &Path, elf: &Path, limit: Duration) -> anyhow::Result<Self> {
        let (start, image) = flash_image(&std::fs::read(elf)?)?;
        Self::flashed(node, &uf2(start, &image), elf, limit)
    }

    /// Starts a board whose flash has been written by this UF2 file. The ELF file is used to decode
    /// the log. `limit` and errors are as in [`Self::start`]. A wrong or empty UF2 file ends the
    /// emulator, which is an error of the next command. Not checked: that both files are of the
    /// same program.
    pub fn flashed(
        node: &Path,
        blocks: &[u8],
        elf: &Path,
        limit: Duration,
    ) -> anyhow::Result<Self> {
        // The emulator reads the program from a file, as the boot ROM does from the drive.
        let folder = Scratch::new()?;
        let file = folder.path().join("pico.uf2");
        std::fs::write(&file, blocks)?;

        let mut command = Command::new(node);
        // Other boards use the other processors, so Node.js compiles in its own thread.
        command
            .arg("--single-threaded")
            .arg(workspace().join("host-tests/emulator/rp2040/main.js"))
            .arg(&file);
        command.stdin(Stdio::piped()).stdout(Stdio::piped());

        let mut process = process::spawn(&mut command, limit)?;
        let pipes = process.child.stdin.take().zip(process.child.stdout.take());
        let (input, output) = pipes.context("the emulator of the Pico has no pipes")?;
        let output = BufReader::new(output);

        // Nothing has arrived yet.
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
        })
    }

    /// Advances the board's time by `time`, in whole microseconds (a fraction is dropped), and
    /// returns the messages that it has sent over USB since they were last fetched, oldest first.
    /// With no time it only returns them. An error means that the emulator has ended.
    pub fn run(&mut self, time: Duration) -> anyhow::Result<Vec<ToHost>> {
        self.tell(&format!("run {}", time.as_micros()))?;
        Ok(std::mem::take(&mut self.heard_by_usb))
    }

    /// Runs to the end of the millisecond in which the next frame arrives over USB, and returns all
    /// messages of USB that have not been fetched, oldest first. A waiting frame that has not been
    /// fetched counts as the next; the board then runs for one millisecond. It is an error if 5 s
    /// of the board bring no frame, or if the emulator has ended; the messages are then lost.
    pub fn run_to_frame(&mut self) -> anyhow::Result<Vec<ToHost>> {
        up_to_frame(PATIENCE, || self.run(SLICE))
    }

    /// Runs as [`Self::run_to_frame`] does and returns the frame, the last one if several were
    /// waiting. All other messages are dropped. Errors are as there.
    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        self.run_to_frame()?
            .into_iter()
            .rev()
            .find_map(ToHost::frame)
            .context("it ends with one")
    }

    /// Sends bytes over USB. The board takes them when it runs; until then they are kept, also
    /// while the port is closed. Bytes that are sent while the board is not on USB are lost: after
    /// the start and during a restart, until it has connected.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.tell(&format!("usb {}", digits(bytes))).map(drop)
    }

    /// Sends a command over USB with this request number, as [`Self::send_bytes`] does.
    pub fn send(&mut self, request: u16, command: protocol::Command) -> anyhow::Result<()> {
        self.send_bytes(encode_command(request, command, &mut [0; MAX_WIRE]))
    }

    /// Sends a command to the UART with this request number. Its bytes arrive at once, in a queue
    /// of 32 that the board empties when it runs. Bytes that do not fit are lost, as of a longer
    /// command such as [`Simulate`](protocol::Command::Simulate).
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

    /// Opens the USB serial port at this speed, bits per second, or closes it if `baud` is 0. The
    /// port is open at the start, at 460,800. A restart of the board keeps the setting. The board
    /// notices when it runs, and sends nothing over USB while the port is closed. If the port is
    /// opened at the speed [`BAUD_OF_BOOT_LOADER`](crate::link::BAUD_OF_BOOT_LOADER) and then
    /// closed, the board restarts in its boot loader.
    pub fn set_port(&mut self, baud: u32) -> anyhow::Result<()> {
        self.tell(&format!("port {baud}")).map(drop)
    }

    /// Returns true if the program has ever handed over to the chip's boot loader; it stays true.
    pub fn is_in_boot_loader(&self) -> bool {
        self.is_in_boot_loader
    }

    /// Returns the messages that the board has sent by the UART since the last call, oldest first.
    /// It does not run the board.
    pub fn heard_by_uart(&mut self) -> Vec<ToHost> {
        std::mem::take(&mut self.heard_by_uart)
    }

    /// Returns the lines of the log since the last call, oldest first. It does not run the board.
    pub fn lines(&mut self) -> Vec<LogLine> {
        std::mem::take(&mut self.lines)
    }

    /// Returns the counts of the USB link (first) and of the UART since the start.
    pub fn counts(&self) -> [Counts; 2] {
        [self.usb.counts, self.uart.counts]
    }

    /// Returns the picture in the memory of the panel, with greys of 0 and 15 only. It is black
    /// while the panel is off.
    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        Ok(Screenshot::from_pages(&self.tell("panel")?))
    }

    /// Presses (`down`) or releases one of the five buttons: up, down, left, right or select. The
    /// board sees it when it runs, and obeys once two of its readings in a row, 1/60 s apart,
    /// agree.
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

    /// Sends a command to the emulator: a line of `main.js`, without a newline, which is not
    /// checked. Returns the bytes that it requests, such as the panel's memory; empty if it
    /// requests none. The messages and log lines that arrive meanwhile are kept. An error means
    /// that the emulator has ended, as it does after an unknown command, or has printed something
    /// else than hexadecimal digits.
    pub fn tell(&mut self, command: &str) -> anyhow::Result<Vec<u8>> {
        const GONE: &str = "the emulator of the Pico no longer answers";
        writeln!(self.input, "{command}")
            .and_then(|()| self.input.flush())
            .context(GONE)?;
        let mut result = Vec::new();

        // The emulator's lines until it is done: the bytes that the board has sent, and events.
        loop {
            let mut answer = String::new();
            ensure!(self.output.read_line(&mut answer).context(GONE)? > 0, GONE);

            let (word, digits) = answer
                .trim_end()
                .split_once(' ')
                .unwrap_or((answer.trim_end(), ""));

            // Bytes are pairs of hexadecimal digits.
            let byte = |pair: &[u8]| u8::from_str_radix(str::from_utf8(pair).ok()?, 16).ok();
            let bytes = digits
                .as_bytes()
                .chunks(2)
                .map(byte)
                .collect::<Option<Vec<_>>>()
                .context(GONE)?;
            // Each kind of line has its receiver.
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

/// Returns bytes in the emulator's format.
fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
