//! How deep a board's stack has reached: it is painted, and where the paint is gone the stack has been.

use std::ops::Range;
use std::path::Path;

use anyhow::Context;
use object::{Object, ObjectSymbol};

use super::Lockstep;

/// The stack's share of memory, from its top (`board/cortex_m/guard.rs`).
const SIZE: u32 = 32 * 1024;
/// No byte that is common in memory.
pub const PAINT: u8 = 0xA5;

#[derive(Clone, Debug)]
pub struct Stack(Range<u32>);

impl Stack {
    /// Of this program, by the linker's name for its top.
    pub fn of(elf: &Path) -> anyhow::Result<Self> {
        let program = std::fs::read(elf).with_context(|| elf.display().to_string())?;
        let program = object::File::parse(&*program)?;
        let top = program.symbols().find(|symbol| symbol.name() == Ok("_stack_start"));
        let top = top.context("the program has no stack")?.address() as u32;
        Ok(Self(top.saturating_sub(SIZE)..top))
    }

    pub fn addresses(&self) -> Range<u32> {
        self.0.clone()
    }

    /// The most bytes that it has held since it was painted, by what stands there now.
    pub fn depth(memory: &[u8]) -> u32 {
        SIZE - memory.iter().take_while(|byte| **byte == PAINT).count() as u32
    }

    /// To be done before the board's first instruction.
    pub fn paint(&self, board: &mut Lockstep) -> anyhow::Result<()> {
        board.fill(self.0.clone(), PAINT)
    }

    pub fn reached(&self, board: &mut Lockstep) -> anyhow::Result<u32> {
        Ok(Self::depth(&board.read(self.0.clone())?))
    }
}
