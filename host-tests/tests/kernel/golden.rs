//! The methods of the table compute the bits that are stored in the kernel's `golden/bits.csv`,
//! including the methods of the firmware.

use crate::snapshot;
use firmware::job::write_golden;

/// Any bit that differs from the file fails. The test updates the file instead if `BLESS=1` is set.
#[test]
fn every_method_computes_the_golden_bits() -> Result<(), String> {
    let mut lines = String::new();
    write_golden(&mut lines).map_err(|error| error.to_string())?;
    snapshot::check_lines("kernel/golden/bits.csv", &lines)
}
