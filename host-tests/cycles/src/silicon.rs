//! Tests of the timing rules. Each rule has a small loop, which passes through the decoder and the
//! pipeline like any other code.
//!
//! The expected values are published counts of chips: 200 loads and 200 sums (STM32F429), an
//! STM32F103 and an STM32F407 measured by jnk0le/random ("pipeline cycle test"), divisions of all
//! lengths on a Cortex-M4 (compendium.i-0.nl, "Division timing"), and the examples of the
//! Cortex-M3's manual (DDI 0337, "Load/store timings"). No counts were found for vmul, vsqrt, vfma,
//! vldm, and for vldr and vstr in a row. Tests that contain one of these rely on the manual alone.

use crate::Core::{self, M0Plus, M3, M4F};
use crate::instruction::Instruction;
use crate::pipeline::{Cost, Pipeline};
use crate::stream::Registers;

/// The halfwords of an instruction as one number; the lower half of a 16-bit instruction is 0.
type Word = u32;

/// A sum of integers that depends on no other instruction here.
const ADDS_R4_R5_R6: Word = 0x19ac_0000;
const ADDS_R0_4: Word = 0x3004_0000;
const CMP_R0: Word = 0x2800_0000;
const IT_EQ: Word = 0xbf08_0000;
const MOV_R1_R2: Word = 0x4611_0000;
const NOP: Word = 0xbf00_0000;
const SUBS_R0_1: Word = 0x3801_0000;
const BNE: Word = 0xd1fc_0000;
const BX_LR: Word = 0x4770_0000;
const POP_PC: Word = 0xbd00_0000;
const LDR_R0_AT_R0: Word = 0x6800_0000;
const LDR_R0_AT_R1: Word = 0x6808_0000;
const LDR_R0_AT_R1_R2: Word = 0x5888_0000;
const LDR_R0_AT_R1_R5: Word = 0x5948_0000;
const LDR_R1_AT_R0: Word = 0x6801_0000;
const LDR_R1_AT_R2: Word = 0x6811_0000;
const LDR_R2_AT_R3: Word = 0x685a_0000;
const STR_R1_AT_R2: Word = 0x6011_0000;
const STR_R1_AT_R3_R2: Word = 0x5099_0000;
const SUB_SP: Word = 0xb082_0000;
const STR_R0_AT_SP: Word = 0x9000_0000;
const CMP_W_R0: Word = 0xf1b0_0f00;
const BL: Word = 0xf7ff_fffe;
const LDM_R0: Word = 0xc806_0000;
const LDR_R1_AFTER_R2: Word = 0xf852_1b04;
const LDR_R3_AFTER_R4: Word = 0xf854_3b04;
const STR_R1_AFTER_R2: Word = 0xf842_1b04;
const MULS: Word = 0x4350_0000;
const MRS: Word = 0xf3ef_8008;
const UMULL: Word = 0xfba2_0103;
const UMLAL: Word = 0xfbe2_0103;
const UDIV_R0_R1_R2: Word = 0xfbb1_f0f2;
const SDIV_R0_R1_R2: Word = 0xfb91_f0f2;
const VADD_S0_S1_S2: Word = 0xee30_0a81;
const VADD_S0_S0_S2: Word = 0xee30_0a01;
const VDIV_S0_S1_S2: Word = 0xee80_0a81;
const VSQRT_S0_S1: Word = 0xeeb1_0ae0;
const VMOV_R0_S0: Word = 0xee10_0a10;
const VMOV_R0_S5: Word = 0xee12_0a90;
const VMOV_S0_R0: Word = 0xee00_0a10;
const VMOV_D0_HALF_R0: Word = 0xee20_0b10;
const VMOV_R0_D0_HALF: Word = 0xee30_0b10;
const VADD_D0: Word = 0xee31_0b02;
const VADD_S1_S1_S2: Word = 0xee70_0a81;
const VADD_S3_S0_S2: Word = 0xee70_1a01;
const VADD_S3_S4_S2: Word = 0xee72_1a01;
const VFMA_S0_S4_S2: Word = 0xeea2_0a01;
const VFMA_S4_S0_S2: Word = 0xeea0_2a01;
const VSTR_S0: Word = 0xed80_0a00;
const VSTR_S4: Word = 0xed80_2a00;
const VPUSH_D0: Word = 0xed2d_0b02;

