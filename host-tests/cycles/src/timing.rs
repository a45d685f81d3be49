//! Published instruction timings of the Cortex-M3, Cortex-M4 and Cortex-M0+, as data.
//!
//! Sources: Cortex-M3 TRM (Arm DDI 0337) and Cortex-M4 TRM r0p1 (Arm DDI 0439), "Instruction set
//! summary" (table 3-1), and DDI 0439 "FPU instruction set" (table 7-1) with its notes; Cortex-M0+
//! TRM r0p1 (Arm DDI 0484C), "Instruction set summary" (table 3-1), with the 1-cycle multiplier of
//! the RP2040 and without a single-cycle port. The encodings come from the ARMv7-M Architecture
//! Reference Manual (Arm DDI 0403), chapters A5 and A6. All timings assume memory without wait
//! states.
//!
//! For a long product on the M3 the manuals give a range (3 to 5, with accumulation 4 to 7). The
//! table has the upper end because it fits published measurements best. A single store with an
//! immediate offset takes 1 cycle as measured, although table 3-1 says 2. The table assumes the
//! same for vstr, without a measurement. The module `pipeline` contains the effects of neighbouring
//! instructions.

use crate::row::Class::{
    Arithmetic, Aside, Branch, Divide, Fixed, FloatList, IfThen, Load, LoadList, LoadPair, Move,
    Store, StoreList,
};
use crate::row::Field::{Any, Low0, Low3, Low6, Low8, Sp, Wide0, Wide8, Wide12, Wide16};
use crate::row::Float::{D, Half, M, N};
use crate::row::{Row, row};

/// The cycles to refill the pipeline after a taken branch to an address in the instruction:
/// "normally 1" (DDI 0337, table 3-1 of older issues).
pub const DIRECT_REFILL: u64 = 1;
/// The cycles to refill the pipeline after bx, a pop of pc or an interrupt: "normally 2". On the
/// M0+ only a pop of pc takes them.
pub const INDIRECT_REFILL: u64 = 2;
/// The additional cycles if a taken branch leads to a 32-bit instruction off a word's boundary: the
/// first fetch brings only half of it. The M0+ does not take them.
pub const UNALIGNED_TARGET: u64 = 1;
/// The additional cycles until a floating-point result can be consumed (DDI 0439, notes of table
/// 7-1).
pub const RESULT_USE_STALL: u64 = 1;

