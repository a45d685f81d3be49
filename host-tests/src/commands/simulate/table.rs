//! The rows of the CSV.

use double_pendulum::{Numbers, Parameters, Pendulum};
use firmware::job::Reading;

use super::{Plan, SimulateOptions};

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

/// The first line: what the columns are.
pub fn header(options: &SimulateOptions) -> String {
    let columns = options.columns.iter().map(|Column { name, unit, .. }| match options.units {
        true => format!("{name} [{unit}]"),
        false => (*name).to_owned(),
    });
    let bits = ["a1_bits", "a2_bits", "p1_bits", "p2_bits"].into_iter().filter(|_| options.bits);
    columns.chain(bits.map(str::to_owned)).collect::<Vec<_>>().join(",")
}

/// Row `number`, from 0.
pub fn row(plan: &Plan, options: &SimulateOptions, number: u64, reading: &Reading) -> String {
    // whether numbers have the digits of an f32
    let is_single = plan.request.method.numbers() == Numbers::F32;
    let row = Row { time: plan.every.times(number), reading, parameters: plan.request.parameters };
    let numbers = options.columns.iter().map(|Column { name, number, .. }| match (number(&row), *name) {
        (time, "t") => shortest(time, time),
        (number, _) if is_single => shortest(number as f32, number as f32),
        (number, _) => shortest(number, number),
    });
    let bits = reading.state.iter().filter(|_| options.bits).map(|&number| match is_single {
        true => format!("{:08x}", (number as f32).to_bits()),
        false => format!("{:016x}", number.to_bits()),
    });
    numbers.chain(bits).collect::<Vec<_>>().join(",")
}

/// The fewest digits that read back as the same number; in exponent form where that is shorter.
fn shortest(plain: impl std::fmt::Display, exponent: impl std::fmt::LowerExp) -> String {
    let (plain, exponent) = (plain.to_string(), format!("{exponent:e}"));
    if exponent.len() < plain.len() { exponent } else { plain }
}
