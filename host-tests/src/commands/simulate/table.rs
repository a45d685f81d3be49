//! The rows of the CSV, and the table of methods.

use std::fmt::{Display, LowerExp};

use double_pendulum::{Method, Numbers, Parameters, Pendulum};
use firmware::job::{ON_BOARDS, Reading};

use super::{Plan, SimulateOptions};

/// Name, unit, and the number in a row.
pub type Column = (&'static str, &'static str, fn(&Sampled) -> f64);

pub struct Sampled<'a> {
    time: f64,
    reading: &'a Reading,
    parameters: Parameters<f64>,
}

/// Every column there is; x to the right and y upwards from the pivot.
pub const COLUMNS: [Column; 12] = [
    ("t", "s", |row| row.time),
    ("a1", "rad", |row| row.reading.state[0]),
    ("a2", "rad", |row| row.reading.state[1]),
    ("p1", "kg m^2/s", |row| row.reading.state[2]),
    ("p2", "kg m^2/s", |row| row.reading.state[3]),
    ("w1", "rad/s", |row| row.reading.velocities[0]),
    ("w2", "rad/s", |row| row.reading.velocities[1]),
    ("energy", "J", |row| row.reading.energy),
    ("x1", "m", |row| row.bobs()[0][0]),
    ("y1", "m", |row| row.bobs()[0][1]),
    ("x2", "m", |row| row.bobs()[1][0]),
    ("y2", "m", |row| row.bobs()[1][1]),
];

impl Sampled<'_> {
    fn bobs(&self) -> [[f64; 2]; 2] {
        let [a1, a2, ..] = self.reading.state;
        let bobs = Pendulum::<f64>::new(&self.parameters).map(|pendulum| pendulum.positions([a1, a2]));
        bobs.map_or([[f64::NAN; 2]; 2], |bobs| bobs.map(|bob| [bob.x, bob.y]))
    }
}

pub fn header(options: &SimulateOptions) -> String {
    let named = |(name, unit, _): &Column| if options.units { format!("{name} [{unit}]") } else { (*name).to_owned() };
    let bits = ["a1_bits", "a2_bits", "p1_bits", "p2_bits"].into_iter().filter(|_| options.bits);
    options.columns.iter().map(named).chain(bits.map(str::to_owned)).collect::<Vec<_>>().join(",")
}

pub fn row(plan: &Plan, options: &SimulateOptions, number: u64, reading: &Reading) -> String {
    // whether numbers have the digits of an f32
    let is_single = plan.request.method.numbers() == Numbers::F32;
    let row = Sampled { time: plan.every.times(number), reading, parameters: plan.request.parameters };
    let numbers = options.columns.iter().map(|(name, _, number)| match number(&row) {
        number if is_single && *name != "t" => shortest(number as f32),
        number => shortest(number),
    });
    let bits = reading.state.iter().filter(|_| options.bits).map(|&number| match is_single {
        true => format!("{:08x}", (number as f32).to_bits()),
        false => format!("{:016x}", number.to_bits()),
    });
    numbers.chain(bits).collect::<Vec<_>>().join(",")
}

/// The fewest digits that read back as the same number; in exponent form where that is shorter.
fn shortest(number: impl Display + LowerExp) -> String {
    let (plain, exponent) = (number.to_string(), format!("{number:e}"));
    if exponent.len() < plain.len() { exponent } else { plain }
}

/// A line for each method: name, equations, numbers, integrator, order, and where it runs.
pub fn methods() -> String {
    let line = |[method, equations, numbers, integrator, order, places]: [&str; 6]| {
        format!("{method:24} {equations:11} {numbers:15} {integrator:14} {order:>5}  {places}")
    };
    let mut lines = vec![line(["method", "equations", "numbers", "integrator", "order", "runs on"])];
    for method in Method::ALL {
        let (equations, numbers) = (method.equations().to_string(), method.numbers().to_string());
        let (integrator, order) = (method.integrator().to_string(), method.order().to_string());
        let boards = if ON_BOARDS.contains(method) { ", boards" } else { "" };
        let scenes = if Method::DRAWN.contains(method) { ", scenes" } else { "" };
        lines.push(line([method.name(), &equations, &numbers, &integrator, &order, &format!("host{boards}{scenes}")]));
    }
    lines.join("\n")
}
