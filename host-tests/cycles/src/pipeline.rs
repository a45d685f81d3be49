//! The estimate of cycles: published instruction timings, and the effects of neighbouring
//! instructions on each other.
//!
//! The rules, each with its source:
//!
//! - A load after a load takes 1 cycle, unless the first one loads its address. Source: DDI 0337,
//!   "Load/store timings"; 200 loads in 201 cycles, in 400 if each address is the load before.
//! - A store with an immediate offset takes 1 cycle, and 1 more if a load follows. With an offset
//!   in a register it takes 2. After a load it fills the load's second cycle (the manual's example
//!   counts a cycle more). The same is assumed for vldr and vstr, because no count was found.
//!   Source: DDI 0337, there; jnk0le/random, measured on an STM32F103 and an STM32F407.
//! - A taken branch refills the pipeline in 1 cycle, a branch to an address from a register or the
//!   stack in 2. A 32-bit instruction off a word's boundary begins 1 cycle later, because it takes
//!   two fetches. Source: DDI 0337, table of instructions: 1 to 3 by "the alignment and width of
//!   the target instruction"; compendium.i-0.nl, "Alignment rules".
//! - An `it` after a 16-bit instruction takes no time. Source: both manuals: "can be folded".
//! - An address register that is written by the previous instruction costs 1 cycle. Source: DDI
//!   0337, "Load/store timings"; jnk0le/random.
//! - On the M3 a long product takes 5 cycles, with accumulation 7. A division takes 2 to 12,
//!   depending on the lengths of its operands. Source: `timing`; compendium.i-0.nl, "Division
//!   timing".
//! - A floating-point quotient or root takes 14 cycles of the unit and 1 cycle of the core. Source:
//!   DDI 0439, notes of table 7-1.
//! - A move of one register to or from the floating-point unit takes 1 cycle. Source: DDI 0439,
//!   table 7-1.
//! - A floating-point result is ready 1 cycle later for the very next instruction. Source: DDI
//!   0439, there; 200 dependent sums in 401 cycles, 200 independent ones in 201 on an STM32F429.
//! - On the M0+ no instruction waits for its neighbours. A taken branch refills the pipeline in 1
//!   cycle, a pop of pc in 2. Source: DDI 0484C, table 3-1; the RP2040's own delay loop of `subs`
//!   and `bcs`, "3 cycles per loop" (pico-sdk, `busy_wait_at_least_cycles`).
//! - On the M3, an instruction that writes a new address to its address register (pre- and
//!   post-indexed) is not pipelined after a load. Source: jnk0le/random.
//!
//! The rules do not cover memory with wait states, tables in the flash that code is fetched from,
//! accesses that are not aligned, and the entry of an interrupt. They do not cover several 32-bit
//! instructions in a row off a word's boundary, which "might not pipeline optimally" (DDI 0439). An
//! instruction whose condition fails counts as if it were executed. No counts of chips were found
//! for vmul, vsqrt, vfma, vldm, and for vldr and vstr in a row.
//!
//! [`ERROR_BAR`] compares these rules with 76 published kernels, which are short routines of other
//! projects and not in this repository. The authors of the kernels measured them on chips at zero
//! wait states. A negative error is an estimate that is too low. On an STM32F407 with tables in
//! flash, the error is -2.0 to -0.5 %. On an STM32L100 it is -2.8 % at worst. An STM32L4R5 takes 3
//! to 5 % more than an STM32F407 for the same code, and no rule here explains it.
//!
//! The 76 kernels do not include dilithium-cortexm on an ATSAM3X8E (3 figures, -9.2 to -2.7 %). The
//! bus matrix of that chip delays the first load of each group by a cycle; with that cycle the
//! figures are within 0.2 %.

use std::ops::AddAssign;

use crate::Core;
use crate::instruction::Instruction;
use crate::row::Class;
use crate::stream::Registers;
use crate::timing::{DIRECT_REFILL, INDIRECT_REFILL, RESULT_USE_STALL, UNALIGNED_TARGET};

