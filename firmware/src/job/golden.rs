//! The golden bits, computed on this machine.

use core::fmt::{self, Write};

use double_pendulum::Method;
use double_pendulum::golden::{HEADER, Line, MOTIONS};

use super::table::{GoldenBits, visit};

/// Writes the contents of the kernel's file `golden/bits.csv`, computed on this machine, to
/// `output`; the file itself is neither read nor changed. They are the line [`HEADER`], and a line
/// for each motion of [`MOTIONS`] by each method of [`Method::ALL`], the motions of a method next
/// to each other. Every line ends with a line feed.
///
/// If a method refuses a motion, or the motion diverges, the error in words takes the place of the
/// bits. Only errors of `output` are returned, the first one at once; then only a part is written.
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
