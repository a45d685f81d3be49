//! A row of the timing table.

use crate::Core;

/// The effect on the time of an instruction in addition to its cycles. A load or store is pipelined
/// with the load before it if its address does not depend on that load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    Fixed,
    /// A branch that refills the pipeline sooner than a branch to an address in a register.
    Branch,
    /// An `it`, which takes no time after a 16-bit instruction.
    IfThen,
    Divide,
    Load,
    /// A load after it takes 1 cycle more, if the store has a constant offset.
    Store,
    /// A load that is not pipelined. A store of two words is [`Self::Fixed`].
    LoadPair,
    /// 1 cycle more for each core register in the list.
    LoadList,
    StoreList,
    FloatList,
    /// The next instruction may have to wait for the result.
    Arithmetic(Reads),
    /// The unit is busy, and the core continues after 1 cycle.
    Aside(Reads),
    /// Consumes results; its own result is not late.
    Move(Reads),
}

/// The floating-point registers that an instruction reads early.
///
/// A multiply-accumulate reads its addend `d` a cycle later than its factors, so it never waits for
/// the addend.
pub type Reads = &'static [Float];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Float {
    D,
    N,
    Half,
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

/// The position of a core register. `Low0` to `Low8` are three bits of the first halfword, `Wide0`
/// to `Wide16` four bits of the word, from that bit on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Low0,
    Low3,
    Low6,
    Low8,
    /// Bits 0 to 2 of the first halfword, and bit 7 above them.
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

/// A row of the table: the instructions with `word & mask == value`, their cycles, and the core
/// registers that affect the cycles of other instructions.
///
/// `word` has the first halfword in its upper half, and the second halfword or 0 in its lower half.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub name: &'static str,
    pub(super) mask: u32,
    pub(super) value: u32,
    /// The cycles on the M3, the M4F and the M0+; 0 for a division, or if the core does not have
    /// the instruction.
    pub(super) cycles: [u64; 3],
    pub class: Class,
    /// Lists and pairs are left out.
    pub(super) writes: &'static [Field],
    /// The registers of the address of a load, a store or a table branch. 15 does not count.
    pub(super) address: &'static [Field],
}

impl Row {
    pub fn cycles(&self, core: Core) -> u64 {
        self.cycles[core as usize]
    }

    /// Returns true if it writes a new address to its address register (pre- and post-indexed).
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
