//! A board under a debugger. The machine is stopped through QEMU's debugger port when the firmware
//! has done its work and goes to sleep. A frame is then on the panel and sent, and the next one has
//! not started. The firmware is not involved. Its clock counts instructions, so the duration of a
//! stop affects no result.
//!
//! This module implements the few packets of GDB's remote protocol that it needs. Source: GDB
//! manual, appendix E (Remote Serial Protocol): `$text#checksum`, each acknowledged with `+`.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::{panic, thread};

use anyhow::anyhow;
use cycles::Image;
use firmware::protocol::ToHost;
use nix::sys::stat::Mode;
use nix::unistd::mkfifo;

use super::machine::{Clock, Machine, MachineSettings};
use crate::up_to_frame;

const WFI: u16 = 0xBF30;
const SIZE: u32 = 2;
/// A board that sleeps this many times without a frame is silent.
const PATIENCE: u32 = 1000;
const PIECE: u32 = 512;
/// The request for the description of the registers. QEMU gives no access to registers before it.
pub(super) const DESCRIBE: &str = "qXfer:features:read:target.xml:0,10";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    Sp = 13,
    Lr = 14,
    Pc = 15,
}

#[derive(Debug, Default)]
pub(super) struct Places {
    sleeps: Vec<u32>,
    breakpoints: Vec<u32>,
    here: Option<u32>,
}

impl Machine {
    pub fn halted(settings: &MachineSettings) -> anyhow::Result<Self> {
        let mut machine = Self::boot(&MachineSettings {
            clock: Clock::Counted,
            ..*settings
        })?;
        let words = Image::read(settings.elf)?.words().into_iter();
        machine.places.sleeps = words
            .filter(|(_, first, _)| *first == WFI)
            .map(|(address, ..)| address)
            .collect();
        Ok(machine)
    }

    /// A board that is late does not sleep, and runs on until it has caught up.
    pub fn run_to_frame(&mut self) -> anyhow::Result<Vec<ToHost>> {
        let sleeps = self.places.sleeps.clone();
        up_to_frame(PATIENCE, || {
            self.run_until(&sleeps)?;
            self.messages()
        })
    }

    /// Runs to the next frame while `read` reads QEMU's log, which ends before the instruction at
    /// `end`, or with the frame. `read` must read to the end, because QEMU waits while nobody does.
    pub fn next_frame_logged<T: Send>(
        &mut self,
        end: u32,
        read: impl FnOnce(File) -> anyhow::Result<T> + Send,
    ) -> anyhow::Result<T> {
        let sleeps = self.places.sleeps.clone();
        let places = [&sleeps[..], &[end]].concat();
        let frame = |machine: &mut Self, log: &Path| {
            machine.start_log(log)?;
            let messages = up_to_frame(PATIENCE, || {
                machine.run_until(&places)?;
                if machine.places.here == Some(end) {
                    machine.end_log()?;
                    machine.run_until(&sleeps)?;
                }
                machine.messages()
            });
            messages.map(drop)
        };
        self.logged(frame, read)
    }

    /// Runs to the next call of this function, and returns the address where its caller continues.
    pub fn next_return_address(&mut self, function: u32) -> anyhow::Result<u32> {
        self.run_to(function)?;
        Ok(self.get(Register::Lr)? & !1)
    }

    pub fn next_call_logged<T: Send>(
        &mut self,
        function: u32,
        read: impl FnOnce(File) -> anyhow::Result<T> + Send,
    ) -> anyhow::Result<T> {
        let return_address = self.next_return_address(function)?;
        let call = |machine: &mut Self, log: &Path| {
            machine.start_log(log)?;
            machine.run_to(return_address)?;
            machine.places.here = None;
            machine.expect("s", "T05")
        };
        self.logged(call, read)
    }

    fn logged<T: Send>(
        &mut self,
        run: impl FnOnce(&mut Self, &Path) -> anyhow::Result<()>,
        read: impl FnOnce(File) -> anyhow::Result<T> + Send,
    ) -> anyhow::Result<T> {
        let folder = tempfile::tempdir_in(self.folder.path())?;
        let path = folder.path().join("log");
        mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR)?;

        // The pipe is opened for both directions first, so that neither of the two opens waits for
        // QEMU.
        let both = File::options().read(true).write(true).open(&path)?;
        let pipe = File::open(&path)?;
        let writer = File::options().write(true).open(&path)?;
        drop(both);

