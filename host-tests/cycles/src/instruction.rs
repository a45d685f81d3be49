//! A decoded instruction, as needed for its timing.

use std::sync::LazyLock;

use crate::Core;
use crate::row::{Class, Field, Float, Row};
use crate::stream::Registers;
use crate::timing::TIMINGS;

pub fn is_long(first: u16) -> bool {
    first >= 0xe800
}

/// The rows by their first byte, for speed: millions of instructions are looked up.
static ROWS: LazyLock<Vec<Vec<&Row>>> = LazyLock::new(|| {
    let begin = |byte: u32| {
        TIMINGS
            .iter()
            .filter(move |row| (byte << 24 ^ row.value) & row.mask >> 24 << 24 == 0)
    };
    (0..=0xff).map(|byte| begin(byte).collect()).collect()
});

#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    /// The first halfword in the upper half, the second one or 0 in the lower half.
    word: u32,
    pub row: &'static Row,
}

impl Instruction {
    pub fn decode(first: u16, second: u16) -> Option<Self> {
        let word = u32::from(first) << 16 | if is_long(first) { u32::from(second) } else { 0 };
        let row = ROWS[(word >> 24) as usize]
            .iter()
            .find(|row| word & row.mask == row.value)?;
        Some(Self { word, row })
    }

    pub fn size(&self) -> u32 {
        if is_long((self.word >> 16) as u16) {
            4
        } else {
            2
        }
    }

    /// Returns the cycles of the instruction alone, without the effects of its neighbours
    /// ([`Pipeline`](crate::Pipeline)).
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

    /// Returns true for loads that can delay the next one. ldrex and table branches cannot.
    pub fn loads(&self) -> bool {
        match self.row.class {
            Class::Load | Class::LoadPair | Class::LoadList => true,
            Class::FloatList => self.word & 1 << 20 != 0,
            _ => false,
        }
    }

    pub fn is_float(&self) -> bool {
        self.word >> 26 == 0b11_1011
    }

    /// Returns true if the core lacks the instruction. Rows that several instructions share count
    /// as one.
    pub fn is_missing_on(&self, core: Core) -> bool {
        self.row.cycles(core) == 0 && (self.row.class != Class::Divide || core == Core::M0Plus)
    }

    pub fn is_addressed_by(&self, before: &Self) -> bool {
        let registers =
            |fields: &'static [Field], word| fields.iter().map(move |field| field.register(word));

        // In a comparison, the field for the written register contains the program counter.
        let written = |register| {
            register != 15 && registers(before.row.writes, before.word).any(|it| it == register)
        };
        registers(self.row.address, self.word).any(written)
    }

    /// Returns the register of arithmetic, a quotient or a root, which is late.
    pub fn late_result(&self) -> Option<u32> {
        matches!(self.row.class, Class::Arithmetic(_) | Class::Aside(_))
            .then(|| Float::D.register(self.word))
    }

    /// An addend is needed later.
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

    /// push and pop have one register more than stm and ldm.
    fn register_list(&self) -> u32 {
        match self.word >> 28 {
            0xb => 0x01ff_0000,
            0xc => 0x00ff_0000,
            _ => 0xffff,
        }
    }

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
