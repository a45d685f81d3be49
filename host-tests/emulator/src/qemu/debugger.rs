//! A board under a debugger. The machine can be stopped after each frame, when its panel shows
//! exactly the frame just received, or at any place in its program.
//!
//! The machine is stopped through QEMU's debugger port when the firmware has done its work and goes
//! to sleep. A frame is then on the panel and sent, and the next one has not started. The firmware
//! is not involved. Its clock counts instructions, so the duration of a stop affects no result.
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

use super::machine::{Clock, Machine, Settings};
use crate::up_to_frame;

/// The instruction `wfi`, which sleeps until an interrupt, and its size in bytes. The size is also
/// sent with every breakpoint.
const WFI: u16 = 0xBF30;
const SIZE: u32 = 2;
/// The number of sleeps without a frame after which the board counts as silent.
const PATIENCE: u32 = 1000;
/// The number of bytes that are written to memory by one packet.
const PIECE: u32 = 512;
/// The request for the description of the registers. QEMU gives no access to registers before it.
pub(super) const DESCRIBE: &str = "qXfer:features:read:target.xml:0,10";

/// A register of the processor, with its number in GDB's protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    /// The stack pointer in use.
    Sp = 13,
    /// The link register, which has the return address.
    Lr = 14,
    /// The program counter.
    Pc = 15,
}

/// The possible stops of a machine in its program.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// The address of every `wfi`.
    sleeps: Vec<u32>,
    /// The addresses of the breakpoints that are set in QEMU.
    breakpoints: Vec<u32>,
    /// The breakpoint of the current stop.
    here: Option<u32>,
}

impl Machine {
    /// Starts a board that is stopped at its first instruction. Its clock counts instructions, even
    /// if `settings` have another clock; the other settings apply. An error means that the ELF file
    /// is unusable, that QEMU cannot be started, that it ends at once, as for the Pico, or that
    /// there is no place for temporary files ([`Scratch::new`](crate::scratch::Scratch::new)). A
    /// program without symbols is no error, but [`Self::run_to_frame`] then runs to the time limit.
    pub fn halted(settings: &Settings) -> anyhow::Result<Self> {
        let mut machine = Self::boot(&Settings {
            clock: Clock::Counted,
            ..*settings
        })?;
        // The program sleeps only at a `wfi`.
        let words = Image::read(settings.elf)?.words().into_iter();
        machine.places.sleeps = words
            .filter(|(_, first, _)| *first == WFI)
            .map(|(address, ..)| address)
            .collect();
        Ok(machine)
    }

    /// Runs to the first sleep of the board after which a frame has arrived, and returns all
    /// messages that have not been fetched, oldest first. The machine must be stopped, which is not
    /// checked, and is stopped again when the frame is on the panel. A waiting frame that has not
    /// been fetched counts; the board then runs to its next sleep.
    ///
    /// It is an error if the board sleeps 1000 times without a frame, as it does if the machine
    /// does not listen, or if QEMU ends; the messages are then lost. After 1000 sleeps the machine
    /// is stopped at a sleep. Not checked: that the machine is from [`Self::halted`]; another one
    /// runs to its time limit.
    pub fn run_to_frame(&mut self) -> anyhow::Result<Vec<ToHost>> {
        let sleeps = self.places.sleeps.clone();
        up_to_frame(PATIENCE, || {
            self.run_until(&sleeps)?;
            self.messages()
        })
    }

    /// Runs to the next frame while `read` reads QEMU's log. The log contains the processor's
    /// registers before every instruction, hundreds of bytes each time. It ends before the
    /// instruction at `end`, an address without the Thumb bit, or with the frame if the program
    /// does not come there. A stop at `end` uses up the rest of the tick: the board executes
    /// nothing more until the next one.
    ///
    /// Returns the result of `read`, which runs in a thread of its own and must read to the end of
    /// the log, because QEMU waits while nobody does. Errors are as in [`Self::run_to_frame`], and,
    /// if there is none, that of `read`; its panic is passed on. The messages up to the frame are
    /// dropped. The machine must be from [`Self::halted`] and stopped, and is stopped after the
    /// frame.
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

    /// Runs to the next call of the function at this address, without the Thumb bit, and returns
    /// the address where its caller continues. The run is as in [`Self::run_to`].
    pub fn next_return_address(&mut self, function: u32) -> anyhow::Result<u32> {
        self.run_to(function)?;
        Ok(self.get(Register::Lr)? & !1)
    }

