//! Prints the golden bits of every method as this machine computes them. For builds by other
//! compilers: `cargo +1.88 run --package firmware --example golden | diff kernel/golden/bits.csv
//! -`.

use std::io::{self, Write};

fn main() -> io::Result<()> {
    let mut lines = String::new();
    firmware::job::write_golden(&mut lines).map_err(io::Error::other)?;
    io::stdout().write_all(lines.as_bytes())
}
