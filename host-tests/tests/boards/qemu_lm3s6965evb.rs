//! Registers of the emulated LM3S6965, which reports revision A2.

use crate::support::{address, application, on};
use boards::BOARDS;
use boards::qemu::Machine;

/// The register of the voltage regulator, and its value for 2.75 V.
const LDOPCTL: u32 = 0x400f_e034;
const LDO_2_75_V: u8 = 0x1b;

/// The voltage regulator is set to 2.75 V when the application first reads the cycle counter.
#[test]
fn revision_a2_runs_at_2_75_volts_before_the_clock_is_read() -> anyhow::Result<()> {
    let board = &BOARDS[0];
    let mut machine = on(board, Machine::halted)?;
    machine.run_to(address(&application(board), "clock::cycles"))?;
    assert_eq!(machine.read(LDOPCTL..LDOPCTL + 1)?, [LDO_2_75_V]);
    Ok(())
}
