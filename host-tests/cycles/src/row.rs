//! What a row of the timing table says of its instructions.

use crate::Core;

/// What else decides the time of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Fixed,
    /// A branch to an address that it holds itself: refills the pipeline sooner than one to an address in a register.
    Branch,
    /// Nothing, or no time at all after a 16-bit instruction.
    IfThen,
    /// A division of integers: the lengths of its operands.
    Divide,
    /// A single load: 1 cycle less if it follows another one and is pipelined with it.
    Load,
    /// A single store: likewise. 1 cycle more for a load that follows, unless the address has an offset in a register.
    Store,
    /// A load of two words, which is not pipelined.
    LoadPair,
    /// Loads, 1 cycle more for each core register in the list.
    LoadList,
    /// Stores, 1 cycle more for each core register in the list.
    StoreList,
    /// A load or store of as many words as the floating-point register list has, 1 cycle for each.
    FloatList,
    /// Floating-point arithmetic and conversions: a result that the next instruction may have to wait for.
    Arithmetic(Reads),
    /// A floating-point quotient or root: the unit is busy for as long, the core goes on after 1 cycle.
    Aside(Reads),
    /// Other uses of floating-point registers: consume results, give none that is late.
    Move(Reads),
}

/// The floating-point registers that an instruction reads early.
///
/// A multiply-accumulate reads its addend `d` a cycle later than its factors, so it never waits for that one.
pub type Reads = &'static [Float];

/// Where an encoding names a floating-point register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Float {
    /// The destination.
    D,
    /// The first operand.
    N,
    /// The half of a double register that the first operand's field names.
    Half,
    /// The second operand, or the only one.
    M,
}

impl Float {
    pub fn register(self, word: u32) -> u32 {
        match self {
            Self::D => (word >> 12 & 0xf) << 1 | word >> 22 & 1,
            Self::N => (word >> 16 & 0xf) << 1 | word >> 7 & 1,
            Self::Half => (word >> 16 & 0xf) << 1 | word >> 21 & 1,
            Self::M => (word & 0xf) << 1 | word >> 5 & 1,
        }
    }
}

/// Where an encoding names a core register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Low0,
    Low3,
    Low6,
    Low8,
    Any,
    Sp,
    Wide0,
    Wide8,
    Wide12,
    Wide16,
}

impl Field {
    pub fn register(self, word: u32) -> u32 {
        match self {
            Self::Low0 => word >> 16 & 7,
            Self::Low3 => word >> 19 & 7,
            Self::Low6 => word >> 22 & 7,
            Self::Low8 => word >> 24 & 7,
            Self::Any => word >> 16 & 7 | word >> 20 & 8,
            Self::Sp => 13,
            Self::Wide0 => word & 0xf,
            Self::Wide8 => word >> 8 & 0xf,
            Self::Wide12 => word >> 12 & 0xf,
            Self::Wide16 => word >> 16 & 0xf,
        }
    }
}

/// One row: the instructions `word & mask == value`, their cycles and the core registers that matter for others' cycles.
///
/// `word` is the first halfword in the upper half and the second, if there is one, in the lower half.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub name: &'static str,
    pub(super) mask: u32,
    pub(super) value: u32,
    /// On the M3, the M4 and the M0+.
    pub(super) cycles: [u64; 3],
    pub class: Class,
    pub(super) writes: &'static [Field],
    /// What a load or store makes its address of.
    pub(super) address: &'static [Field],
}

impl Row {
    /// The cycles before anything that [`Class`], a refill or the instruction before adds.
    pub fn cycles(&self, core: Core) -> u64 {
        self.cycles[core as usize]
    }

    /// Whether it leaves a new address in the register that it made its own of: pre- and post-indexed.
    pub fn updates_base(&self) -> bool {
        self.address.iter().any(|field| self.writes.contains(field))
    }
}

pub(super) const fn row(
    name: &'static str,
    mask: u32,
    value: u32,
    cycles: [u64; 3],
    class: Class,
    writes: &'static [Field],
    address: &'static [Field],
) -> Row {
    Row {
        name,
        mask,
        value,
        cycles,
        class,
        writes,
        address,
    }
}
