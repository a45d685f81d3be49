//! Published instruction timings of the Cortex-M3 and Cortex-M4, as data.
//!
//! Sources: Cortex-M3 TRM (Arm DDI 0337) and Cortex-M4 TRM r0p1 (Arm DDI 0439), "Instruction set summary" (table 3-1),
//! and DDI 0439 "FPU instruction set" (table 7-1) with its notes. The encodings are those of the ARMv7-M Architecture
//! Reference Manual (Arm DDI 0403), chapters A5 and A6. Both manuals assume memory without wait states.
//!
//! Where the manuals give a range, the figure used is in the middle and named in the row: a pipeline refill takes 1 to 3
//! cycles, a division 2 to 12, a long multiplication on the M3 3 to 5, with accumulation 4 to 7. So all that is made
//! from this table is an estimate.

use crate::emulator::boards::Core;

/// Cycles to refill the pipeline after any instruction that the next one in memory does not follow (1 to 3).
pub const REFILL: u64 = 2;
/// Cycles that an instruction waits which consumes the floating-point result of the one just before it.
pub const RESULT_USE_STALL: u64 = 1;

/// What else decides the time of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Nothing.
    Fixed,
    /// A single load or store: 1 cycle less if it follows another one closely enough to be pipelined with it.
    Single,
    /// 1 cycle more for each core register in the list.
    List,
    /// 1 cycle more for each word of the floating-point register list.
    FloatList,
    /// Floating-point arithmetic and conversions: a result that the next instruction may have to wait for.
    Arithmetic(Reads),
    /// Other uses of floating-point registers: consume results, give none that is late.
    Move(Reads),
}

/// Which of the encoding's floating-point registers an instruction reads early.
///
/// A multiply-accumulate reads its addend `d` a cycle later than its factors, so it never waits for that one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reads {
    /// None: a load or an immediate.
    Nothing,
    /// The destination field.
    D,
    /// The first operand.
    N,
    /// The second operand, or the only one.
    M,
    /// The destination field and the second operand: a comparison.
    DM,
    /// Both operands.
    NM,
}

/// One row: the instructions `word & mask == value` and their cycles.
///
/// `word` is the first halfword in the upper half and the second, if there is one, in the lower half.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The manual's mnemonics.
    pub name: &'static str,
    pub(super) mask: u32,
    pub(super) value: u32,
    m3: u64,
    m4: u64,
    /// What else decides.
    pub form: Class,
}

impl Row {
    /// The cycles before anything that [`Class`] and a refill add.
    pub fn cycles(&self, core: Core) -> u64 {
        match core {
            Core::M3 => self.m3,
            Core::M4F => self.m4,
        }
    }
}

const fn row(name: &'static str, mask: u32, value: u32, [m3, m4]: [u64; 2], form: Class) -> Row {
    Row { name, mask, value, m3, m4, form }
}

