//! One instruction as far as its timing goes.

use super::timing::{Class, Reads, Row, TIMINGS};
use crate::emulator::boards::Core;

/// A decoded instruction.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    word: u32,
    /// Its row of the timing table.
    pub row: &'static Row,
}

impl Instruction {
    /// The instruction of these halfwords, the second of which is ignored if the first is an instruction by itself;
    /// `None` if the table has no row for it.
    pub fn decode(first: u16, second: u16) -> Option<Self> {
        let wide = first >= 0xe800;
        let word = u32::from(first) << 16 | if wide { u32::from(second) } else { 0 };
        let row = TIMINGS.iter().find(|row| word & row.mask == row.value)?;
        Some(Self { word, row })
    }

    /// Its length in bytes.
    pub fn size(&self) -> u32 {
        if self.word >> 16 >= 0xe800 { 4 } else { 2 }
    }

    /// The cycles it takes by itself, if it does not branch.
    pub fn cycles(&self, core: Core) -> u64 {
        let more = match self.row.form {
            Class::List => (self.word & self.register_list()).count_ones(),
            Class::FloatList => self.word & 0xff,
            _ => 0,
        };
        self.row.cycles(core) + u64::from(more)
    }

    /// Whether it is a single load or store.
    pub fn is_single_access(&self) -> bool {
        self.row.form == Class::Single
    }

    /// The floating-point register whose value comes late, if it has one.
    pub fn late_result(&self) -> Option<u32> {
        matches!(self.row.form, Class::Arithmetic(_)).then(|| self.d())
    }

    /// Whether it needs the floating-point register `s` at its start.
    pub fn consumes(&self, s: u32) -> bool {
        match self.row.form {
            Class::Arithmetic(reads) | Class::Move(reads) => match reads {
                Reads::Nothing => false,
                Reads::D => self.d() == s,
                Reads::N => self.n() == s,
                Reads::M => self.m() == s,
                Reads::DM => self.d() == s || self.m() == s,
                Reads::NM => self.n() == s || self.m() == s,
            },
            Class::Single | Class::FloatList | Class::Fixed => self.stores(s),
            Class::List => false,
        }
    }

    /// The bits that stand for one register each. push and pop have one more than ldm and stm: lr or pc.
    fn register_list(&self) -> u32 {
        match self.word >> 28 {
            0xb => 0x01ff_0000,
            0xc => 0x00ff_0000,
            _ => 0xffff,
        }
    }

    /// Whether it stores `s`: vstr, vstm and vpush.
    fn stores(&self, s: u32) -> bool {
        let is_float_store = self.word & 0xfe10_0e00 == 0xec00_0a00;
        let double = self.word & 0x100 != 0;
        let first = if double { 2 * (self.d() >> 1 | (self.d() & 1) << 4) } else { self.d() };
        let words = match self.row.form {
            Class::FloatList => self.word & 0xff,
            _ if double => 2,
            _ => 1,
        };
        is_float_store && (first..first + words).contains(&s)
    }

    /// The destination field Vd:D.
    fn d(&self) -> u32 {
        (self.word >> 12 & 0xf) << 1 | self.word >> 22 & 1
    }

    /// The first operand Vn:N.
    fn n(&self) -> u32 {
        (self.word >> 16 & 0xf) << 1 | self.word >> 7 & 1
    }

    /// The second operand Vm:M.
    fn m(&self) -> u32 {
        (self.word & 0xf) << 1 | self.word >> 5 & 1
    }
}
