//! The motions of every method, computed by the board, beside the host's own.

use double_pendulum::{Method, Parameters};
use firmware::config::GRAVITY;
use firmware::job::{JobError, ON_BOARDS, Reading, Request};
use firmware::protocol::Sample;
use serde::Serialize;

use super::talk::Talk;

/// Steps of 1/256 s, 2 s of them: a chaotic motion has by then made of one wrong bit thousands.
const DT: f64 = 1.0 / 256.0;
const STRIDE: u32 = 32;
const SAMPLES: u32 = 16;

/// A motion from rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    name: &'static str,
    /// Mass of bob 2, kg; bob 1 has 1 kg, the rods are 1 m long.
    m2: f64,
    /// rad.
    angle: f64,
}

/// The one that costs are measured in.
pub const REGULAR: Motion = Motion { name: "regular", m2: 1.0, angle: 0.5 };
const MOTIONS: [Motion; 2] = [REGULAR, Motion { name: "chaotic", m2: 2.75, angle: 2.98 }];

impl Motion {
    /// As a request of the board, by `method`.
    pub fn request(&self, method: Method) -> Request {
        Request {
            method,
            parameters: Parameters { m1: 1.0, m2: self.m2, l1: 1.0, l2: 1.0, g: GRAVITY },
            angles: [self.angle; 2],
            velocities: [0.0; 2],
            dt: DT,
            stride: STRIDE,
            samples: SAMPLES,
        }
    }
}

/// What became of one motion.
#[derive(Clone, Debug, Serialize)]
pub struct Bits {
    /// The method.
    pub method: String,
    /// The motion.
    pub motion: &'static str,
    /// How many steps.
    pub steps: u32,
    /// The first number that differs.
    pub difference: Option<String>,
}

/// Every method of the boards, in every motion that it accepts.
pub fn check(talk: &mut Talk) -> anyhow::Result<Vec<Bits>> {
    let all = ON_BOARDS.iter().flat_map(|&method| MOTIONS.map(|motion| (method, motion)));
    let mut checked = Vec::new();
    for (number, (method, motion)) in all.enumerate() {
        let request = motion.request(method);
        let mut readings = Vec::new();
        let accepted = request.readings(|reading| {
            readings.push(*reading);
            Ok::<_, JobError>(())
        });
        if accepted.is_ok() {
            let difference = compare(talk, &request, number as u16, &readings)?;
            let (method, motion) = (method.to_string(), motion.name);
            checked.push(Bits { method, motion, steps: STRIDE * SAMPLES, difference });
        }
    }
    Ok(checked)
}

/// The first number of the board's that is not the host's.
fn compare(talk: &mut Talk, request: &Request, number: u16, readings: &[Reading]) -> anyhow::Result<Option<String>> {
    talk.port.send(&request.message(number));
    let mut difference = None;
    for (index, reading) in (0..).zip(readings) {
        let sample = next(talk, number)?;
        let numbers = |state: [f64; 4], velocities: [f64; 2], energy| {
            let [a1, a2, p1, p2] = state;
            let [w1, w2] = velocities;
            [("a1", a1), ("a2", a2), ("p1", p1), ("p2", p2), ("w1", w1), ("w2", w2), ("energy", energy)]
        };
        anyhow::ensure!(sample.index == index, "sample {index} was lost on the way");
        let board = numbers(sample.state, sample.velocities, sample.energy);
        let host = numbers(reading.state, reading.velocities, reading.energy);
        let differs = board.into_iter().zip(host).find(|((_, board), (_, host))| board.to_bits() != host.to_bits());
        if let Some(((name, board), (_, host))) = differs {
            let step = index * request.stride;
            let told = format!("step {step}: {name} is {:#018x}, the host's {:#018x}", board.to_bits(), host.to_bits());
            difference.get_or_insert(told);
        }
    }
    Ok(difference)
}

/// The next sample of this request.
pub fn next(talk: &mut Talk, number: u16) -> anyhow::Result<Sample> {
    loop {
        let sample: Sample = talk.next()?;
        if sample.request == number {
            return Ok(sample);
        }
    }
}
