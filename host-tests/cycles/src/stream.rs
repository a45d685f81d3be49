//! The stream of instructions that a core executes, and the calls of functions in it.
//!
//! QEMU's log (`-d cpu`) contains the registers before every instruction. A call lasts from the
//! first instruction of the function to its return. It includes all functions that it calls and all
//! interrupts.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, BufRead, BufReader, Read};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, Result, ensure};

use crate::Core;
use crate::image::Image;
use crate::instruction::Instruction;
use crate::pipeline::{Cost, Pipeline};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    pub general: [u32; 16],
}

impl Registers {
    pub fn sp(&self) -> u32 {
        self.general[13]
    }

    /// Returns the link register: before the first instruction of a function the return address.
    pub fn lr(&self) -> u32 {
        self.general[14]
    }

    pub fn pc(&self) -> u32 {
        self.general[15]
    }

    fn read(first: &[u8], rest: &[u8]) -> Self {
        let mut words = first.chunks_exact(WORD).chain(rest.chunks_exact(WORD));
        Self {
            general: [(); 16].map(|()| words.next().map_or(0, hexadecimal)),
        }
    }
}

const WORD: usize = 13;

/// The eight digits are computed together for speed, because millions of words are read.
fn hexadecimal(word: &[u8]) -> u32 {
    let digits = word[4..]
        .first_chunk()
        .map_or(0, |digits| u64::from_be_bytes(*digits));

    // The value of a letter is its last four bits plus 9. Then neighbouring digits are combined.
    let is_letter = digits >> 6 & 0x0101_0101_0101_0101;
    let nibbles = (digits & 0x0f0f_0f0f_0f0f_0f0f) + 9 * is_letter;
    let bytes = (nibbles | nibbles >> 4) & 0x00ff_00ff_00ff_00ff;
    let halves = (bytes | bytes >> 8) & 0x0000_ffff_0000_ffff;
    (halves | halves >> 16) as u32
}

/// The time between two reads of a log. In this time QEMU about fills a pipe of 64 KiB.
const PAUSE: Duration = Duration::from_micros(500);

/// A log that is read in large pieces.
///
/// QEMU writes each line on its own. A reader that waits for the next byte would be woken for each
/// line, which costs more time than the rest of its work.
struct Pieces<'a>(&'a mut dyn Read);

impl Read for Pieces<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        sleep(PAUSE);
        self.0.read(buffer)
    }
}

pub fn for_each_instruction(
    log: &mut dyn Read,
    each: &mut dyn FnMut(Registers) -> Result<()>,
) -> Result<()> {
    let mut log = BufReader::with_capacity(1 << 20, Pieces(log));
    let mut first = Vec::new();
    let mut rest = [0; 12 * WORD];
    while log.read_until(b'\n', &mut first).context("QEMU's log")? > 0 {
        if first.starts_with(b"R00=") && log.read_exact(&mut rest).is_ok() {
            each(Registers::read(&first, &rest))?;
        }
        first.clear();
    }
    Ok(())
}

#[derive(Debug)]
pub struct Calls<'a> {
    image: &'a Image,
    core: Core,
    entries: BTreeSet<u32>,
    /// The running call: the registers at its entry, its stream, and its cost.
    pub running: Option<(Registers, Stream<'a>, Cost)>,
    /// The costs of the calls, in the order of the returns.
    pub ended: Vec<Cost>,
    pub spots: BTreeMap<u32, (Instruction, Cost)>,
    pub stack_bytes: u32,
}

#[derive(Debug)]
pub struct Stream<'a> {
    image: &'a Image,
    core: Core,
    pipeline: Pipeline,
    before: Option<Registers>,
}

impl<'a> Stream<'a> {
    pub fn of(image: &'a Image, core: Core) -> Self {
        Self {
            image,
            core,
            pipeline: Pipeline::new(core),
            before: None,
        }
    }

    pub fn see(&mut self, next: Registers) -> Result<Option<(u32, Instruction, Cost)>> {
        let Some(before) = self.before.replace(next) else {
            return Ok(None);
        };
        // QEMU begins an instruction that accesses a device twice, and logs it twice.
        if before == next {
            return Ok(None);
        }
        let instruction = self.image.instruction_at(before.pc())?;
        ensure!(
            !instruction.is_missing_on(self.core),
            "{} at {:#x} is no instruction of a {}; choose another core",
            instruction.row.name,
            before.pc(),
            self.core.name()
        );
        let branches = next.pc() != before.pc() + instruction.size();
        Ok(Some((
            before.pc(),
            instruction,
            self.pipeline.execute(instruction, &before, branches),
        )))
    }
}

impl<'a> Calls<'a> {
    pub fn of(image: &'a Image, core: Core, entries: BTreeSet<u32>) -> Self {
        let ended = Vec::new();
        let spots = BTreeMap::new();
        Self {
            image,
            core,
            entries,
            running: None,
            ended,
            spots,
            stack_bytes: 0,
        }
    }

    /// A call ends at the caller's return address, if the stack pointer is as at the entry.
    pub fn see(&mut self, registers: Registers) -> Result<()> {
        if self.running.is_none() && self.entries.contains(&registers.pc()) {
            self.running = Some((
                registers,
                Stream::of(self.image, self.core),
                Cost::default(),
            ));
        }

        let Some((caller, stream, cost)) = &mut self.running else {
            return Ok(());
        };
        let Some((address, instruction, executed)) = stream.see(registers)? else {
            return Ok(());
        };
        self.spots
            .entry(address)
            .or_insert((instruction, Cost::default()))
            .1 += executed;
        self.stack_bytes = self
            .stack_bytes
            .max(caller.sp().saturating_sub(registers.sp()));
        *cost += executed;

        if registers.pc() == caller.lr() & !1 && registers.sp() == caller.sp() {
            self.ended.push(*cost);
            self.running = None;
        }
        Ok(())
    }

    pub fn cost(&self) -> Cost {
        let mut all = Cost::default();
        self.ended.iter().for_each(|call| all += *call);
        all
    }

    pub fn hot_bytes(&self) -> u32 {
        self.spots
            .values()
            .map(|(instruction, _)| instruction.size())
            .sum()
    }

    pub fn code_bytes(&self) -> u32 {
        let functions: BTreeSet<_> = self
            .spots
            .keys()
            .filter_map(|&address| self.image.function_at(address))
            .collect();
        functions.into_iter().map(|function| function.size).sum()
    }
}
