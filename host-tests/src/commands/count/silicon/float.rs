//! The floating-point unit of the M4F.

use super::{ADDS_R4_R5_R6, Word, cycles, run};
use crate::commands::count::instruction::Instruction;
use crate::emulator::boards::Core::M4F;

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

fn assert_cost(code: &[Word], cycles: u64, stalls: u64) {
    let cost = run(M4F, 1, code, [0; 3]);
    assert_eq!((cost.cycles, cost.stalls), (cycles, stalls), "{code:#010x?}");
}

#[test]
fn a_result_consumed_at_once_stalls_one_cycle() {
    assert_cost(&[VADD_S0_S1_S2, VADD_S3_S0_S2], 3, 1);
    assert_cost(&[VADD_S0_S1_S2, VSTR_S0], 3, 1);
    assert_cost(&[VADD_S0_S1_S2, VPUSH_D0], 5, 1);
    assert_cost(&[VADD_S0_S1_S2, VMOV_R0_S0], 3, 1);
    assert_cost(&[VADD_S0_S1_S2, VFMA_S4_S0_S2], 5, 1);
    assert_cost(&[VADD_S1_S1_S2, VMOV_R0_D0_HALF], 3, 1);
}

#[test]
fn nothing_stalls_on_another_register_or_one_instruction_later() {
    assert_cost(&[VADD_S0_S1_S2, VADD_S3_S4_S2], 2, 0);
    assert_cost(&[VADD_S0_S1_S2, VADD_S3_S4_S2, VADD_S3_S0_S2], 3, 0);
    assert_cost(&[VADD_S0_S1_S2, VSTR_S4], 2, 0);
    assert_cost(&[VADD_S0_S1_S2, VMOV_R0_D0_HALF], 2, 0);
}

#[test]
fn an_addend_is_read_late() {
    assert_cost(&[VADD_S0_S1_S2, VFMA_S0_S4_S2], 4, 0);
}

#[test]
fn sums_take_a_cycle_and_twice_that_if_each_needs_the_one_before() {
    let independent = run(M4F, 200, &[VADD_S0_S1_S2], [0; 3]);
    let dependent = run(M4F, 200, &[VADD_S0_S0_S2], [0; 3]);
    assert_eq!((independent.cycles, dependent.cycles), (200, 399));
    assert_eq!((independent.stalls, dependent.stalls), (0, 199));
}

#[test]
fn a_quotient_moved_at_once_takes_16_cycles() {
    assert_eq!(cycles(M4F, 1, &[VDIV_S0_S1_S2, VMOV_R0_S0]), 16);
    assert_eq!(cycles(M4F, 1, &[VDIV_S0_S1_S2, VMOV_R0_S5]), 15);
}

#[test]
fn the_core_goes_on_beside_a_quotient() {
    assert_eq!(cycles(M4F, 1, &[VDIV_S0_S1_S2, ADDS_R4_R5_R6]), 2);
    assert_eq!(cycles(M4F, 1, &[VSQRT_S0_S1, ADDS_R4_R5_R6, VMOV_R0_S0]), 16);
    let beside = [[VDIV_S0_S1_S2].as_slice(), &[ADDS_R4_R5_R6; 14], &[VMOV_R0_S0]].concat();
    assert_eq!(cycles(M4F, 1, &beside), 16);
}

#[test]
fn a_register_moves_to_and_from_the_unit_in_a_cycle() {
    for word in [VMOV_R0_S5, VMOV_S0_R0, VMOV_D0_HALF_R0, VMOV_R0_D0_HALF] {
        assert_eq!(cycles(M4F, 100, &[word]), 100, "{word:#010x}");
    }
}

#[test]
fn what_no_m4f_has_is_refused() {
    assert!(Instruction::decode((VADD_D0 >> 16) as u16, VADD_D0 as u16).is_none());
}
