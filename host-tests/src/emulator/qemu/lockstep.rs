//! A board under a debugger, frame by frame: the machine stands still at a moment when its panel shows exactly the frame just
//! received, or at any place in its program.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, bail};
use cycles::Image;
use firmware::protocol::{Frame, ToHost};

use super::Screenshot;
use super::gdb::Debugger;
use super::machine::{Clock, Machine, Settings};

/// The instruction `wfi`: sleep until an interrupt.
const WFI: u16 = 0xBF30;
/// A board that sleeps this often without sending a frame sends none.
const PATIENCE: u32 = 1000;
/// One instruction per translation block: QEMU's name for it since 8.1, and before.
const SINGLE_STEP: [&str; 2] = ["one-insn-per-tb", "singlestep"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Register {
    Sp = 13,
    Lr = 14,
    Pc = 15,
}

/// A machine that is let run from one frame to the next, or from one place in its program to the next; its memory is open.
///
/// It is stopped from outside, through QEMU's debugger port, when the firmware has done its work and goes to sleep:
/// a frame is then on the panel and sent, and the next not begun. The firmware need not know, and its clock is the
/// counted one, so nothing it computes depends on how long it stood still.
#[derive(Debug)]
pub struct Lockstep {
    machine: Machine,
    debugger: Debugger,
}

impl Lockstep {
    /// Starts a board with its clock counted, even if `settings` say otherwise; it stands still at its first instruction.
    pub fn start(settings: &Settings) -> anyhow::Result<Self> {
        let words = Image::read(settings.elf)?.words().into_iter();
        let sleeps = words.filter(|(_, first, _)| *first == WFI).map(|(address, ..)| address).collect();
        let (machine, debugger) = Machine::start_stopped(&Settings { clock: Clock::Counted, ..*settings })?;
        Ok(Self { machine, debugger: Debugger::new(debugger, sleeps)? })
    }

    pub fn next_frame(&mut self) -> anyhow::Result<Frame> {
        let messages = self.run_to_frame()?;
        messages.into_iter().rev().find_map(ToHost::frame).context("the board sends no frames")
    }

    /// Runs to the next frame: all messages up to it.
    pub fn run_to_frame(&mut self) -> anyhow::Result<Vec<ToHost>> {
        let mut messages = Vec::new();
        for _ in 0..PATIENCE {
            self.debug(Debugger::run_to_sleep)?;
            let before = messages.len();
            messages.extend(self.machine.serial.all_arrived());
            if messages[before..].iter().any(|message| message.frame().is_some()) {
                return Ok(messages);
            }
        }
        bail!("the board sends no frames")
    }

    /// Runs to the next frame while QEMU writes the processor's registers before every instruction to `log`, which may
    /// be a named pipe: hundreds of bytes each time.
    pub fn next_frame_logged(&mut self, log: &Path) -> anyhow::Result<Frame> {
        self.machine.tell(&format!("logfile {}", log.display()))?;
        self.machine.tell("log cpu,nochain")?;
        self.single_step("on")?;
        let frame = self.next_frame();
        self.single_step("off")?;
        self.machine.tell("log none")?;
        self.machine.tell("logfile /dev/null")?;
        frame
    }

    fn single_step(&mut self, switch: &str) -> anyhow::Result<()> {
        let [name, name_before] = SINGLE_STEP.map(|name| format!("{name} {switch}"));
        self.machine.tell(&name).or_else(|_| self.machine.tell(&name_before))
    }

    /// Runs until the instruction at this address is about to be executed.
    pub fn run_to(&mut self, address: u32) -> anyhow::Result<()> {
        self.debug(|debugger| debugger.run_to(address))
    }

    /// Makes the processor go on elsewhere: the values of some registers. To be followed by [`run`](Self::run).
    pub fn divert(&mut self, registers: &[(Register, u32)]) -> anyhow::Result<()> {
        self.debug(|debugger| registers.iter().try_for_each(|(register, value)| debugger.set(*register as u32, *value)))
    }

    /// Lets it run freely, twenty times as fast as from frame to frame: QEMU forgets all that it has translated when it is stopped at
    /// a place.
    pub fn run(&mut self) -> anyhow::Result<&mut Machine> {
        self.debug(Debugger::run)?;
        Ok(&mut self.machine)
    }

    /// Stops it wherever it is.
    pub fn stop(&mut self) -> anyhow::Result<()> {
        self.debug(Debugger::stop)
    }

    pub fn write(&mut self, address: u32, bytes: &[u8]) -> anyhow::Result<()> {
        self.debug(|debugger| debugger.write(address, bytes))
    }

    pub fn read(&mut self, addresses: Range<u32>) -> anyhow::Result<Vec<u8>> {
        self.debug(|debugger| debugger.read(addresses))
    }

    fn debug<T>(&mut self, act: impl FnOnce(&mut Debugger) -> anyhow::Result<T>) -> anyhow::Result<T> {
        act(&mut self.debugger).map_err(|error| self.machine.explain(error))
    }

    pub fn screenshot(&mut self) -> anyhow::Result<Screenshot> {
        self.machine.screenshot()
    }

    pub fn machine(&mut self) -> &mut Machine {
        &mut self.machine
    }
}
