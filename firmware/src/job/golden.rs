//! The golden bits, computed on this machine.

use core::fmt::{self, Write};

use double_pendulum::Method;
use double_pendulum::golden::{HEADER, Line, MOTIONS};

use super::table::{GoldenBits, visit};

/// Writes the contents of the kernel's file `golden/bits.csv`, computed on this machine. If a
/// method refuses a motion, the error in words takes the place of the bits.
pub fn write_golden(output: &mut impl Write) -> fmt::Result {
    writeln!(output, "{HEADER}")?;
    for &method in Method::ALL {
        for motion in &MOTIONS {
            match visit(method, GoldenBits(motion)) {
                Ok(bits) => writeln!(output, "{}", Line(method, motion, bits))?,
                Err(error) => writeln!(output, "{method},{},{error}", motion.name)?,
            }
        }
    }
    Ok(())
}