fn decoded(word: Word) -> Instruction {
    let instruction = Instruction::decode((word >> 16) as u16, word as u16);
    instruction.unwrap_or_else(|| panic!("no row for {word:#010x}"))
}

/// Returns the cost of straight code that is executed `times` times.
fn run(core: Core, times: usize, code: &[Word], [r0, r1, r2]: [u32; 3]) -> Cost {
    let mut registers = Registers::default();
    registers.general[..3].copy_from_slice(&[r0, r1, r2]);
    let mut pipeline = Pipeline::new(core);
    let mut total = Cost::default();
    for word in code.repeat(times) {
        total += pipeline.execute(decoded(word), &registers, false);
    }
    total
}

fn taken(core: Core, word: Word) -> u64 {
    Pipeline::new(core)
        .execute(decoded(word), &Registers::default(), true)
        .cycles
}

const BOTH: &[Core] = &[M3, M4F];

type Row = (
    &'static str,
    &'static [Core],
    usize,
    &'static [Word],
    u64,
    u64,
);

#[rustfmt::skip]
const RULES: &[Row] = &[
    ("loads in a row take a cycle each",
        BOTH, 200, &[LDR_R1_AT_R0], 201, 0),
    ("a load of its own address is not pipelined",
        BOTH, 200, &[LDR_R0_AT_R0], 400, 0),
    ("the manual's example of two loads",
        BOTH, 1, &[LDR_R0_AT_R1, LDR_R1_AT_R2], 3, 0),
    ("the manual's example of a load and a store",
        BOTH, 1, &[LDR_R0_AT_R1_R2, STR_R1_AT_R3_R2], 3, 0),
    ("the manual's example of three loads",
        BOTH, 1, &[LDR_R0_AT_R1_R5, LDR_R1_AT_R2, LDR_R2_AT_R3], 4, 0),
    ("a store takes a cycle",
        BOTH, 200, &[STR_R1_AT_R2], 200, 0),
    ("a store with an offset in a register takes two cycles",
        BOTH, 200, &[STR_R1_AT_R3_R2], 400, 0),
    ("a store after a load, an instruction each",
        BOTH, 100, &[LDR_R1_AT_R0, STR_R1_AT_R2, ADDS_R4_R5_R6], 300, 0),
    ("a load after a store waits a cycle",
        BOTH, 100, &[STR_R1_AT_R2, LDR_R1_AT_R0, ADDS_R4_R5_R6], 500, 0),
    ("several loads after a store wait a cycle",
        BOTH, 1, &[STR_R1_AT_R2, LDM_R0], 1 + 1 + 3, 0),
    ("a load one instruction after a store does not wait",
        BOTH, 1, &[STR_R1_AT_R2, ADDS_R4_R5_R6, LDR_R1_AT_R0], 4, 0),
    ("an address written just before costs one",
        BOTH, 100, &[ADDS_R0_4, LDR_R1_AT_R0], 400, 0),
    ("an address written one instruction before costs nothing",
        BOTH, 100, &[ADDS_R0_4, ADDS_R4_R5_R6, LDR_R1_AT_R0], 400, 0),
    ("an address in the stack pointer written just before costs one",
        BOTH, 1, &[SUB_SP, STR_R0_AT_SP], 3, 0),
    ("a comparison writes no address",
        BOTH, 1, &[CMP_R0, LDR_R1_AT_R0], 3, 0),
    ("stores that update their own address register wait for it",
        &[M4F], 200, &[STR_R1_AFTER_R2], 399, 0),
    ("loads that update their own address register wait for it",
        &[M4F], 200, &[LDR_R1_AFTER_R2], 400, 0),
    ("an updated address register does not delay other loads on the M4F",
        &[M4F], 100, &[LDR_R1_AFTER_R2, LDR_R3_AFTER_R4], 201, 0),
    ("an updated address register delays other loads on the M3",
        &[M3], 100, &[LDR_R1_AFTER_R2, LDR_R3_AFTER_R4], 400, 0),
    ("a load that updates no address is pipelined on the M3",
        &[M3], 1, &[LDR_R3_AFTER_R4, LDR_R1_AT_R2], 3, 0),
    ("an it after a 16-bit instruction is free",
        BOTH, 1, &[CMP_R0, IT_EQ, MOV_R1_R2], 2, 0),
    ("an it after a 32-bit instruction takes a cycle",
        BOTH, 1, &[CMP_W_R0, IT_EQ, MOV_R1_R2], 3, 0),
    ("a nop is no it",
        BOTH, 2, &[NOP], 2, 0),
    ("long products are costly on the M3",
        &[M3], 10, &[UMULL], 50, 0),
    ("long products with accumulation take seven cycles on the M3",
        &[M3], 10, &[UMLAL], 70, 0),
    ("long products take a cycle on the M4F",
        &[M4F], 10, &[UMULL, UMLAL], 20, 0),
    ("loads are not pipelined on the M0+",
        &[M0Plus], 100, &[LDR_R1_AT_R0], 200, 0),
    ("loads of their own address do not wait on the M0+",
        &[M0Plus], 100, &[LDR_R0_AT_R0], 200, 0),
    ("stores take two cycles on the M0+",
        &[M0Plus], 100, &[STR_R1_AT_R2], 200, 0),
    ("stores with an offset in a register take two cycles on the M0+",
        &[M0Plus], 100, &[STR_R1_AT_R3_R2], 200, 0),
    ("the M0+ takes the cycles of its manual",
        &[M0Plus], 1, &[SUB_SP, STR_R0_AT_SP, LDM_R0, MULS, MRS], 1 + 2 + 3 + 1 + 3, 0),
    ("a quotient moved at once takes 16",
        &[M4F], 1, &[VDIV_S0_S1_S2, VMOV_R0_S0], 16, 14),
    ("a quotient takes 15 if another register is moved",
        &[M4F], 1, &[VDIV_S0_S1_S2, VMOV_R0_S5], 15, 13),
    ("the core continues during a quotient",
        &[M4F], 1, &[VDIV_S0_S1_S2, ADDS_R4_R5_R6], 2, 0),
    ("the core continues during a root",
        &[M4F], 1, &[VSQRT_S0_S1, ADDS_R4_R5_R6, VMOV_R0_S0], 16, 13),
    ("a move to or from the unit takes a cycle",
        &[M4F], 100, &[VMOV_R0_S5, VMOV_S0_R0, VMOV_D0_HALF_R0, VMOV_R0_D0_HALF], 400, 0),
    ("a result consumed at once stalls a cycle",
        &[M4F], 1, &[VADD_S0_S1_S2, VADD_S3_S0_S2], 3, 1),
    ("a result stored at once stalls a cycle",
        &[M4F], 1, &[VADD_S0_S1_S2, VSTR_S0], 3, 1),
    ("a result pushed at once stalls a cycle",
        &[M4F], 1, &[VADD_S0_S1_S2, VPUSH_D0], 5, 1),
    ("a result moved at once stalls a cycle",
        &[M4F], 1, &[VADD_S0_S1_S2, VMOV_R0_S0], 3, 1),
    ("a result multiplied at once stalls a cycle",
        &[M4F], 1, &[VADD_S0_S1_S2, VFMA_S4_S0_S2], 5, 1),
    ("a result moved at once as half a double stalls a cycle",
        &[M4F], 1, &[VADD_S1_S1_S2, VMOV_R0_D0_HALF], 3, 1),
    ("each of many dependent sums stalls a cycle",
        &[M4F], 200, &[VADD_S0_S0_S2], 399, 199),
    ("an instruction that consumes another register does not stall",
        &[M4F], 1, &[VADD_S0_S1_S2, VADD_S3_S4_S2], 2, 0),
    ("a result consumed one instruction later does not stall",
        &[M4F], 1, &[VADD_S0_S1_S2, VADD_S3_S4_S2, VADD_S3_S0_S2], 3, 0),
    ("a store of another register does not stall",
        &[M4F], 1, &[VADD_S0_S1_S2, VSTR_S4], 2, 0),
    ("a move of another register does not stall",
        &[M4F], 1, &[VADD_S0_S1_S2, VMOV_R0_D0_HALF], 2, 0),
    ("an addend is read late and does not stall",
        &[M4F], 1, &[VADD_S0_S1_S2, VFMA_S0_S4_S2], 4, 0),
    ("a result that is not consumed does not stall",
        &[M4F], 200, &[VADD_S0_S1_S2], 200, 0),
];

