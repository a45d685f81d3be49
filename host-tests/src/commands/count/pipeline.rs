//! The estimate: what the published timings say of an executed stream.

use std::ops::{AddAssign, Sub};

use super::instruction::Instruction;
use super::timing::{REFILL, RESULT_USE_STALL};
use crate::emulator::boards::Core;

/// Executed instructions, which are exact, and the cycles they take by the published timings, which are an estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Executed instructions. One whose condition fails counts like any other.
    pub instructions: u64,
    /// Estimated cycles if neighbouring single loads and stores are always pipelined.
    pub cycles_low: u64,
    /// Estimated cycles if they never are.
    pub cycles_high: u64,
    /// Those of the cycles that wait for a floating-point result.
    pub stalls: u64,
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.instructions += other.instructions;
        self.cycles_low += other.cycles_low;
        self.cycles_high += other.cycles_high;
        self.stalls += other.stalls;
    }
}

impl Sub for Cost {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            instructions: self.instructions.saturating_sub(other.instructions),
            cycles_low: self.cycles_low.saturating_sub(other.cycles_low),
            cycles_high: self.cycles_high.saturating_sub(other.cycles_high),
            stalls: self.stalls.saturating_sub(other.stalls),
        }
    }
}

/// The processor, one instruction after the other.
#[derive(Clone, Copy, Debug)]
pub struct Pipeline {
    core: Core,
    previous: Option<Instruction>,
}

impl Pipeline {
    /// Before the first instruction.
    pub fn new(core: Core) -> Self {
        Self { core, previous: None }
    }

    /// The cost of the next instruction executed; `branches`: not followed by the next one in memory.
    pub fn execute(&mut self, instruction: Instruction, branches: bool) -> Cost {
        let previous = self.previous.replace(instruction);
        let stalls = match previous.and_then(|previous| previous.late_result()) {
            Some(register) if instruction.consumes(register) => RESULT_USE_STALL,
            _ => 0,
        };
        let refill = if branches { REFILL } else { 0 };
        let cycles = instruction.cycles(self.core) + stalls + refill;
        let pipelined = instruction.is_single_access() && previous.is_some_and(|previous| previous.is_single_access());
        Cost { instructions: 1, cycles_low: cycles - u64::from(pipelined), cycles_high: cycles, stalls }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cost of a straight piece of code on an M4F.
    fn straight(code: &[u32]) -> Cost {
        let mut pipeline = Pipeline::new(Core::M4F);
        let mut total = Cost::default();
        for &word in code {
            let instruction = Instruction::decode((word >> 16) as u16, word as u16);
            total += pipeline.execute(instruction.unwrap_or_else(|| panic!("no row for {word:#010x}")), false);
        }
        total
    }

    const VADD_S0_S1_S2: u32 = 0xee30_0a81;
    const VADD_S3_S0_S2: u32 = 0xee70_1a01;
    const VADD_S3_S4_S2: u32 = 0xee72_1a01;
    const VFMA_S0_S4_S2: u32 = 0xeea2_0a01;
    const VFMA_S4_S0_S2: u32 = 0xeea0_2a01;
    const VDIV_S0_S1_S2: u32 = 0xee80_0a81;
    const VSTR_S0: u32 = 0xed80_0a00;
    const VSTR_S4: u32 = 0xed80_2a00;
    const VPUSH_D0: u32 = 0xed2d_0b02;
    const VMOV_R0_S0: u32 = 0xee10_0a10;
    const LDR_R0: u32 = 0x6800_0000;

    fn assert_cost(code: &[u32], cycles: u64, stalls: u64) {
        let cost = straight(code);
        assert_eq!((cost.cycles_high, cost.stalls), (cycles, stalls), "{code:#010x?}");
    }

    #[test]
    fn a_result_consumed_at_once_stalls_one_cycle() {
        assert_cost(&[VADD_S0_S1_S2, VADD_S3_S0_S2], 3, 1);
        assert_cost(&[VDIV_S0_S1_S2, VADD_S3_S0_S2], 16, 1);
        assert_cost(&[VADD_S0_S1_S2, VSTR_S0], 4, 1);
        assert_cost(&[VADD_S0_S1_S2, VPUSH_D0], 5, 1);
        assert_cost(&[VADD_S0_S1_S2, VMOV_R0_S0], 4, 1);
        assert_cost(&[VADD_S0_S1_S2, VFMA_S4_S0_S2], 5, 1);
    }

    #[test]
    fn nothing_stalls_on_another_register_or_one_instruction_later() {
        assert_cost(&[VADD_S0_S1_S2, VADD_S3_S4_S2], 2, 0);
        assert_cost(&[VADD_S0_S1_S2, VADD_S3_S4_S2, VADD_S3_S0_S2], 3, 0);
        assert_cost(&[VADD_S0_S1_S2, VSTR_S4], 3, 0);
    }

    #[test]
    fn an_addend_is_read_late() {
        assert_cost(&[VADD_S0_S1_S2, VFMA_S0_S4_S2], 4, 0);
    }

    #[test]
    fn neighbouring_single_accesses_may_be_pipelined() {
        let cost = straight(&[LDR_R0, LDR_R0, LDR_R0]);
        assert_eq!((cost.cycles_low, cost.cycles_high), (4, 6));
    }

    #[test]
    fn a_branch_taken_refills_the_pipeline() {
        let b = Instruction::decode(0xe7fe, 0).unwrap_or_else(|| panic!("no row for b"));
        assert_eq!(Pipeline::new(Core::M3).execute(b, true).cycles_high, 3);
    }
}
