//! What a Cortex-M executes and what it costs: instructions (exact) out of QEMU's log, and cycles (an **estimate** from the
//! published instruction timings) through a model of the pipeline.
//!
//! Apart from the commands, because it is optimised in every profile: millions of instructions are read.

#![forbid(unsafe_code)]
#![allow(
    missing_docs,
    reason = "nobody builds on this package: what name and type say is not said again"
)]

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

/// The processors whose timings are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    /// Cortex-M3, no floating-point unit.
    M3,
    /// Cortex-M4 with the single-precision floating-point unit.
    M4F,
    /// Cortex-M0+ with the multiplier of 1 cycle, no floating-point unit. QEMU knows it as the Cortex-M0, whose instructions are the
    /// same.
    M0Plus,
}

impl Core {
    /// As on its manual.
    pub fn name(self) -> &'static str {
        match self {
            Self::M3 => "Cortex-M3",
            Self::M4F => "Cortex-M4F",
            Self::M0Plus => "Cortex-M0+",
        }
    }
}