    /// Runs to the next call of the function at this address, without the Thumb bit, and to its
    /// return, while `read` reads QEMU's log of the call. The log ends with the instruction after
    /// the return, which the machine has then executed. The function must not call itself; if it
    /// does, the log may end at an inner return. `read` and its errors are as in
    /// [`Self::next_frame_logged`]; the run is as in [`Self::run_to`].
    pub fn next_call_logged<T: Send>(
        &mut self,
        function: u32,
        read: impl FnOnce(File) -> anyhow::Result<T> + Send,
    ) -> anyhow::Result<T> {
        let return_address = self.next_return_address(function)?;
        let call = |machine: &mut Self, log: &Path| {
            machine.start_log(log)?;
            machine.run_to(return_address)?;
            // The instruction there is logged when it is executed.
            machine.places.here = None;
            machine.expect("s", "T05")
        };
        self.logged(call, read)
    }

    /// Runs the machine as `run` does while `read` reads QEMU's log. `run` is called with the path
    /// of the log and starts it. It may end it.
    fn logged<T: Send>(
        &mut self,
        run: impl FnOnce(&mut Self, &Path) -> anyhow::Result<()>,
        read: impl FnOnce(File) -> anyhow::Result<T> + Send,
    ) -> anyhow::Result<T> {
        let folder = tempfile::tempdir_in(self.folder.path())?;
        let path = folder.path().join("log");
        mkfifo(&path, Mode::S_IRUSR | Mode::S_IWUSR)?;

        // The pipe is opened for both directions first, so that neither of the two opens waits for
        // QEMU. The log ends when QEMU and `writer` have closed it.
        let both = File::options().read(true).write(true).open(&path)?;
        let pipe = File::open(&path)?;
        let writer = File::options().write(true).open(&path)?;
        drop(both);

        // The log is read by a thread, because QEMU waits while its pipe is full.
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

    /// Lets QEMU write the registers before every instruction to this file.
    fn start_log(&mut self, file: &Path) -> anyhow::Result<()> {
        self.log(file, "cpu,nochain", "on")
    }

    /// Lets QEMU close its log.
    fn end_log(&mut self) -> anyhow::Result<()> {
        self.log(Path::new("/dev/null"), "none", "off")
    }

    /// Sets the file and the items of QEMU's log, and switches single steps on or off.
    fn log(&mut self, file: &Path, what: &str, single_step: &str) -> anyhow::Result<()> {
        self.console(&format!("logfile {}", file.display()))?;
        self.console(&format!("log {what}"))?;
        self.single_step(single_step)
    }

    /// Runs until the instruction at this address, without the Thumb bit, is about to be executed.
    /// The machine must be stopped, which is not checked. If a run to an address or to a frame has
    /// stopped it there, runs until the next time. If it is there in another way, by
    /// [`Self::divert`], [`Self::stop`] or its start, this returns at once. If the program never
    /// comes there, as to an odd address, this ends with an error at the time limit of the machine.
    pub fn run_to(&mut self, address: u32) -> anyhow::Result<()> {
        self.run_until(&[address])
    }

    /// Lets the machine run freely and returns at once. This is twenty times as fast as from frame
    /// to frame, because QEMU discards its translated code whenever it is stopped at a breakpoint.
    /// The machine must be stopped, which is not checked; [`Self::stop`] stops it again.
    pub fn run(&mut self) -> anyhow::Result<&mut Self> {
        self.leave(&[])?;
        self.say("c").map(|()| self)
    }

    /// Stops the running machine at any place. The machine must be running, by [`Self::run`] or
    /// [`Self::start`]; else this waits until QEMU's time limit, which is an error.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        self.debugger.sender.write_all(b"\x03")?;
        let reply = self.hear()?;
        if reply.starts_with("T02") {
            Ok(())
        } else {
            Err(unexpected("an interrupt", &reply))
        }
    }

    /// Sets some registers, which may include the program counter, before the machine continues.
    /// The machine must be stopped, which is not checked. The Thumb bit of an address in the
    /// program counter is ignored. An error leaves the registers before it in the list set.
    pub fn divert(&mut self, registers: &[(Register, u32)]) -> anyhow::Result<()> {
        self.places.here = None;
        registers
            .iter()
            .try_for_each(|(register, value)| self.set(*register, *value))
    }

