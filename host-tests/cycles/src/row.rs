//! A row of the timing table.

use crate::Core;

/// The effect on the time of an instruction in addition to the cycles of its [`Row`]. On the M0+
/// neighbours have no effect. A load or store is pipelined with the load before it if their cycles
/// overlap: if its address does not depend on that load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// It has no effect of its own. It may write an address register of the next instruction, or
    /// branch to an address in a register.
    Fixed,
    /// A branch to an address in the instruction. On the M3 and the M4F it refills the pipeline
    /// sooner than a branch to an address in a register.
    Branch,
    /// An `it` instruction, which takes no time after a 16-bit instruction.
    IfThen,
    /// A division of integers. Its time depends on the lengths of the operands.
    Divide,
    /// A single load. It takes 1 cycle less if it follows another one and is pipelined with it; on
    /// the M3 it is not if it updates its base register.
    Load,
    /// A single store. It takes 1 cycle less if it follows a single load, as a [`Self::Load`] does.
    /// A load of any kind after it takes 1 cycle more, unless the store has an offset in a
    /// register.
    Store,
    /// A load of two words, which is not pipelined. A store of two words is [`Self::Fixed`].
    LoadPair,
    /// Several loads, with 1 cycle more for each core register in the list.
    LoadList,
    /// Several stores, with 1 cycle more for each core register in the list.
    StoreList,
    /// A load or store of the floating-point registers in the list, with 1 cycle more for each
    /// word.
    FloatList,
    /// Floating-point arithmetic and conversions. The next instruction may have to wait for the
    /// result.
    Arithmetic(Reads),
    /// A floating-point quotient or root. The unit is busy for the whole time, and the core
    /// continues after 1 cycle.
    Aside(Reads),
    /// Other uses of floating-point registers. They consume results, and their own result is not
    /// late.
    Move(Reads),
}

/// The floating-point registers that an instruction reads early.
///
/// A multiply-accumulate reads its addend `d` a cycle later than its factors, so it never waits for
/// the addend.
pub type Reads = &'static [Float];

/// The position of a single-precision register in an encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Float {
    /// The destination. In a comparison it is the first operand, and in a conversion from or to
    /// fixed point also the operand.
    D,
    /// The first operand.
    N,
    /// The half of a double register that the first operand's field names, in a move between it and
    /// a core register.
    Half,
    /// The second operand, or the only one.
    M,
}

impl Float {
    /// Returns the number of the floating-point register, 0 to 31 for s0 to s31, in the word of an
    /// instruction ([`Row`]). For a double register, d0 to d15, it is the lower half, except by
    /// [`Self::Half`]. Not checked: that the instruction has this position.
    pub fn register(self, word: u32) -> u32 {
        match self {
            Self::D => (word >> 12 & 0xf) << 1 | word >> 22 & 1,
            Self::N => (word >> 16 & 0xf) << 1 | word >> 7 & 1,
            Self::Half => (word >> 16 & 0xf) << 1 | word >> 21 & 1,
            Self::M => (word & 0xf) << 1 | word >> 5 & 1,
        }
    }
}

/// The position of a core register in the word of an instruction ([`Row`]). `Low0` to `Low8` are
/// three bits of its first halfword, from that bit on. `Wide0` to `Wide16` are four bits of the
/// word, from that bit on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    Low0,
    Low3,
    Low6,
    Low8,
    /// A register of r0 to r15: bits 0 to 2 of the first halfword, and bit 7 above them.
    Any,
    /// The stack pointer, which has no bits in the encoding.
    Sp,
    Wide0,
    Wide8,
    Wide12,
    Wide16,
}

impl Field {
    /// Returns the number of the core register, 0 to 15, in the word of an instruction; 13 for
    /// `Sp`. Not checked: that the instruction has this position.
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
    /// The mnemonics.
    pub name: &'static str,
    /// The bits of the word that identify these instructions.
    pub(super) mask: u32,
    /// The values of those bits.
    pub(super) value: u32,
    /// The cycles on the M3, the M4F and the M0+; 0 if the core does not have the instruction, and
    /// for a division.
    pub(super) cycles: [u64; 3],
    /// The additional effect.
    pub class: Class,
    /// The core registers that it writes; none for loads and stores of pairs and lists, ldrex,
    /// strex, vmrs and calls. In a 32-bit comparison such a field has 15, which is not written.
    pub(super) writes: &'static [Field],
    /// The registers that form the address of a load, a store or a table branch. If the number in
    /// such a field is 15, the program counter, it does not count.
    pub(super) address: &'static [Field],
}

impl Row {
    /// Returns the cycles without the effects of the [`Class`], a refill or the previous
    /// instruction; for a floating-point quotient or root, those of the unit. They are 0 if the
    /// core does not have the instruction, and for a division.
    pub fn cycles(&self, core: Core) -> u64 {
        self.cycles[core as usize]
    }

    /// Returns true if the instruction writes a new address to the register of its address (pre-
    /// and post-indexed). It is false for a load that overwrites this register with the loaded
    /// word, and for loads and stores of pairs and lists, whose written registers are not in the
    /// table.
    pub fn updates_base(&self) -> bool {
        self.address.iter().any(|field| self.writes.contains(field))
    }
}

/// Returns a row with these fields.
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
