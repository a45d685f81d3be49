//! The registers before every instruction, out of QEMU's log (`-d cpu`).

use std::io::{BufRead, BufReader, Read};

use anyhow::{Context, Result};

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
        Self { general: [(); 16].map(|()| words.next().map_or(0, hexadecimal)) }
    }
}

/// Bytes of `R01=00000002` and what follows it: of an instruction there are four lines of four such words.
const WORD: usize = 13;

/// The eight digits of a word, all at once, for millions are read.
fn hexadecimal(word: &[u8]) -> u32 {
    let digits = word[4..].first_chunk().map_or(0, |digits| u64::from_be_bytes(*digits));
    // Letters are 9 more than their last four bits; then neighbours are put together.
    let is_letter = digits >> 6 & 0x0101_0101_0101_0101;
    let nibbles = (digits & 0x0f0f_0f0f_0f0f_0f0f) + 9 * is_letter;
    let bytes = (nibbles | nibbles >> 4) & 0x00ff_00ff_00ff_00ff;
    let halves = (bytes | bytes >> 8) & 0x0000_ffff_0000_ffff;
    (halves | halves >> 16) as u32
}

/// Calls `each` with the registers before every instruction of a log, until it refuses. One whose lines are cut short is the
/// last.
pub fn for_each_instruction(log: &mut dyn Read, each: &mut dyn FnMut(Registers) -> Result<()>) -> Result<()> {
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
