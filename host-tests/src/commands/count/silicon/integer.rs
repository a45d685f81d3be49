//! Loads, stores, branches, products and quotients of integers.

use super::{ADDS_R4_R5_R6, Word, cycles, decoded, run};
use crate::commands::count::pipeline::Pipeline;
use crate::commands::count::trace::Registers;
use crate::emulator::boards::Core::{M0Plus, M3, M4F};

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

/// The same count on both cores.
fn both(times: usize, code: &[Word]) -> u64 {
    let [m3, m4] = [M3, M4F].map(|core| cycles(core, times, code));
    assert_eq!(m3, m4, "{code:#010x?}");
    m3
}

#[test]
fn loads_in_a_row_take_a_cycle_each_and_twice_that_if_each_address_is_the_load_before() {
    assert_eq!(both(200, &[LDR_R1_AT_R0]), 201);
    assert_eq!(both(200, &[LDR_R0_AT_R0]), 400);
}

#[test]
fn the_manual_s_examples_of_loads_and_stores() {
    assert_eq!(both(1, &[LDR_R0_AT_R1, LDR_R1_AT_R2]), 3);
    assert_eq!(both(1, &[LDR_R0_AT_R1_R2, STR_R1_AT_R3_R2]), 3);
    assert_eq!(both(1, &[LDR_R0_AT_R1_R5, LDR_R1_AT_R2, LDR_R2_AT_R3]), 4);
}

#[test]
fn stores_take_a_cycle_unless_their_offset_is_in_a_register() {
    assert_eq!(both(200, &[STR_R1_AT_R2]), 200);
    assert_eq!(both(200, &[STR_R1_AT_R3_R2]), 400);
}

#[test]
fn a_store_after_a_load_makes_an_instruction_a_cycle() {
    assert_eq!(both(100, &[LDR_R1_AT_R0, STR_R1_AT_R2, ADDS_R4_R5_R6]), 300);
}

#[test]
fn a_load_after_a_store_waits_a_cycle() {
    assert_eq!(both(100, &[STR_R1_AT_R2, LDR_R1_AT_R0, ADDS_R4_R5_R6]), 500);
    assert_eq!(both(1, &[STR_R1_AT_R2, LDM_R0]), 1 + 1 + 3);
    assert_eq!(both(1, &[STR_R1_AT_R2, ADDS_R4_R5_R6, LDR_R1_AT_R0]), 4);
}

#[test]
fn an_address_written_just_before_costs_a_cycle() {
    assert_eq!(both(100, &[ADDS_R0_4, LDR_R1_AT_R0]), 400);
    assert_eq!(both(100, &[ADDS_R0_4, ADDS_R4_R5_R6, LDR_R1_AT_R0]), 400);
    assert_eq!(both(1, &[SUB_SP, STR_R0_AT_SP]), 3);
    assert_eq!(both(1, &[CMP_R0, LDR_R1_AT_R0]), 3);
}

#[test]
fn new_addresses_in_the_register_are_free_for_others_only() {
    assert_eq!(cycles(M4F, 200, &[STR_R1_AFTER_R2]), 399);
    assert_eq!(cycles(M4F, 200, &[LDR_R1_AFTER_R2]), 400);
    assert_eq!(cycles(M4F, 100, &[LDR_R1_AFTER_R2, LDR_R3_AFTER_R4]), 201);
    assert_eq!(cycles(M3, 100, &[LDR_R1_AFTER_R2, LDR_R3_AFTER_R4]), 400);
    assert_eq!(cycles(M3, 1, &[LDR_R3_AFTER_R4, LDR_R1_AT_R2]), 3);
}

#[test]
fn an_it_after_a_16_bit_instruction_is_free() {
    assert_eq!(both(1, &[CMP_R0, IT_EQ, MOV_R1_R2]), 2);
    assert_eq!(both(1, &[CMP_W_R0, IT_EQ, MOV_R1_R2]), 3);
    assert_eq!(both(2, &[NOP]), 2);
}

#[test]
fn a_taken_branch_refills_in_a_cycle_and_a_return_in_two() {
    let registers = Registers::default();
    let taken = |core, word| Pipeline::new(core).execute(decoded(word), &registers, true).cycles;
    for core in [M3, M4F] {
        assert_eq!([BNE, BL, BX_LR, POP_PC].map(|word| taken(core, word)), [2, 2, 3, 4]);
        // the delay loop of the crate cortex-m: "4 cycles"
        let mut pipeline = Pipeline::new(core);
        let mut step = |word, branches| pipeline.execute(decoded(word), &registers, branches).cycles;
        let turns: u64 = (0..10).map(|_| step(NOP, false) + step(SUBS_R0_1, false) + step(BNE, true)).sum();
        assert_eq!(turns, 40);
    }
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
        assert_eq!([0x100, 0x102].map(|address| turn(core, CMP_W_R0, address)), [4, 5]);
        assert_eq!([0x100, 0x102].map(|address| turn(core, CMP_R0, address)), [4, 4]);
    }
}

#[test]
fn an_m0_plus_takes_what_its_manual_says_whatever_the_neighbours() {
    assert_eq!(
        [LDR_R1_AT_R0, LDR_R0_AT_R0, STR_R1_AT_R2, STR_R1_AT_R3_R2].map(|word| cycles(M0Plus, 100, &[word])),
        [200; 4]
    );
    assert_eq!(cycles(M0Plus, 1, &[SUB_SP, STR_R0_AT_SP, LDM_R0, MULS, MRS]), 1 + 2 + 3 + 1 + 3);
    let registers = Registers::default();
    let taken = |word| Pipeline::new(M0Plus).execute(decoded(word), &registers, true).cycles;
    assert_eq!([BNE, BL, BX_LR, POP_PC].map(taken), [2, 3, 2, 4]);
    // the delay loop of the Pico's kit for C: "3 cycles per loop"
    assert_eq!(cycles(M0Plus, 1, &[SUBS_R0_1]) + taken(BNE), 3);
}

#[test]
fn long_products_are_costly_on_the_m3_alone() {
    assert_eq!([M3, M4F].map(|core| cycles(core, 10, &[UMULL])), [50, 10]);
    assert_eq!([M3, M4F].map(|core| cycles(core, 10, &[UMLAL])), [70, 10]);
}

#[test]
fn a_division_takes_as_long_as_its_quotient_is() {
    let one = |word, dividend, divisor| [M3, M4F].map(|core| run(core, 1, &[word], [0, dividend, divisor]).cycles);
    for (dividend, divisor, expected) in
        [(0, 5, 2), (5, 0, 2), (5, 1000, 3), (1000, 1000, 5), (9, 3, 5), (1 << 31, 3, 12), (u32::MAX, 1, 12)]
    {
        assert_eq!(one(UDIV_R0_R1_R2, dividend, divisor), [expected; 2], "{dividend} / {divisor}");
    }
    assert_eq!(one(SDIV_R0_R1_R2, -5_i32 as u32, 1000), [3; 2]);
    assert_eq!(one(SDIV_R0_R1_R2, i32::MIN as u32, -1_i32 as u32), [12; 2]);
    assert_eq!(one(SDIV_R0_R1_R2, -16_i32 as u32, 16), [5; 2]);
}
