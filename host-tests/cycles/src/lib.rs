//! Counts the instructions that a Cortex-M executes and estimates their cycles.
//!
//! The instructions are exact: they are read from QEMU's log. The cycles are an **estimate**: a
//! model of the pipeline computes them from the published instruction timings.
//!
//! This is a package of its own because it is optimised in every profile: it reads millions of
//! instructions.

#![forbid(unsafe_code)]

mod image;
mod instruction;
mod pipeline;
mod row;
#[cfg(test)]
mod silicon;
mod stream;
mod timing;

pub use image::{Function, Image};
pub use instruction::Instruction;
pub use pipeline::{Cost, ERROR_BAR, Pipeline};
pub use stream::{Calls, Registers, Stream, for_each_instruction};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    M3,
    M4F,
    /// With the 1-cycle multiplier. In QEMU it is the Cortex-M0, which has the same instructions.
    M0Plus,
}

impl Core {
    pub fn name(self) -> &'static str {
        match self {
            Self::M3 => "Cortex-M3",
            Self::M4F => "Cortex-M4F",
            Self::M0Plus => "Cortex-M0+",
        }
    }
}