#[test]
fn straight_code_takes_the_cycles_of_the_rules() {
    for (rule, cores, times, code, cycles, stalls) in RULES {
        for &core in *cores {
            let cost = run(core, *times, code, [0; 3]);
            assert_eq!(
                (cost.cycles, cost.stalls),
                (*cycles, *stalls),
                "{rule}: {code:#010x?} on {core:?}"
            );
        }
    }

    let during = [
        [VDIV_S0_S1_S2].as_slice(),
        &[ADDS_R4_R5_R6; 14],
        &[VMOV_R0_S0],
    ]
    .concat();
    assert_eq!(run(M4F, 1, &during, [0; 3]).cycles, 16);
}

#[test]
fn a_taken_branch_refills_in_a_cycle_and_a_return_in_two() {
    // Each branch alone, then in a loop.
    let branches = |core| [BNE, BL, BX_LR, POP_PC].map(|word| taken(core, word));
    assert_eq!(
        [M3, M4F, M0Plus].map(branches),
        [[2, 2, 3, 4], [2, 2, 3, 4], [2, 3, 2, 4]]
    );

    // The delay loops of the crate cortex-m, "4 cycles", and of the Pico's C SDK, "3 cycles per
    // loop".
    for core in [M3, M4F] {
        let mut pipeline = Pipeline::new(core);
        let registers = Registers::default();
        let mut step =
            |word, branches| pipeline.execute(decoded(word), &registers, branches).cycles;
        let turns: u64 = (0..10)
            .map(|_| step(NOP, false) + step(SUBS_R0_1, false) + step(BNE, true))
            .sum();
        assert_eq!(turns, 40);
    }
    assert_eq!(
        run(M0Plus, 1, &[SUBS_R0_1], [0; 3]).cycles + taken(M0Plus, BNE),
        3
    );
}