/// The accuracy statement that is printed with every table of cycles: one line without a newline.
pub const ERROR_BAR: &str = "\
    Cycles are estimated: 1.6 % off (root mean square) and at most 5.0 % for 76 published kernels, \
    3 to 5 % too low on an STM32L4R5, no data for the M0+; \
    floating-point timing checked for VADD, VDIV and moves only; \
    wait states cost extra (34 % at 2 on an STM32F1 for one AES).";

/// The cost of executed code: an exact number of instructions and an estimated number of cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// An instruction whose condition fails counts as well.
    pub instructions: u64,
    pub cycles: u64,
    /// The cycles that wait for the floating-point unit or its results.
    pub stalls: u64,
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.instructions += other.instructions;
        self.cycles += other.cycles;
        self.stalls += other.stalls;
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Pipeline {
    core: Core,
    previous: Option<Instruction>,
    branched: bool,
    now: u64,
    unit_free: u64,
    /// The register with the last floating-point result, and the first cycle that can consume it.
    result: Option<(u32, u64)>,
}

impl Pipeline {
    pub fn new(core: Core) -> Self {
        Self {
            core,
            previous: None,
            branched: false,
            now: 0,
            unit_free: 0,
            result: None,
        }
    }

    /// Executes the next instruction. `branches` is true if the instruction after it is not the
    /// next one in memory.
    pub fn execute(
        &mut self,
        instruction: Instruction,
        registers: &Registers,
        branches: bool,
    ) -> Cost {
        let start = self.now;
        let stalls = self.start_of_float(&instruction) - start;
        let own = instruction.cycles(self.core, registers);

        let taken = match instruction.row.class {
            Class::IfThen if self.previous.is_some_and(|previous| previous.size() == 2) => 0,
            Class::Aside(_) => 1,
            _ => own,
        };
        let refill = match instruction.row.class {
            _ if !branches => 0,
            Class::LoadList => INDIRECT_REFILL,
            Class::Branch => DIRECT_REFILL,
            _ if self.core == Core::M0Plus => DIRECT_REFILL,
            _ => INDIRECT_REFILL,
        };

        let is_split = instruction.size() == 4 && registers.pc() % 4 == 2;
        let fetch = if self.branched && is_split && self.core != Core::M0Plus {
            UNALIGNED_TARGET
        } else {
            0
        };
        let (waits, saved) = self
            .previous
            .map_or((0, 0), |previous| self.neighbours(&previous, &instruction));

        if let Some(register) = instruction.late_result() {
            self.unit_free = start + stalls + own;
            self.result = Some((register, self.unit_free + RESULT_USE_STALL));
        }
        self.previous = Some(instruction);
        self.branched = branches;
        let cycles = fetch + stalls + waits + taken - saved + refill;
        self.now += cycles;
        Cost {
            instructions: 1,
            cycles,
            stalls,
        }
    }

    fn start_of_float(&self, instruction: &Instruction) -> u64 {
        let unit = if instruction.is_float() {
            self.unit_free
        } else {
            0
        };
        let result = self
            .result
            .filter(|(register, _)| instruction.consumes(*register))
            .map_or(0, |(_, ready)| ready);
        self.now.max(unit).max(result)
    }

    /// Returns the cycles that `instruction` waits for `previous`, and the cycles that it saves by
    /// following it.
    fn neighbours(&self, previous: &Instruction, instruction: &Instruction) -> (u64, u64) {
        if self.core == Core::M0Plus {
            return (0, 0);
        }
        let depends = instruction.is_addressed_by(previous);
        match (previous.row.class, instruction.row.class) {
            (Class::Load, Class::Load | Class::Store) if !depends => {
                let blocked = self.core == Core::M3 && instruction.row.updates_base();
                (0, u64::from(!blocked))
            }
            (Class::Load, _) => (0, 0),
            (Class::Store, _) => {
                let is_fast = previous.row.cycles(self.core) == 1;
                (
                    u64::from(depends) + u64::from(is_fast && instruction.loads()),
                    0,
                )
            }
            _ => (u64::from(depends), 0),
        }
    }
}
