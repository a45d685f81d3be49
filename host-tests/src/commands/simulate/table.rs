//! The rows of the CSV.

use std::io::{self, Write};

use double_pendulum::{Method, Numbers};
use firmware::job::Reading;

use super::Number;

/// Writes readings as CSV, one row each, from t = 0.
pub struct Table<W> {
    output: W,
    /// Whether numbers have the digits of an `f32`.
    single: bool,
    every: Number,
    bits: bool,
    rows: u64,
}

impl<W: Write> Table<W> {
    /// A table whose row n is at n times `every`; `bits` adds the bit patterns of the state. Nothing is written yet.
    pub fn new(output: W, method: Method, every: Number, bits: bool) -> Self {
        let single = method.numbers() == Numbers::F32;
        Self { output, single, every, bits, rows: 0 }
    }

    /// Writes the next row, and the header before the first.
    pub fn row(&mut self, reading: &Reading) -> io::Result<()> {
        if self.rows == 0 {
            let bits = if self.bits { ",a1_bits,a2_bits,p1_bits,p2_bits" } else { "" };
            writeln!(self.output, "t,a1,a2,p1,p2,w1,w2,energy{bits}")?;
        }
        let numbers = reading.state.iter().chain(&reading.velocities).chain([&reading.energy]);
        write!(self.output, "{}", shortest_f64(self.every.times(self.rows)))?;
        for &number in numbers {
            write!(self.output, ",{}", self.shortest(number))?;
        }
        if self.bits {
            for &number in &reading.state {
                write!(self.output, ",{}", self.pattern(number))?;
            }
        }
        writeln!(self.output)?;
        self.rows += 1;
        Ok(())
    }

    /// How many rows there are.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Ends the table.
    pub fn finish(mut self) -> io::Result<()> {
        self.output.flush()
    }

    fn shortest(&self, number: f64) -> String {
        if self.single {
            shorter(format!("{}", number as f32), format!("{:e}", number as f32))
        } else {
            shortest_f64(number)
        }
    }

    fn pattern(&self, number: f64) -> String {
        if self.single { format!("{:08x}", (number as f32).to_bits()) } else { format!("{:016x}", number.to_bits()) }
    }
}

/// The fewest digits that read back as the same number; in exponent form where that is shorter.
fn shortest_f64(number: f64) -> String {
    shorter(format!("{number}"), format!("{number:e}"))
}

fn shorter(plain: String, exponent: String) -> String {
    if exponent.len() < plain.len() { exponent } else { plain }
}
