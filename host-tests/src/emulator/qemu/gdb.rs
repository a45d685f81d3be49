//! The few packets of GDB's remote protocol that stop a machine whenever its processor is about to sleep, or anywhere
//! else, and open its memory.
//!
//! Source: GDB manual, appendix E (Remote Serial Protocol): `$text#checksum`, each acknowledged with `+`.

use std::io::{BufRead, BufReader, Read, Write};
use std::ops::Range;
use std::os::unix::net::UnixStream;

use anyhow::{Context, anyhow};

/// The size of the instruction `wfi`, and what any breakpoint is said to take, bytes.
const SIZE: u32 = 2;
const PIECE: u32 = 512;
const PC: &str = "f";

/// Asks what registers there are; until then QEMU gives access to none.
const DESCRIBE: &str = "qXfer:features:read:target.xml:0,10";

/// A connection to QEMU's debugger port. The machine stands still except inside [`run_to_sleep`](Self::run_to_sleep) and
/// [`run_to`](Self::run_to), and after [`run`](Self::run).
#[derive(Debug)]
pub(super) struct Debugger {
    reader: BufReader<UnixStream>,
    writer: UnixStream,
    /// Where it stops when it is let run to the next of them.
    sleeps: Vec<u32>,
    /// Whether breakpoints are set there.
    stops: bool,
    /// The machine was run to a place, and stands there.
    is_placed: bool,
    /// The machine stands at this `wfi`.
    asleep_at: Option<u32>,
}

impl Debugger {
    /// Will run to the instructions `wfi` at these addresses.
    pub(super) fn new(socket: UnixStream, sleeps: Vec<u32>) -> anyhow::Result<Self> {
        let writer = socket.try_clone()?;
        let mut debugger =
            Self { reader: BufReader::new(socket), writer, sleeps, stops: false, is_placed: false, asleep_at: None };
        debugger.ask(DESCRIBE)?;
        Ok(debugger)
    }

    /// Lets the machine run until its processor is about to sleep.
    pub(super) fn run_to_sleep(&mut self) -> anyhow::Result<()> {
        self.leave(true)?;
        self.is_placed = false;
        self.expect("c", "T05")?;
        let answer = self.ask(&format!("p{PC}"))?;
        let address = u32::from_str_radix(&answer, 16).map_err(|_| unexpected("p", &answer))?;
        self.asleep_at = Some(address.swap_bytes());
        Ok(())
    }

    /// Prepares the machine to run on; `stops` says whether it stops before it sleeps.
    ///
    /// The `wfi` it stands at is passed over: the architecture lets it wake at any time, and while the machine stood
    /// still QEMU has put its clock forward to the next event, which is just what sleeping does.
    fn leave(&mut self, stops: bool) -> anyhow::Result<()> {
        if std::mem::replace(&mut self.stops, stops) != stops {
            let kind = if stops { 'Z' } else { 'z' };
            self.sleeps.clone().iter().try_for_each(|at| self.expect(&format!("{kind}0,{at:x},{SIZE}"), "OK"))?;
        }
        let Some(address) = self.asleep_at.take() else { return Ok(()) };
        let next = (address + SIZE).swap_bytes();
        self.expect(&format!("P{PC}={next:08x}"), "OK")
    }

    /// Lets the machine run until the instruction at this address is about to be executed, the next time if it stands there.
    pub(super) fn run_to(&mut self, address: u32) -> anyhow::Result<()> {
        self.leave(false)?;
        // A machine that was stopped may be asleep, and then makes no step.
        if std::mem::replace(&mut self.is_placed, true) {
            self.expect("s", "T05")?;
        }
        self.expect(&format!("Z0,{address:x},{SIZE}"), "OK")?;
        self.expect("c", "T05")?;
        self.expect(&format!("z0,{address:x},{SIZE}"), "OK")
    }

    /// Lets the machine run until [`stop`](Self::stop).
    pub(super) fn run(&mut self) -> anyhow::Result<()> {
        self.leave(false)?;
        self.send("c")
    }

    /// Stops the machine wherever it is. QEMU takes no byte for anything else while it runs.
    pub(super) fn stop(&mut self) -> anyhow::Result<()> {
        self.is_placed = false;
        self.say("\x03")?;
        let reply = self.hear()?;
        if reply.starts_with("T02") { Ok(()) } else { Err(unexpected("an interrupt", &reply)) }
    }

    pub(super) fn write(&mut self, address: u32, bytes: &[u8]) -> anyhow::Result<()> {
        for (start, piece) in (address..).step_by(PIECE as usize).zip(bytes.chunks(PIECE as usize)) {
            let digits: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
            self.expect(&format!("M{start:x},{:x}:{digits}", piece.len()), "OK")?;
        }
        Ok(())
    }

    /// Sets a register of the machine's processor, by GDB's number of it.
    pub(super) fn set(&mut self, register: u32, value: u32) -> anyhow::Result<()> {
        self.expect(&format!("P{register:x}={:08x}", value.swap_bytes()), "OK")
    }

    pub(super) fn read(&mut self, addresses: Range<u32>) -> anyhow::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        for start in addresses.clone().step_by(PIECE as usize) {
            let length = (addresses.end - start).min(PIECE);
            let packet = format!("m{start:x},{length:x}");
            let answer = self.ask(&packet)?;
            let (digits, _) = answer.as_bytes().as_chunks::<2>();
            let byte = |digits: &[u8; 2]| u8::from_str_radix(str::from_utf8(digits).ok()?, 16).ok();
            let piece: Vec<u8> = digits.iter().map_while(byte).collect();
            if piece.len() != length as usize {
                return Err(unexpected(&packet, &answer));
            }
            bytes.extend(piece);
        }
        Ok(bytes)
    }

    /// Sends a packet whose answer must begin with `answer`.
    fn expect(&mut self, packet: &str, answer: &str) -> anyhow::Result<()> {
        let reply = self.ask(packet)?;
        if reply.starts_with(answer) { Ok(()) } else { Err(unexpected(packet, &reply)) }
    }

    fn send(&mut self, packet: &str) -> anyhow::Result<()> {
        let checksum = packet.bytes().fold(0, u8::wrapping_add);
        self.say(&format!("${packet}#{checksum:02x}"))
    }

    fn say(&mut self, text: &str) -> anyhow::Result<()> {
        // Not as it is: a broken pipe would be taken for a closed output, which is no failure.
        self.writer.write_all(text.as_bytes()).map_err(|error| anyhow!("QEMU's debugger port: {error}"))
    }

    fn ask(&mut self, packet: &str) -> anyhow::Result<String> {
        self.send(packet)?;
        self.hear()
    }

    fn hear(&mut self) -> anyhow::Result<String> {
        self.reader.skip_until(b'$')?;
        let mut reply = Vec::new();
        self.reader.read_until(b'#', &mut reply)?;
        self.reader.read_exact(&mut [0; 2]).context("QEMU's debugger port")?;
        self.say("+")?;
        reply.pop();
        Ok(String::from_utf8_lossy(&reply).into_owned())
    }
}

fn unexpected(packet: &str, reply: &str) -> anyhow::Error {
    anyhow!("QEMU refuses the debugger: {packet} was answered with {reply:?}")
}
