//! Every method of the boards: its motions, computed by the board, beside the host's own; and the cycles of a step, measured by the
//! board, beside the estimate of `cargo count`.

use anyhow::ensure;
use double_pendulum::{Method, Parameters};
use firmware::config::{GRAVITY, MOST_MEASURED_STEPS};
use firmware::job::{ON_BOARDS, Reading, Request};
use firmware::protocol::{Answer, Command};

use super::Section;
use super::talk::Talk;
use crate::commands::count::{FULL_CYCLE, Target, affordable_cost};
use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::toolchain;

/// From rest: a name, the mass of bob 2, kg (bob 1 has 1 kg, the rods are 1 m long), and both angles, rad. The first is the
/// one that costs are measured in.
const MOTIONS: [(&str, f64, f64); 2] = [("regular", 1.0, 0.5), ("chaotic", 2.75, 2.98)];

/// A motion as a request of the board: 2 s in steps of 1/256 s. A chaotic one has by then made thousands of one wrong bit.
fn request(method: Method, (_, m2, angle): (&str, f64, f64)) -> Request {
    let parameters = Parameters { m1: 1.0, m2, l1: 1.0, l2: 1.0, g: GRAVITY };
    let (angles, velocities) = ([angle; 2], [0.0; 2]);
    Request { method, parameters, angles, velocities, dt: 1.0 / 256.0, stride: 32, samples: 16 }
}

/// Every method of the boards, in both motions.
pub fn compare(talk: &mut Talk) -> anyhow::Result<Section> {
    let note = "Motions from rest in steps of 1/256 s, computed by the board on request.";
    let mut section = Section::new("Bits", note, &["method", "motion", "steps", "bits"]);
    let all = ON_BOARDS.iter().flat_map(|&method| MOTIONS.map(|motion| (method, motion)));
    for (number, (method, motion)) in (0..).zip(all) {
        let request = request(method, motion);
        let difference = difference(talk, &request, number)?;
        let steps = (request.stride * request.samples).to_string();
        let verdict = difference.clone().unwrap_or_else(|| "the host's".to_owned());
        section.table.rows.push(vec![method.to_string(), motion.0.into(), steps, verdict]);
        section.faults.extend(difference.map(|difference| format!("{method}, {}: {difference}", motion.0)));
    }
    Ok(section)
}

/// The first number of the board's that is not the host's.
fn difference(talk: &mut Talk, request: &Request, number: u16) -> anyhow::Result<Option<String>> {
    const NAMES: [&str; 7] = ["a1", "a2", "p1", "p2", "w1", "w2", "energy"];
    let bits = |&Reading { state: [a1, a2, p1, p2], velocities: [w1, w2], energy }: &Reading| {
        [a1, a2, p1, p2, w1, w2, energy].map(f64::to_bits)
    };
    talk.port.send(number, Command::Simulate(*request));
    let (mut difference, mut index) = (None, 0);
    request.readings::<anyhow::Error>(|reading| {
        let (given, sample) = sample(talk, number)?;
        ensure!(given == index, "sample {index} was lost on the way");
        let (board, host) = (bits(&sample), bits(reading));
        let differs = NAMES.iter().zip(board.iter().zip(&host)).find(|(_, (board, host))| board != host);
        if let Some((name, (board, host))) = differs {
            let step = index * request.stride;
            difference.get_or_insert(format!("step {step}: {name} is {board:#018x}, the host's {host:#018x}"));
        }
        index += 1;
        Ok(())
    })?;
    Ok(difference)
}

/// The next of the samples that were asked for by this number.
fn sample(talk: &mut Talk, number: u16) -> anyhow::Result<(u32, Reading)> {
    talk.answer(number, |answer| match answer {
        Answer::Sample { index, reading } => Some((index, reading)),
        _ => None,
    })
}

const REQUEST: u16 = u16::MAX;

/// A method with the cycles of its step from flash and from RAM; `None` where the board counts none, or has no copy in RAM.
type Cycles = (Method, [Option<f64>; 2]);

/// Measures a step of every method, as `cargo count` counts it: on average over the first second from rest.
pub fn measure(talk: &mut Talk) -> anyhow::Result<Vec<Cycles>> {
    let row = |&method: &Method| Ok((method, [step(talk, method, false)?, step(talk, method, true)?]));
    ON_BOARDS.iter().map(row).collect()
}

fn step(talk: &mut Talk, method: Method, in_ram: bool) -> anyhow::Result<Option<f64>> {
    talk.port.send(REQUEST, Command::Simulate(Request { samples: 0, ..request(method, MOTIONS[0]) }));
    sample(talk, REQUEST)?;
    let (mut steps, mut cycles) = (0, 0.0);
    while steps < FULL_CYCLE {
        let (made, taken) =
            talk.ask(Command::Measure { steps: MOST_MEASURED_STEPS, in_ram }, |answer| match answer {
                Answer::Measured { steps, cycles } => Some((steps, cycles)),
                _ => None,
            })?;
        if taken == 0 || made == 0 {
            return Ok(None);
        }
        steps += made;
        cycles += f64::from(taken);
    }
    Ok(Some(cycles / f64::from(steps)))
}

/// Estimates what has been measured. Instructions are counted in QEMU, on a board with the same processor.
pub fn estimate(measured: Vec<Cycles>, board: Option<&Board>) -> anyhow::Result<Section> {
    let note = "Measured by the processor's cycle counter, interrupts off, over 256 steps of the regular motion, by the code in \
                flash and, where there is one, by its copy in RAM (constants are read from flash by both); estimated for memory \
                without wait states, over as many steps or, of the expensive ones, fewer.";
    let mut section = Section::new("Cycles of a step", note, &["method", "from flash", "from RAM", "estimated"]);
    let board = board.and_then(|board| BOARDS.iter().find(|counted| counted.target == board.target));
    let is_counted = measured.iter().any(|(_, [flash, _])| flash.is_some());
    let target = board.filter(|_| is_counted).map(|board| Target::build(&toolchain::ready()?, board)).transpose()?;
    for (method, [flash, ram]) in measured {
        let target = target.as_ref().filter(|_| flash.is_some());
        let estimated = target.map(|target| affordable_cost(target, &request(method, MOTIONS[0]))).transpose()?;
        let cell = |cycles: Option<f64>, none: &str| cycles.map_or(none.to_owned(), |cycles| format!("{cycles:.1}"));
        let none = "no cycle counter";
        let (ram, estimated) = (cell(ram, flash.map_or(none, |_| "-")), cell(estimated.map(|cost| cost.cycles), "-"));
        section.table.rows.push(vec![method.to_string(), cell(flash, none), ram, estimated]);
    }
    Ok(section)
}
