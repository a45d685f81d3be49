//! The motions of every method, computed by the board, beside the host's own.

use double_pendulum::{Method, Parameters};
use firmware::config::GRAVITY;
use firmware::job::{JobError, ON_BOARDS, Reading, Request};
use firmware::protocol::Sample;

use super::Section;
use super::talk::Talk;
use crate::commands::table::Table;

/// From rest: a name, the mass of bob 2, kg (bob 1 has 1 kg, the rods are 1 m long), and both angles, rad. The first is the
/// one that costs are measured in.
const MOTIONS: [(&str, f64, f64); 2] = [("regular", 1.0, 0.5), ("chaotic", 2.75, 2.98)];

/// A motion as a request of the board: 2 s in steps of 1/256 s. A chaotic one has by then made thousands of one wrong bit.
fn request(method: Method, (_, m2, angle): (&str, f64, f64)) -> Request {
    Request {
        method,
        parameters: Parameters { m1: 1.0, m2, l1: 1.0, l2: 1.0, g: GRAVITY },
        angles: [angle; 2],
        velocities: [0.0; 2],
        dt: 1.0 / 256.0,
        stride: 32,
        samples: 16,
    }
}

/// The motion that costs are measured in.
pub fn regular(method: Method) -> Request {
    request(method, MOTIONS[0])
}

/// Every method of the boards, in every motion that it accepts.
pub fn check(talk: &mut Talk) -> anyhow::Result<Section> {
    let (mut rows, mut faults) = (Vec::new(), Vec::new());
    let all = ON_BOARDS.iter().flat_map(|&method| MOTIONS.map(|motion| (method, motion)));
    for (number, (method, motion)) in (0..).zip(all) {
        let (request, mut readings) = (request(method, motion), Vec::new());
        let accepted = request.readings(|reading| {
            readings.push(*reading);
            Ok::<_, JobError>(())
        });
        if accepted.is_err() {
            continue;
        }
        let difference = compare(talk, &request, number, &readings)?;
        let steps = (request.stride * request.samples).to_string();
        rows.push(vec![method.to_string(), motion.0.into(), steps, verdict(difference.as_deref())]);
        faults.extend(difference.map(|difference| format!("{method}, {}: {difference}", motion.0)));
    }
    let note = "Motions from rest in steps of 1/256 s, computed by the board on request.".into();
    Ok(Section { table: Table { title: "Bits", note, columns: &["method", "motion", "steps", "bits"], rows }, faults })
}

/// The first number that differs, or that all are the host's.
pub fn verdict(difference: Option<&str>) -> String {
    difference.unwrap_or("the host's").to_owned()
}

/// The first number of the board's that is not the host's.
fn compare(talk: &mut Talk, request: &Request, number: u16, readings: &[Reading]) -> anyhow::Result<Option<String>> {
    const NAMES: [&str; 7] = ["a1", "a2", "p1", "p2", "w1", "w2", "energy"];
    let bits = |[a1, a2, p1, p2]: [f64; 4], [w1, w2]: [f64; 2], energy: f64| {
        [a1, a2, p1, p2, w1, w2, energy].map(f64::to_bits)
    };
    talk.port.send(&request.message(number));
    let mut difference = None;
    for (index, reading) in (0..).zip(readings) {
        let sample = next(talk, number)?;
        anyhow::ensure!(sample.index == index, "sample {index} was lost on the way");
        let board = bits(sample.state, sample.velocities, sample.energy);
        let host = bits(reading.state, reading.velocities, reading.energy);
        let differs = NAMES.iter().zip(board.iter().zip(&host)).find(|(_, (board, host))| board != host);
        if let Some((name, (board, host))) = differs {
            let step = index * request.stride;
            difference.get_or_insert(format!("step {step}: {name} is {board:#018x}, the host's {host:#018x}"));
        }
    }
    Ok(difference)
}

pub fn next(talk: &mut Talk, number: u16) -> anyhow::Result<Sample> {
    loop {
        let sample: Sample = talk.next()?;
        if sample.request == number {
            return Ok(sample);
        }
    }
}