#[test]
fn a_branch_to_a_32_bit_instruction_off_a_word_s_boundary_takes_a_cycle_more() {
    let turn = |core, target, address| {
        let mut registers = Registers::default();
        let mut pipeline = Pipeline::new(core);
        let branch = pipeline.execute(decoded(BNE), &registers, true).cycles;
        registers.general[15] = address;
        let first = pipeline.execute(decoded(target), &registers, false).cycles;
        branch + first + pipeline.execute(decoded(target), &registers, false).cycles
    };
    for core in [M3, M4F] {
        assert_eq!(
            [0x100, 0x102].map(|address| turn(core, CMP_W_R0, address)),
            [4, 5]
        );
        assert_eq!(
            [0x100, 0x102].map(|address| turn(core, CMP_R0, address)),
            [4, 4]
        );
    }
}

#[test]
fn the_time_of_a_division_depends_on_the_length_of_its_quotient() {
    for (word, dividend, divisor, expected) in [
        (UDIV_R0_R1_R2, 0, 5, 2),
        (UDIV_R0_R1_R2, 5, 0, 2),
        (UDIV_R0_R1_R2, 5, 1000, 3),
        (UDIV_R0_R1_R2, 1000, 1000, 5),
        (UDIV_R0_R1_R2, 9, 3, 5),
        (UDIV_R0_R1_R2, 1 << 31, 3, 12),
        (UDIV_R0_R1_R2, u32::MAX, 1, 12),
        (SDIV_R0_R1_R2, -5_i32 as u32, 1000, 3),
        (SDIV_R0_R1_R2, i32::MIN as u32, -1_i32 as u32, 12),
        (SDIV_R0_R1_R2, -16_i32 as u32, 16, 5),
    ] {
        let cycles = [M3, M4F].map(|core| run(core, 1, &[word], [0, dividend, divisor]).cycles);
        assert_eq!(cycles, [expected; 2], "{dividend} / {divisor}");
    }
}

#[test]
fn multiply_accumulate_is_recognised() {
    for (name, encodings) in [
        ("vmla, vmls", [0xee02_0a01, 0xee02_0a41]),
        ("vnmla, vnmls", [0xee12_0a41, 0xee12_0a01]),
        ("vfma, vfms", [0xeea2_0a01, 0xeea2_0a41]),
        ("vfnma, vfnms", [0xee92_0a41, 0xee92_0a01]),
        ("vmul, vnmul", [0xee22_0a01, 0xee22_0a41]),
        ("vadd, vsub", [0xee32_0a01, 0xee32_0a41]),
    ] {
        assert_eq!(
            encodings.map(|word| decoded(word).row.name),
            [name; 2],
            "{encodings:08x?}"
        );
    }
}

#[test]
fn an_instruction_that_no_m4f_has_is_refused() {
    assert!(Instruction::decode((VADD_D0 >> 16) as u16, VADD_D0 as u16).is_none());
}
