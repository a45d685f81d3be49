//! Every method of the table computes the bits that the kernel's `golden/bits.csv` keeps, those of
//! the firmware's own too.

use firmware::job::write_golden;
use host_tests::oracle::snapshot;

/// With `BLESS=1` this renews the file. A test of the kernel then wants an entry in its list of
/// changes.
#[test]
fn every_method_computes_the_golden_bits() -> Result<(), String> {
    let mut lines = String::new();
    write_golden(&mut lines).map_err(|error| error.to_string())?;
    snapshot::check_lines("kernel/golden/bits.csv", &lines)
}