/// The first row that matches an instruction is used. 0 cycles mean that the core does not have it,
/// or a division.
#[rustfmt::skip]
pub const TIMINGS: &[Row] = &[
    // 16-bit loads and stores
    row("ldr (literal)",    0xf800_0000, 0x4800_0000, [2, 2, 2], Load,      &[Low8], &[]),
    row("ldrsb (register)", 0xfe00_0000, 0x5600_0000, [2, 2, 2], Load,      &[Low0], &[Low3, Low6]),
    row("str (register)",   0xf800_0000, 0x5000_0000, [2, 2, 2], Store,     &[], &[Low3, Low6]),
    row("ldr (register)",   0xf800_0000, 0x5800_0000, [2, 2, 2], Load,      &[Low0], &[Low3, Low6]),
    row("str, strb",        0xe800_0000, 0x6000_0000, [1, 1, 2], Store,     &[], &[Low3]),
    row("ldr, ldrb",        0xe800_0000, 0x6800_0000, [2, 2, 2], Load,      &[Low0], &[Low3]),
    row("strh",             0xf800_0000, 0x8000_0000, [1, 1, 2], Store,     &[], &[Low3]),
    row("ldrh",             0xf800_0000, 0x8800_0000, [2, 2, 2], Load,      &[Low0], &[Low3]),
    row("str (sp)",         0xf800_0000, 0x9000_0000, [1, 1, 2], Store,     &[], &[Sp]),
    row("ldr (sp)",         0xf800_0000, 0x9800_0000, [2, 2, 2], Load,      &[Low8], &[Sp]),
    row("push",             0xfe00_0000, 0xb400_0000, [1, 1, 1], StoreList, &[], &[Sp]),
    row("pop",              0xfe00_0000, 0xbc00_0000, [1, 1, 1], LoadList,  &[], &[Sp]),
    row("stm",              0xf800_0000, 0xc000_0000, [1, 1, 1], StoreList, &[], &[Low8]),
    row("ldm",              0xf800_0000, 0xc800_0000, [1, 1, 1], LoadList,  &[], &[Low8]),
    // other 16-bit instructions
    row("nop, wfi",                  0xff0f_0000, 0xbf00_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("it",                        0xff00_0000, 0xbf00_0000, [1, 1, 0], IfThen, &[], &[]),
    row("shift, add, sub",           0xe000_0000, 0x0000_0000, [1, 1, 1], Fixed,  &[Low0], &[]),
    row("cmp (immediate)",           0xf800_0000, 0x2800_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("mov, add, sub (immediate)", 0xe000_0000, 0x2000_0000, [1, 1, 1], Fixed,  &[Low8], &[]),
    row("tst",                       0xffc0_0000, 0x4200_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("cmp, cmn (register)",       0xff80_0000, 0x4280_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("data processing",           0xfc00_0000, 0x4000_0000, [1, 1, 1], Fixed,  &[Low0], &[]),
    row("add, mov (any register)",   0xfd00_0000, 0x4400_0000, [1, 1, 1], Fixed,  &[Any], &[]),
    row("cmp (any register)",        0xff00_0000, 0x4500_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("bx, blx",                   0xff00_0000, 0x4700_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("adr, add (sp)",             0xf000_0000, 0xa000_0000, [1, 1, 1], Fixed,  &[Low8], &[]),
    row("add, sub (to sp)",          0xff00_0000, 0xb000_0000, [1, 1, 1], Fixed,  &[Sp], &[]),
    row("cbz, cbnz",                 0xf500_0000, 0xb100_0000, [1, 1, 0], Branch, &[], &[]),
    row("sxth, sxtb, uxth, uxtb",    0xff00_0000, 0xb200_0000, [1, 1, 1], Fixed,  &[Low0], &[]),
    row("rev",                       0xff00_0000, 0xba00_0000, [1, 1, 1], Fixed,  &[Low0], &[]),
    row("cps, bkpt",                 0xf000_0000, 0xb000_0000, [1, 1, 1], Fixed,  &[], &[]),
    row("b (conditional)",           0xf000_0000, 0xd000_0000, [1, 1, 1], Branch, &[], &[]),
    row("b",                         0xf800_0000, 0xe000_0000, [1, 1, 1], Branch, &[], &[]),
    // 32-bit loads and stores
    row("tbb, tbh", 0xfff0_ffe0, 0xe8d0_f000, [2, 2, 0], Fixed, &[], &[Wide16, Wide0]),
    row("ldrex, strex", 0xff60_0000, 0xe840_0000, [2, 2, 0], Fixed, &[], &[Wide16]),
    row("stm.w, push.w", 0xfe50_0000, 0xe800_0000, [1, 1, 0], StoreList, &[], &[Wide16]),
    row("ldm.w, pop.w", 0xfe50_0000, 0xe810_0000, [1, 1, 0], LoadList, &[], &[Wide16]),
    row("strd", 0xfe50_0000, 0xe840_0000, [3, 3, 0], Fixed, &[], &[Wide16]),
    row("ldrd", 0xfe50_0000, 0xe850_0000, [3, 3, 0], LoadPair, &[], &[Wide16]),
    row("str.w (register)", 0xff90_0fc0, 0xf800_0000, [2, 2, 0], Store, &[], &[Wide16, Wide0]),
    row("str.w (indexed)", 0xff90_0900, 0xf800_0900, [1, 1, 0], Store, &[Wide16], &[Wide16]),
    row("str.w", 0xff10_0000, 0xf800_0000, [1, 1, 0], Store, &[], &[Wide16]),
    row("ldr.w (literal)", 0xfe1f_0000, 0xf81f_0000, [2, 2, 0], Load, &[Wide12], &[]),
    row("ldr.w (register)", 0xfe90_0fc0, 0xf810_0000, [2, 2, 0], Load, &[Wide12], &[Wide16, Wide0]),
    row("ldr.w (indexed)", 0xfe90_0900, 0xf810_0900, [2, 2, 0], Load, &[Wide12, Wide16], &[Wide16]),
    row("ldr.w", 0xfe10_0000, 0xf810_0000, [2, 2, 0], Load, &[Wide12], &[Wide16]),
    // 32-bit data processing and branches
    row("data processing (shifted)",   0xfe00_0000, 0xea00_0000, [1, 1, 0], Fixed,  &[Wide8], &[]),
    row("data processing (immediate)", 0xf800_8000, 0xf000_0000, [1, 1, 0], Fixed,  &[Wide8], &[]),
    row("mrs, msr, dmb, dsb, isb",     0xff80_d000, 0xf380_8000, [1, 1, 3], Fixed,  &[Wide8], &[]),
    row("b.w, bl",                     0xf800_8000, 0xf000_8000, [1, 1, 2], Branch, &[], &[]),
    row("data processing (register)",  0xff00_0000, 0xfa00_0000, [1, 1, 0], Fixed,  &[Wide8], &[]),
    // multiplication and division
    row("mul",             0xfff0_f0f0, 0xfb00_f000, [1, 1, 0], Fixed,  &[Wide8], &[]),
    row("mla, mls, smmul", 0xff80_0000, 0xfb00_0000, [2, 1, 0], Fixed,  &[Wide8], &[]),
    row("sdiv",            0xfff0_00f0, 0xfb90_00f0, [0, 0, 0], Divide, &[Wide8], &[]),
    row("udiv",            0xfff0_00f0, 0xfbb0_00f0, [0, 0, 0], Divide, &[Wide8], &[]),
    row("smull, umull",    0xffd0_00f0, 0xfb80_0000, [5, 1, 0], Fixed,  &[Wide8, Wide12], &[]),
    row("smlal, umlal",    0xffc0_0000, 0xfbc0_0000, [7, 1, 0], Fixed,  &[Wide8, Wide12], &[]),
    // floating-point loads, stores and moves; the M3 does not have any of these
    row("vmov (two to float)",       0xfff0_0e00, 0xec40_0a00, [0, 2, 0], Move(&[]), &[], &[]),
    row("vmov (two from float)",     0xfff0_0e00, 0xec50_0a00,
        [0, 2, 0], Move(&[M]), &[Wide12, Wide16], &[]),
    row("vldr",                      0xff30_0f00, 0xed10_0a00, [0, 2, 0], Load, &[], &[Wide16]),
    row("vldr.64",                   0xff30_0f00, 0xed10_0b00, [0, 3, 0], LoadPair, &[], &[Wide16]),
    row("vstr",                      0xff30_0f00, 0xed00_0a00, [0, 1, 0], Store, &[], &[Wide16]),
    row("vstr.64",                   0xff30_0f00, 0xed00_0b00, [0, 3, 0], Fixed, &[], &[Wide16]),
    row("vldm, vstm, vpush, vpop",   0xfe00_0e00, 0xec00_0a00,
        [0, 1, 0], FloatList, &[], &[Wide16]),
    row("vmov (to float)",           0xfff0_0f10, 0xee00_0a10, [0, 1, 0], Move(&[]), &[], &[]),
    row("vmov (from float)",         0xfff0_0f10, 0xee10_0a10,
        [0, 1, 0], Move(&[N]), &[Wide12], &[]),
    row("vmov (to half a double)",   0xffd0_0f7f, 0xee00_0b10, [0, 1, 0], Move(&[]), &[], &[]),
    row("vmov (from half a double)", 0xffd0_0f7f, 0xee10_0b10,
        [0, 1, 0], Move(&[Half]), &[Wide12], &[]),
    row("vmrs, vmsr",                0xffef_0fff, 0xeee1_0a10, [0, 1, 0], Move(&[]), &[], &[]),
    row("vmov (immediate)",          0xffb0_0ff0, 0xeeb0_0a00, [0, 1, 0], Move(&[]), &[], &[]),
    row("vmov, vabs",                0xffbf_0f50, 0xeeb0_0a40, [0, 1, 0], Move(&[M]), &[], &[]),
    row("vneg",                      0xffbf_0fd0, 0xeeb1_0a40, [0, 1, 0], Move(&[M]), &[], &[]),
    row("vcmp",                      0xffbf_0f50, 0xeeb4_0a40, [0, 1, 0], Move(&[D, M]), &[], &[]),
    row("vcmp (zero)",               0xffbf_0f50, 0xeeb5_0a40, [0, 1, 0], Move(&[D]), &[], &[]),
    // floating-point arithmetic
    row("vadd, vsub",         0xffb0_0f10, 0xee30_0a00, [0, 1, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vmul, vnmul",        0xffb0_0f10, 0xee20_0a00, [0, 1, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vmla, vmls",         0xffb0_0f10, 0xee00_0a00, [0, 3, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vnmla, vnmls",       0xffb0_0f10, 0xee10_0a00, [0, 3, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vfma, vfms",         0xffb0_0f10, 0xeea0_0a00, [0, 3, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vfnma, vfnms",       0xffb0_0f10, 0xee90_0a00, [0, 3, 0],  Arithmetic(&[N, M]), &[], &[]),
    row("vdiv",               0xffb0_0f10, 0xee80_0a00, [0, 14, 0], Aside(&[N, M]),      &[], &[]),
    row("vsqrt",              0xffbf_0fd0, 0xeeb1_0ac0, [0, 14, 0], Aside(&[M]),         &[], &[]),
    row("vcvt (half)",        0xffbe_0f50, 0xeeb2_0a40, [0, 1, 0],  Arithmetic(&[M]),    &[], &[]),
    row("vcvt (fixed point)", 0xffba_0f50, 0xeeba_0a40, [0, 1, 0],  Arithmetic(&[D]),    &[], &[]),
    row("vcvt (integer)",     0xffb8_0f50, 0xeeb8_0a40, [0, 1, 0],  Arithmetic(&[M]),    &[], &[]),
];
