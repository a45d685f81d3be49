//! What a core executes, by the registers before every instruction out of QEMU's log (`-d cpu`); and the calls of a function in that
//! stream: from its first instruction to its return, with all that it calls and that interrupts it.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader, Read};

use anyhow::{Context, Result};

use crate::Core;
use crate::image::Image;
use crate::instruction::Instruction;
use crate::pipeline::{Cost, Pipeline};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Registers {
    /// r0 to r15.
    pub general: [u32; 16],
}

impl Registers {
    pub fn sp(&self) -> u32 {
        self.general[13]
    }

    pub fn lr(&self) -> u32 {
        self.general[14]
    }

    pub fn pc(&self) -> u32 {
        self.general[15]
    }

    /// Of an instruction's lines in the log.
    fn read(first: &[u8], rest: &[u8]) -> Self {
        let mut words = first.chunks_exact(WORD).chain(rest.chunks_exact(WORD));
        Self {
            general: [(); 16].map(|()| words.next().map_or(0, hexadecimal)),
        }
    }
}

/// Bytes of `R01=00000002` and what follows it: of an instruction there are four lines of four such words.
const WORD: usize = 13;

/// The eight digits of a word, all at once, for millions are read.
fn hexadecimal(word: &[u8]) -> u32 {
    let digits = word[4..]
        .first_chunk()
        .map_or(0, |digits| u64::from_be_bytes(*digits));
    // Letters are 9 more than their last four bits; then neighbours are put together.
    let is_letter = digits >> 6 & 0x0101_0101_0101_0101;
    let nibbles = (digits & 0x0f0f_0f0f_0f0f_0f0f) + 9 * is_letter;
    let bytes = (nibbles | nibbles >> 4) & 0x00ff_00ff_00ff_00ff;
    let halves = (bytes | bytes >> 8) & 0x0000_ffff_0000_ffff;
    (halves | halves >> 16) as u32
}

/// Calls `each` with the registers before every instruction of a log, until it refuses. One whose lines are cut short is the
/// last.
pub fn for_each_instruction(
    log: &mut dyn Read,
    each: &mut dyn FnMut(Registers) -> Result<()>,
) -> Result<()> {
    let mut log = BufReader::with_capacity(1 << 20, log);
    let (mut first, mut rest) = (Vec::new(), [0; 12 * WORD]);
    while log.read_until(b'\n', &mut first).context("QEMU's log")? > 0 {
        if first.starts_with(b"R00=") && log.read_exact(&mut rest).is_ok() {
            each(Registers::read(&first, &rest))?;
        }
        first.clear();
    }
    Ok(())
}

/// Every call of one of the functions that begin at some addresses.
#[derive(Debug)]
pub struct Calls<'a> {
    image: &'a Image,
    core: Core,
    entries: BTreeSet<u32>,
    /// Where the call that is running came from, the stream since then, and what it has cost.
    pub running: Option<(Registers, Stream<'a>, Cost)>,
    /// What each call that returned cost, in order.
    pub ended: Vec<Cost>,
    /// By its address, an instruction and what all its executions together cost.
    pub spots: BTreeMap<u32, (Instruction, Cost)>,
    /// The deepest the stack pointer went below where the caller had it.
    pub stack_bytes: u32,
}

/// What a core executes, one instruction after the other.
#[derive(Debug)]
pub struct Stream<'a> {
    image: &'a Image,
    pipeline: Pipeline,
    /// The registers before the instruction that is about to be executed.
    before: Option<Registers>,
}

impl<'a> Stream<'a> {
    pub fn of(image: &'a Image, core: Core) -> Self {
        Self {
            image,
            pipeline: Pipeline::new(core),
            before: None,
        }
    }

    /// Takes the registers before the next instruction; of the one before that, if there is one: its address, itself and its cost.
    pub fn see(&mut self, next: Registers) -> Result<Option<(u32, Instruction, Cost)>> {
        let Some(before) = self.before.replace(next) else {
            return Ok(None);
        };
        let instruction = self.image.instruction_at(before.pc())?;
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
        let (ended, spots) = (Vec::new(), BTreeMap::new());
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

    /// Of all calls that returned.
    pub fn cost(&self) -> Cost {
        let mut all = Cost::default();
        self.ended.iter().for_each(|call| all += *call);
        all
    }

    /// Bytes of the distinct instructions executed.
    pub fn hot_bytes(&self) -> u32 {
        self.spots
            .values()
            .map(|(instruction, _)| instruction.size())
            .sum()
    }

    /// Bytes of the functions entered.
    pub fn code_bytes(&self) -> u32 {
        let functions: BTreeSet<_> = self
            .spots
            .keys()
            .filter_map(|&address| self.image.function_at(address))
            .collect();
        functions.into_iter().map(|function| function.size).sum()
    }
}