        thread::scope(|scope| {
            let reader = scope.spawn(|| read(pipe));
            let ran = run(self, &path);
            // The log is closed even if the run fails, so that the reader ends.
            let ended = self.end_log();
            drop(writer);
            let read = reader
                .join()
                .unwrap_or_else(|panic| panic::resume_unwind(panic));
            ran.and(ended).and(read)
        })
    }

    fn start_log(&mut self, file: &Path) -> anyhow::Result<()> {
        self.log(file, "cpu,nochain", "on")
    }

    fn end_log(&mut self) -> anyhow::Result<()> {
        self.log(Path::new("/dev/null"), "none", "off")
    }

    fn log(&mut self, file: &Path, what: &str, single_step: &str) -> anyhow::Result<()> {
        self.console(&format!("logfile {}", file.display()))?;
        self.console(&format!("log {what}"))?;
        self.single_step(single_step)
    }

    pub fn run_to(&mut self, address: u32) -> anyhow::Result<()> {
        self.run_until(&[address])
    }

    /// Lets the machine run freely. This is twenty times as fast as from frame to frame, because
    /// QEMU discards its translated code whenever it is stopped at a breakpoint.
    pub fn run(&mut self) -> anyhow::Result<&mut Self> {
        self.leave(&[])?;
        self.say("c").map(|()| self)
    }

    pub fn stop(&mut self) -> anyhow::Result<()> {
        self.debugger.sender.write_all(b"\x03")?;
        let reply = self.hear()?;
        if reply.starts_with("T02") {
            Ok(())
        } else {
            Err(unexpected("an interrupt", &reply))
        }
    }

    pub fn divert(&mut self, registers: &[(Register, u32)]) -> anyhow::Result<()> {
        self.places.here = None;
        registers
            .iter()
            .try_for_each(|(register, value)| self.set(*register, *value))
    }

    pub fn write(&mut self, address: u32, bytes: &[u8]) -> anyhow::Result<()> {
        for (start, piece) in (address..)
            .step_by(PIECE as usize)
            .zip(bytes.chunks(PIECE as usize))
        {
            let digits: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
            self.expect(&format!("M{start:x},{:x}:{digits}", piece.len()), "OK")?;
        }
        Ok(())
    }

    fn run_until(&mut self, places: &[u32]) -> anyhow::Result<()> {
        self.leave(places)?;
        self.expect("c", "T05")?;

        self.places.here = Some(self.get(Register::Pc)?);
        Ok(())
    }

    /// Skips a `wfi` at which the machine is stopped. The architecture allows it to wake at any
    /// time. While the machine was stopped, QEMU has advanced its clock to the next event, which is
    /// exactly the effect of sleeping.
    fn leave(&mut self, places: &[u32]) -> anyhow::Result<()> {
        let set = std::mem::replace(&mut self.places.breakpoints, places.to_vec());
        for (change, these, others) in [('z', &set[..], places), ('Z', places, &set[..])] {
            for place in these.iter().filter(|place| !others.contains(place)) {
                self.expect(&format!("{change}0,{place:x},{SIZE}"), "OK")?;
            }
        }

        // An instruction with a breakpoint must be passed before the machine can continue.
        match self.places.here.take() {
            Some(here) if self.places.sleeps.contains(&here) => self.set(Register::Pc, here + SIZE),
            // A machine that was stopped in another way makes no single step: it may be asleep and
            // would not finish it.
            Some(here) if places.contains(&here) => self.expect("s", "T05"),
            _ => Ok(()),
        }
    }

    fn get(&mut self, register: Register) -> anyhow::Result<u32> {
        // GDB sends them in the target's byte order.
        let answer = self.ask(&format!("p{:x}", register as u32))?;
        let number = u32::from_str_radix(&answer, 16).map_err(|_| unexpected("p", &answer))?;
        Ok(number.swap_bytes())
    }

    fn set(&mut self, register: Register, value: u32) -> anyhow::Result<()> {
        self.expect(
            &format!("P{:x}={:08x}", register as u32, value.swap_bytes()),
            "OK",
        )
    }

    fn expect(&mut self, packet: &str, answer: &str) -> anyhow::Result<()> {
        let reply = self.ask(packet)?;
        if reply.starts_with(answer) {
            Ok(())
        } else {
            Err(unexpected(packet, &reply))
        }
    }

    pub(super) fn ask(&mut self, packet: &str) -> anyhow::Result<String> {
        self.say(packet)?;
        self.hear()
    }

    fn say(&mut self, packet: &str) -> anyhow::Result<()> {
        Ok(send_packet(&mut self.debugger.sender, packet)?)
    }

    fn hear(&mut self) -> anyhow::Result<String> {
        let reply = self.wait_until(|machine| take_reply(&mut machine.debugger.stream.bytes))?;
        self.debugger.sender.write_all(b"+")?;
        Ok(reply)
    }
}

/// Sends a packet, and does not wait for the acknowledgement.
pub fn send_packet(sender: &mut File, packet: &str) -> io::Result<()> {
    let checksum = packet.bytes().fold(0, u8::wrapping_add);
    write!(sender, "${packet}#{checksum:02x}")
}

/// Removes the first packet, and everything before it, and returns its text.
pub fn take_reply(bytes: &mut Vec<u8>) -> Option<String> {
    let start = 1 + bytes.iter().position(|byte| *byte == b'$')?;
    let length = bytes[start..].iter().position(|byte| *byte == b'#')?;
    let end = start + length;
    if bytes.len() < end + 3 {
        return None;
    }
    let reply = String::from_utf8_lossy(&bytes[start..end]).into_owned();
    bytes.drain(..end + 3);
    Some(reply)
}

fn unexpected(packet: &str, reply: &str) -> anyhow::Error {
    anyhow!("QEMU refuses the debugger: {packet} was answered with {reply:?}")
}

#[test]
fn the_first_complete_reply_is_taken() {
    for incomplete in ["", "+", "#00", "+$OK", "+$OK#", "+$OK#9"] {
        let mut bytes = incomplete.as_bytes().to_vec();
        assert_eq!(take_reply(&mut bytes), None, "{incomplete}");
        assert_eq!(bytes, incomplete.as_bytes());
    }
    let mut bytes = b"+#00$OK#9a$T05#b9".to_vec();
    assert_eq!(take_reply(&mut bytes).as_deref(), Some("OK"));
    assert_eq!(take_reply(&mut bytes).as_deref(), Some("T05"));
    assert_eq!(take_reply(&mut bytes), None);
}