    /// Writes bytes to memory from this address on, also to flash. The machine must be stopped,
    /// which is not checked. Bytes for addresses without memory, or for registers of the chip, are
    /// lost without an error. An error means that QEMU refuses a piece of 512 bytes, or has ended;
    /// the pieces before it are then written.
    pub fn write(&mut self, address: u32, bytes: &[u8]) -> anyhow::Result<()> {
        for (start, piece) in (address..)
            // A packet has a limited size.
            .step_by(PIECE as usize)
            .zip(bytes.chunks(PIECE as usize))
        {
            let digits: String = piece.iter().map(|byte| format!("{byte:02x}")).collect();
            self.expect(&format!("M{start:x},{:x}:{digits}", piece.len()), "OK")?;
        }
        Ok(())
    }

    /// Lets the machine run until one of these instructions is about to be executed.
    fn run_until(&mut self, places: &[u32]) -> anyhow::Result<()> {
        self.leave(places)?;
        self.expect("c", "T05")?;

        // The program counter identifies the place that was reached.
        self.places.here = Some(self.get(Register::Pc)?);
        Ok(())
    }

    /// Prepares the machine to continue, with breakpoints at `places`.
    ///
    /// If the machine is stopped at a `wfi`, the `wfi` is skipped. The architecture allows it to
    /// wake at any time. While the machine was stopped, QEMU has advanced its clock to the next
    /// event, which is exactly the effect of sleeping.
    fn leave(&mut self, places: &[u32]) -> anyhow::Result<()> {
        // Only breakpoints that change are removed and set.
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

    /// Returns the contents of a register.
    fn get(&mut self, register: Register) -> anyhow::Result<u32> {
        // GDB sends them in the target's byte order.
        let answer = self.ask(&format!("p{:x}", register as u32))?;
        let number = u32::from_str_radix(&answer, 16).map_err(|_| unexpected("p", &answer))?;
        Ok(number.swap_bytes())
    }

    /// Sets a register.
    fn set(&mut self, register: Register, value: u32) -> anyhow::Result<()> {
        self.expect(
            &format!("P{:x}={:08x}", register as u32, value.swap_bytes()),
            "OK",
        )
    }

    /// Sends a packet and checks that the reply begins with `answer`.
    fn expect(&mut self, packet: &str, answer: &str) -> anyhow::Result<()> {
        let reply = self.ask(packet)?;
        if reply.starts_with(answer) {
            Ok(())
        } else {
            Err(unexpected(packet, &reply))
        }
    }

    /// Sends a packet, waits for the reply and returns its text, which may be a refusal. An error
    /// means that QEMU has ended, or that the packet does not fit into the pipe.
    pub(super) fn ask(&mut self, packet: &str) -> anyhow::Result<String> {
        self.say(packet)?;
        self.hear()
    }

    /// Sends a packet.
    fn say(&mut self, packet: &str) -> anyhow::Result<()> {
        Ok(send_packet(&mut self.debugger.sender, packet)?)
    }

    /// Waits for a reply, acknowledges it and returns its text.
    fn hear(&mut self) -> anyhow::Result<String> {
        let reply = self.wait_until(|machine| take_reply(&mut machine.debugger.stream.bytes))?;
        self.debugger.sender.write_all(b"+")?;
        Ok(reply)
    }
}

/// Sends a packet of GDB's protocol with its checksum, and does not wait for the acknowledgement.
/// An error means that it does not fit into the pipe, or that nobody has the other end; a part may
/// then be sent. The text must not contain the characters `$`, `#` and `}`; this is not checked.
pub fn send_packet(sender: &mut File, packet: &str) -> io::Result<()> {
    let checksum = packet.bytes().fold(0, u8::wrapping_add);
    write!(sender, "${packet}#{checksum:02x}")
}

/// Removes the first packet of GDB's protocol, and everything before it, from the bytes that have
/// arrived. Returns the text of the packet, in which bytes that are not UTF-8 are replaced. If the
/// packet is not complete, returns `None` and removes nothing. Its checksum is not checked.
pub fn take_reply(bytes: &mut Vec<u8>) -> Option<String> {
    // A packet is complete if its checksum of two digits has arrived.
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

/// Returns the error of a reply that was not expected.
fn unexpected(packet: &str, reply: &str) -> anyhow::Error {
    anyhow!("QEMU refuses the debugger: {packet} was answered with {reply:?}")
}

/// A reply is taken when it is complete, with the bytes before it, even if one of them ends a
/// packet. The bytes after it remain.
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
