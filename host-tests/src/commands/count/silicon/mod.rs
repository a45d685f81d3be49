//! The rules of the core, each by a small loop of our own: through the decoder and the pipeline as all else goes.
//!
//! Published counts of chips: 200 loads and 200 sums (STM32F429), an STM32F103 and an STM32F407 measured by
//! jnk0le/random ("pipeline cycle test"), divisions of all lengths on a Cortex-M4 (compendium.i-0.nl, "Division timing"),
//! and the examples of the Cortex-M3's manual (DDI 0337, "Load/store timings"). No counts were found for vmul, vsqrt, vfma,
//! vldm, and for vldr and vstr in a row: where a test here has one of those, the manual alone stands behind it.

mod float;
mod integer;

use super::instruction::Instruction;
use super::pipeline::{Cost, Pipeline};
use super::trace::Registers;
use crate::emulator::boards::Core;

/// An instruction's halfwords as one number; a 16-bit one has the lower half 0.
type Word = u32;

/// A sum of integers that has to do with nothing else.
const ADDS_R4_R5_R6: Word = 0x19ac_0000;

fn decoded(word: Word) -> Instruction {
    let instruction = Instruction::decode((word >> 16) as u16, word as u16);
    instruction.unwrap_or_else(|| panic!("no row for {word:#010x}"))
}

/// The cost of straight code, `times` over, with these contents of r0 to r2 all along.
fn run(core: Core, times: usize, code: &[Word], [r0, r1, r2]: [u32; 3]) -> Cost {
    let mut registers = Registers::default();
    registers.general[..3].copy_from_slice(&[r0, r1, r2]);
    let mut pipeline = Pipeline::new(core);
    let mut total = Cost::default();
    for word in code.repeat(times) {
        total += pipeline.execute(decoded(word), &registers, false);
    }
    total
}

fn cycles(core: Core, times: usize, code: &[Word]) -> u64 {
    run(core, times, code, [0; 3]).cycles
}