/// The table; the first row that fits an instruction holds.
#[rustfmt::skip]
pub const TIMINGS: &[Row] = {
    use Class::{Arithmetic, Fixed, FloatList, List, Move, Single};
    use Reads::{D, DM, M, N, NM, Nothing};
    &[
        // 16-bit instructions
        row("ldr (literal)",         0xf800_0000, 0x4800_0000, [2, 2], Single),
        row("ldr, str (register)",   0xf000_0000, 0x5000_0000, [2, 2], Single),
        row("ldr, str, ldrb, strb",  0xe000_0000, 0x6000_0000, [2, 2], Single),
        row("ldrh, strh",            0xf000_0000, 0x8000_0000, [2, 2], Single),
        row("ldr, str (sp)",         0xf000_0000, 0x9000_0000, [2, 2], Single),
        row("push",                  0xfe00_0000, 0xb400_0000, [1, 1], List),
        row("pop",                   0xfe00_0000, 0xbc00_0000, [1, 1], List),
        row("ldm, stm",              0xf000_0000, 0xc000_0000, [1, 1], List),
        row("it, nop",               0xff00_0000, 0xbf00_0000, [1, 1], Fixed),
        row("16-bit data and branches", 0x8000_0000, 0x0000_0000, [1, 1], Fixed),
        row("16-bit data and branches", 0xe000_0000, 0xa000_0000, [1, 1], Fixed),
        row("b (conditional)",       0xf000_0000, 0xd000_0000, [1, 1], Fixed),
        row("b",                     0xf800_0000, 0xe000_0000, [1, 1], Fixed),
        // 32-bit loads and stores
        row("tbb, tbh",              0xfff0_ffe0, 0xe8d0_f000, [2, 2], Fixed),
        row("ldrex, strex",          0xff60_0000, 0xe840_0000, [2, 2], Fixed),
        row("ldm.w, stm.w, push.w, pop.w", 0xfe40_0000, 0xe800_0000, [1, 1], List),
        row("ldrd, strd",            0xfe40_0000, 0xe840_0000, [3, 3], Fixed),
        row("str.w",                 0xff10_0000, 0xf800_0000, [2, 2], Single),
        row("ldr.w",                 0xfe10_0000, 0xf810_0000, [2, 2], Single),
        // 32-bit data processing and branches
        row("data processing (shifted)",   0xfe00_0000, 0xea00_0000, [1, 1], Fixed),
        row("data processing (immediate)", 0xf800_8000, 0xf000_0000, [1, 1], Fixed),
        row("b.w, bl, mrs, msr",     0xf800_8000, 0xf000_8000, [1, 1], Fixed),
        row("data processing (register)",  0xff00_0000, 0xfa00_0000, [1, 1], Fixed),
        // multiplication and division
        row("mul",                   0xfff0_f0f0, 0xfb00_f000, [1, 1], Fixed),
        row("mla, mls, smmul",       0xff80_0000, 0xfb00_0000, [2, 1], Fixed),
        row("sdiv, udiv",            0xffd0_00f0, 0xfb90_00f0, [7, 7], Fixed),
        row("smull, umull",          0xffd0_00f0, 0xfb80_0000, [4, 1], Fixed),
        row("smlal, umlal",          0xffc0_0000, 0xfbc0_0000, [6, 1], Fixed),
        // floating-point loads, stores and moves; the M3 has none of what follows
        row("vmov (two to float)",   0xfff0_0e00, 0xec40_0a00, [0, 2], Move(Nothing)),
        row("vmov (two from float)", 0xfff0_0e00, 0xec50_0a00, [0, 2], Move(M)),
        row("vldr",                  0xff30_0f00, 0xed10_0a00, [0, 2], Single),
        row("vldr.64",               0xff30_0f00, 0xed10_0b00, [0, 3], Fixed),
        row("vstr",                  0xff30_0f00, 0xed00_0a00, [0, 2], Single),
        row("vstr.64",               0xff30_0f00, 0xed00_0b00, [0, 3], Fixed),
        row("vldm, vstm, vpush, vpop", 0xfe00_0e00, 0xec00_0a00, [0, 1], FloatList),
        row("vmov (to float)",       0xfff0_0f10, 0xee00_0a10, [0, 2], Move(Nothing)),
        row("vmov (from float)",     0xfff0_0f10, 0xee10_0a10, [0, 2], Move(N)),
        row("vmrs, vmsr",            0xffef_0fff, 0xeee1_0a10, [0, 1], Fixed),
        row("vmov (immediate)",      0xffb0_0ff0, 0xeeb0_0a00, [0, 1], Move(Nothing)),
        row("vmov, vabs",            0xffbf_0f50, 0xeeb0_0a40, [0, 1], Move(M)),
        row("vneg",                  0xffbf_0fd0, 0xeeb1_0a40, [0, 1], Move(M)),
        row("vcmp",                  0xffbf_0f50, 0xeeb4_0a40, [0, 1], Move(DM)),
        row("vcmp (zero)",           0xffbf_0f50, 0xeeb5_0a40, [0, 1], Move(D)),
        // floating-point arithmetic
        row("vadd, vsub",            0xffb0_0f10, 0xee30_0a00, [0, 1], Arithmetic(NM)),
        row("vmul, vnmul",           0xffb0_0f10, 0xee20_0a00, [0, 1], Arithmetic(NM)),
        row("vmla, vmls",            0xffb0_0f10, 0xee00_0a00, [0, 3], Arithmetic(NM)),
        row("vnmla, vnmls",          0xffb0_0f10, 0xee10_0a00, [0, 3], Arithmetic(NM)),
        row("vfma, vfms",            0xffb0_0f10, 0xeea0_0a00, [0, 3], Arithmetic(NM)),
        row("vfnma, vfnms",          0xffb0_0f10, 0xee90_0a00, [0, 3], Arithmetic(NM)),
        row("vdiv",                  0xffb0_0f10, 0xee80_0a00, [0, 14], Arithmetic(NM)),
        row("vsqrt",                 0xffbf_0fd0, 0xeeb1_0ac0, [0, 14], Arithmetic(M)),
        row("vcvt (half)",           0xffbe_0f50, 0xeeb2_0a40, [0, 1], Arithmetic(M)),
        row("vcvt (fixed point)",    0xffba_0f50, 0xeeba_0a40, [0, 1], Arithmetic(D)),
        row("vcvt (integer)",        0xffb8_0f50, 0xeeb8_0a40, [0, 1], Arithmetic(M)),
    ]
};
