//! The rows of the CSV.

use std::io::{self, Write};

use double_pendulum::{Numbers, Parameters, Pendulum};
use firmware::job::Reading;

use super::{Number, Plan, SimulateOptions};

/// A column: its name, its unit, and its number in a row.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    pub name: &'static str,
    unit: &'static str,
    number: fn(&Row) -> f64,
}

struct Row<'a> {
    time: f64,
    reading: &'a Reading,
    parameters: Parameters<f64>,
}

const fn column(name: &'static str, unit: &'static str, number: fn(&Row) -> f64) -> Column {
    Column { name, unit, number }
}

/// Every column there is; x to the right and y upwards from the pivot.
pub const COLUMNS: [Column; 12] = [
    column("t", "s", |row| row.time),
    column("a1", "rad", |row| row.reading.state[0]),
    column("a2", "rad", |row| row.reading.state[1]),
    column("p1", "kg m^2/s", |row| row.reading.state[2]),
    column("p2", "kg m^2/s", |row| row.reading.state[3]),
    column("w1", "rad/s", |row| row.reading.velocities[0]),
    column("w2", "rad/s", |row| row.reading.velocities[1]),
    column("energy", "J", |row| row.reading.energy),
    column("x1", "m", |row| row.bobs()[0][0]),
    column("y1", "m", |row| row.bobs()[0][1]),
    column("x2", "m", |row| row.bobs()[1][0]),
    column("y2", "m", |row| row.bobs()[1][1]),
];

impl Row<'_> {
    fn bobs(&self) -> [[f64; 2]; 2] {
        let [a1, a2, ..] = self.reading.state;
        let bobs = Pendulum::<f64>::new(&self.parameters).map(|pendulum| pendulum.positions([a1, a2]));
        bobs.map_or([[f64::NAN; 2]; 2], |bobs| bobs.map(|bob| [bob.x, bob.y]))
    }
}

/// Writes readings as CSV, one row each, from t = 0.
pub struct CsvRows<'a, W> {
    output: W,
    options: &'a SimulateOptions,
    parameters: Parameters<f64>,
    /// Whether numbers have the digits of an `f32`.
    single: bool,
    every: Number,
    rows: u64,
}

impl<'a, W: Write> CsvRows<'a, W> {
    /// The rows of `plan`, with the columns of `options`. Nothing is written yet.
    pub fn new(output: W, plan: &Plan, options: &'a SimulateOptions) -> Self {
        let single = plan.request.method.numbers() == Numbers::F32;
        Self { output, options, parameters: plan.request.parameters, single, every: plan.every.clone(), rows: 0 }
    }

    /// Writes the next row, and the header before the first.
    pub fn row(&mut self, reading: &Reading) -> io::Result<()> {
        if self.rows == 0 {
            self.header()?;
        }
        let row = Row { time: self.every.times(self.rows), reading, parameters: self.parameters };
        let numbers = self.options.columns.iter().map(|Column { name, number, .. }| match (number(&row), *name) {
            (time, "t") => shortest(time, time),
            (number, _) if self.single => shortest(number as f32, number as f32),
            (number, _) => shortest(number, number),
        });
        let bits = reading.state.iter().filter(|_| self.options.bits).map(|&number| match self.single {
            true => format!("{:08x}", (number as f32).to_bits()),
            false => format!("{:016x}", number.to_bits()),
        });
        let cells: Vec<_> = numbers.chain(bits).collect();
        writeln!(self.output, "{}", cells.join(","))?;
        self.rows += 1;
        Ok(())
    }

    fn header(&mut self) -> io::Result<()> {
        let columns = self.options.columns.iter().map(|Column { name, unit, .. }| match self.options.units {
            true => format!("{name} [{unit}]"),
            false => (*name).to_owned(),
        });
        let bits = ["a1_bits", "a2_bits", "p1_bits", "p2_bits"].into_iter().filter(|_| self.options.bits);
        let cells: Vec<_> = columns.chain(bits.map(str::to_owned)).collect();
        writeln!(self.output, "{}", cells.join(","))
    }

    pub fn rows(&self) -> u64 {
        self.rows
    }

    pub fn finish(mut self) -> io::Result<()> {
        self.output.flush()
    }
}

/// The fewest digits that read back as the same number; in exponent form where that is shorter.
fn shortest(plain: impl std::fmt::Display, exponent: impl std::fmt::LowerExp) -> String {
    let (plain, exponent) = (plain.to_string(), format!("{exponent:e}"));
    if exponent.len() < plain.len() { exponent } else { plain }
}
