//! A decoded instruction, as needed for its timing.

use std::sync::LazyLock;

use crate::Core;
use crate::row::{Class, Field, Float, Row};
use crate::stream::Registers;
use crate::timing::TIMINGS;

/// Returns true if this halfword begins an instruction of 32 bits.
pub fn is_long(first: u16) -> bool {
    first >= 0xe800
}

/// The rows that can match an instruction, by its first byte. This index is needed for speed:
/// millions of instructions are looked up.
static ROWS: LazyLock<Vec<Vec<&Row>>> = LazyLock::new(|| {
    let begin = |byte: u32| {
        TIMINGS
            .iter()
            .filter(move |row| (byte << 24 ^ row.value) & row.mask >> 24 << 24 == 0)
    };
    (0..=0xff).map(|byte| begin(byte).collect()).collect()
});

/// An instruction with its row of the timing table.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    /// The first halfword in the upper half, the second one or 0 in the lower half.
    word: u32,
    /// The row with its name and timing.
    pub row: &'static Row,
}

impl Instruction {
    /// Returns the instruction of these halfwords, or `None` if the table has no row for it. The
    /// second halfword is ignored if the first is a 16-bit instruction. A core need not have the
    /// instruction ([`is_missing_on`](Self::is_missing_on)).
    pub fn decode(first: u16, second: u16) -> Option<Self> {
        let word = u32::from(first) << 16 | if is_long(first) { u32::from(second) } else { 0 };
        let row = ROWS[(word >> 24) as usize]
            .iter()
            .find(|row| word & row.mask == row.value)?;
        Some(Self { word, row })
    }

    /// Returns its size in bytes: 2 or 4.
    pub fn size(&self) -> u32 {
        if is_long((self.word >> 16) as u16) {
            4
        } else {
            2
        }
    }

    /// Returns the cycles of the instruction alone, for these contents of the registers: with those
    /// for each register of a list, and without the refill after a branch. For a floating-point
    /// quotient or root they are the cycles of the unit, not of the core. The effects of the
    /// neighbouring instructions are not included ([`Pipeline`](crate::Pipeline)). The registers,
    /// before the instruction, affect a division only; a division by 0 takes 2 cycles. The result
    /// has no meaning if the core [lacks](Self::is_missing_on) the instruction.
    pub fn cycles(&self, core: Core, registers: &Registers) -> u64 {
        let more = match self.row.class {
            Class::LoadList | Class::StoreList => {
                (self.word & self.register_list()).count_ones().into()
            }
            Class::FloatList => (self.word & 0xff).into(),
            Class::Divide => self.division(registers),
            _ => 0,
        };
        self.row.cycles(core) + more
    }

    /// Returns true if it is a load of one word or less, a pair or a list, also of floating-point
    /// registers. It is false for ldrex and for table branches, although they read memory.
    pub fn loads(&self) -> bool {
        match self.row.class {
            Class::Load | Class::LoadPair | Class::LoadList => true,
            Class::FloatList => self.word & 1 << 20 != 0,
            _ => false,
        }
    }

    /// Returns true if it uses the floating-point unit, for a load, a store or a move, too.
    pub fn is_float(&self) -> bool {
        self.word >> 26 == 0b11_1011
    }

    /// Returns true if the core does not have this instruction. A division is missing on the M0+
    /// only. Some instructions that share a row with others are not recognised as missing, such as
    /// smmul and others for signal processing on the M3, and b.w on the M0+.
    pub fn is_missing_on(&self, core: Core) -> bool {
        self.row.cycles(core) == 0 && (self.row.class != Class::Divide || core == Core::M0Plus)
    }

    /// Returns true if its address, as a load, a store or a table branch, depends on a core
    /// register that the instruction `before` writes, on any core. The updated base of a single
    /// access counts.
    ///
    /// It is false for an instruction without an address. The program counter as a base does not
    /// count, but the index of a table branch does. It is also false after instructions whose
    /// written registers are not in the table: loads and stores of pairs and lists, ldrex, strex,
    /// vmrs and calls. After msr or nop.w, which write none, it may be true.
    pub fn is_addressed_by(&self, before: &Self) -> bool {
        let registers =
            |fields: &'static [Field], word| fields.iter().map(move |field| field.register(word));

        // In a comparison, the field for the written register contains the program counter.
        let written = |register| {
            register != 15 && registers(before.row.writes, before.word).any(|it| it == register)
        };
        registers(self.row.address, self.word).any(written)
    }

    /// Returns the number of the floating-point register with a late result, 0 to 31 for s0 to s31:
    /// the destination of arithmetic, a conversion, a quotient or a root. Returns `None` for other
    /// instructions, such as loads, moves and comparisons. A late result stalls an instruction that
    /// consumes it before it is ready: the next one or, after a quotient or a root, also a later
    /// one.
    pub fn late_result(&self) -> Option<u32> {
        matches!(self.row.class, Class::Arithmetic(_) | Class::Aside(_))
            .then(|| Float::D.register(self.word))
    }

    /// Returns true if the instruction needs the floating-point register `s`, 0 to 31, at its
    /// start. A store needs the registers that it stores. An addend is needed later and does not
    /// count, nor does the second register of a move of two to core registers.
    pub fn consumes(&self, s: u32) -> bool {
        match self.row.class {
            Class::Arithmetic(reads) | Class::Aside(reads) | Class::Move(reads) => {
                reads.iter().any(|field| field.register(self.word) == s)
            }
            _ => self.stores(s),
        }
    }

    /// Returns the cycles of a division.
    ///
    /// They depend on the lengths of the operands without their signs, as measured for all lengths
    /// on a Cortex-M4 (compendium.i-0.nl, "Division timing"). Both manuals say 2 to 12 cycles,
    /// "based on the number of leading ones and zeroes".
    fn division(&self, registers: &Registers) -> u64 {
        // The signed and the unsigned instruction differ in one bit.
        let is_signed = self.word & 1 << 21 == 0;
        let bits = |register: u32| {
            let value = registers.general[register as usize & 0xf];
            let size = if is_signed {
                value.cast_signed().unsigned_abs()
            } else {
                value
            };
            u32::BITS - size.leading_zeros()
        };

        // A quotient of 0 takes the fewest cycles; others cost a cycle per 4 bits of length.
        let dividend = bits(self.word >> 16);
        let divisor = bits(self.word);
        if dividend == 0 || divisor == 0 {
            2
        } else if dividend < divisor {
            3
        } else {
            5 + u64::from(dividend - divisor) / 4
        }
    }

    /// Returns the bits that each represent one register. push and pop have one more than stm and
    /// ldm: lr or pc.
    fn register_list(&self) -> u32 {
        match self.word >> 28 {
            0xb => 0x01ff_0000,
            0xc => 0x00ff_0000,
            _ => 0xffff,
        }
    }

    /// Returns true if the instruction is a vstr, vstm or vpush that stores `s`.
    fn stores(&self, s: u32) -> bool {
        let is_float_store = self.word & 0xfe10_0e00 == 0xec00_0a00;
        let double = self.word & 0x100 != 0;
        // A double register covers two single ones.
        let d = Float::D.register(self.word);
        let first = if double {
            2 * (d >> 1 | (d & 1) << 4)
        } else {
            d
        };
        let words = match self.row.class {
            Class::FloatList => self.word & 0xff,
            _ if double => 2,
            _ => 1,
        };
        is_float_store && (first..first + words).contains(&s)
    }
}
