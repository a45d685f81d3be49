//! The comparison of a board's results with the host's results: the motions of every method, and
//! every scene for a second. The times of the scenes are measured, and the cycles of the methods
//! are compared with the estimate of `cargo count`.

use anyhow::ensure;
use double_pendulum::{Method, Parameters};
use firmware::config::{GRAVITY, MOST_MEASURED_STEPS, TICK_RATE};
use firmware::job::{ON_BOARDS, Reading, Request};
use firmware::protocol::{Answer, Command, ToHost};
use firmware::scenes::SceneName;

use super::talk::Talk;
use super::{Section, verdict};
use crate::count::{FULL_CYCLE, Target, affordable_cost};
use boards::console::progress::Progress;
use boards::toolchain;
use boards::{BOARDS, Board};
use demo::comparison::Comparison;

/// The motions from rest: a name, the mass of bob 2, kg (bob 1 has 1 kg, the rods are 1 m long),
/// and both angles, rad. Costs are measured in the first one.
const MOTIONS: [(&str, f64, f64); 2] = [("regular", 1.0, 0.5), ("chaotic", 2.75, 2.98)];

/// In 2 s a chaotic motion turns one wrong bit into thousands.
fn request(method: Method, (_, m2, angle): (&str, f64, f64)) -> Request {
    let parameters = Parameters {
        m1: 1.0,
        m2,
        l1: 1.0,
        l2: 1.0,
        g: GRAVITY,
    };
    let angles = [angle; 2];
    let velocities = [0.0; 2];
    Request {
        method,
        parameters,
        angles,
        velocities,
        dt: 1.0 / 256.0,
        stride: 32,
        samples: 16,
    }
}

/// Compares every method of the boards in a regular and a chaotic motion. The board computes the
/// motions on request.
pub fn methods(talk: &mut Talk) -> anyhow::Result<Section> {
    let note = "Motions from rest in steps of 1/256 s, computed by the board on request.";
    let mut section = Section::new("Bits", note, &["method", "motion", "steps", "bits"]);
    let all = ON_BOARDS
        .iter()
        .flat_map(|&method| MOTIONS.map(|motion| (method, motion)));
    for (number, (method, motion)) in (0..).zip(all) {
        let request = request(method, motion);
        let difference = difference(talk, &request, number)?;
        let steps = (request.stride * request.samples).to_string();
        let fault = difference
            .as_ref()
            .map(|difference| format!("{method}, {}: {difference}", motion.0));
        section.add(
            vec![
                method.to_string(),
                motion.0.into(),
                steps,
                verdict(difference),
            ],
            fault,
        );
    }
    Ok(section)
}

fn difference(talk: &mut Talk, request: &Request, number: u16) -> anyhow::Result<Option<String>> {
    const NAMES: [&str; 7] = ["a1", "a2", "p1", "p2", "w1", "w2", "energy"];
    let bits = |&Reading {
                    state: [a1, a2, p1, p2],
                    velocities: [w1, w2],
                    energy,
                }: &Reading| { [a1, a2, p1, p2, w1, w2, energy].map(f64::to_bits) };

    talk.port.send(number, Command::Simulate(*request));
    let mut difference = None;
    let mut index = 0;
    request.readings::<anyhow::Error>(|reading| {
        let (given, sample) = sample(talk, number)?;
        ensure!(given == index, "sample {index} was lost on the way");
        let board = bits(&sample);

        let host = bits(reading);
        let differs = NAMES
            .iter()
            .zip(board.iter().zip(&host))
            .find(|(_, (board, host))| board != host);
        if let Some((name, (board, host))) = differs {
            let step = index * request.stride;
            difference.get_or_insert(format!(
                "step {step}: {name} is {board:#018x} on the board, {host:#018x} on the host"
            ));
        }
        index += 1;
        Ok(())
    })?;
    Ok(difference)
}

fn sample(talk: &mut Talk, number: u16) -> anyhow::Result<(u32, Reading)> {
    talk.answer(number, |answer| {
        if let Answer::Sample { index, reading } = answer {
            Some((index, reading))
        } else {
            None
        }
    })
}

const REQUEST: u16 = u16::MAX;

/// Measures the average cycles of a step over a second of the regular motion, for each of
/// [`ON_BOARDS`]; `None` without a cycle counter.
pub fn measured(talk: &mut Talk) -> anyhow::Result<Vec<Option<f64>>> {
    ON_BOARDS.iter().map(|&method| step(talk, method)).collect()
}

/// Returns the section of the measured cycles with the estimate of `cargo count`, from an emulated
/// board with the same code.
pub fn cycles(measured: &[Option<f64>], board: Option<&Board>) -> anyhow::Result<Section> {
    let note = "Measured with the processor's cycle counter, interrupts off, over 256 steps of the \
                regular motion. Estimated for memory without wait states, over the same number of \
                steps or, for an expensive method, fewer.";
    let mut section = Section::new(
        "Cycles of a step",
        note,
        &["method", "measured", "estimated"],
    );

    // The counts come from an emulated board with the same code. Without a cycle counter on the
    // real board there is nothing to compare.
    let board =
        board.and_then(|board| BOARDS.iter().find(|counted| counted.target == board.target));
    let board = board.filter(|_| measured.iter().any(Option::is_some));

    let target = board
        .map(|board| Target::build(&toolchain::ready()?, board))
        .transpose()?;

    let bar = Progress::of("estimating cycles, methods", measured.len() as u64);
    for (&method, &cycles) in ON_BOARDS.iter().zip(measured).inspect(|_| bar.advance(1)) {
        let target = target.as_ref().filter(|_| cycles.is_some());
        let estimated = target
            .map(|target| affordable_cost(target, &request(method, MOTIONS[0])))
            .transpose()?;
        let cell = |cycles: Option<f64>, none: &str| {
            cycles.map_or(none.to_owned(), |cycles| format!("{cycles:.1}"))
        };

        let cycles = cell(cycles, "no cycle counter");
        let estimated = cell(estimated.map(|cost| cost.cycles), "-");
        section.add(vec![method.to_string(), cycles, estimated], None);
    }

    Ok(section)
}

fn step(talk: &mut Talk, method: Method) -> anyhow::Result<Option<f64>> {
    talk.port.send(
        REQUEST,
        Command::Simulate(Request {
            samples: 0,
            ..request(method, MOTIONS[0])
        }),
    );
    sample(talk, REQUEST)?;
    let mut steps = 0;
    let mut cycles = 0.0;

    while steps < FULL_CYCLE {
        let (made, taken) = talk.ask(Command::Measure(MOST_MEASURED_STEPS), |answer| {
            if let Answer::Measured { steps, cycles } = answer {
                Some((steps, cycles))
            } else {
                None
            }
        })?;
        if taken == 0 || made == 0 {
            return Ok(None);
        }
        steps += made;
        cycles += f64::from(taken);
    }

    Ok(Some(cycles / f64::from(steps)))
}

const FRAMES: u32 = TICK_RATE;
const PATIENCE: usize = 10 * FRAMES as usize;

/// Plays every scene on the board and compares a second of each. A frame that by the clock of
/// `hertz` took longer than the whole run is a fault, too.
pub fn scenes(talk: &mut Talk, hertz: u32) -> anyhow::Result<Section> {
    let columns = &[
        "scene",
        "frames",
        "bits",
        "dropped",
        "moving and drawing (ms)",
        "with panel and link (ms)",
    ];
    let mut section = Section::new(
        "Scenes",
        "The longest frame of one second, by the board's tick clock.",
        columns,
    );
    SceneName::ALL
        .iter()
        .try_for_each(|&scene| play(talk, scene, hertz, &mut section))?;
    Ok(section)
}

fn play(talk: &mut Talk, name: SceneName, hertz: u32, section: &mut Section) -> anyhow::Result<()> {
    talk.port.send(0, Command::Choose(name));
    let mut comparison = Comparison::default();
    let mut frames = Vec::new();
    let mut compared = 0;
    let mut of_others = 0;

    while compared < FRAMES && comparison.difference().is_none() {
        let frame = talk.next(|message| {
            if let ToHost::Answer(_, Answer::Status(status)) = message {
                comparison.status(&status);
            }
            message.frame()
        })?;
        if frame.scene != name {
            of_others += 1;
            ensure!(
                of_others < PATIENCE,
                "{}: the board still shows {} after {of_others} frames",
                name.name(),
                frame.scene.name()
            );
            continue;
        }
        frames.push(frame);
        ensure!(
            frames.len() < PATIENCE,
            "{}: of {} frames {compared} could be compared",
            name.name(),
            frames.len()
        );
        // The comparison needs the board's settings.
        if comparison.frame(&frame) {
            talk.port.send(0, Command::Ask);
        }
        while comparison.follow().is_some() {
            compared += 1;
        }
    }

    let difference = comparison
        .difference()
        .map(|difference| difference.to_string());
    let first = &frames[0];
    let last = &frames[frames.len() - 1];
    let dropped = last.dropped.wrapping_sub(first.dropped);
    let milliseconds =
        |cycles: Option<u32>| 1e3 * f64::from(cycles.unwrap_or(0)) / f64::from(hertz.max(1));
    let computing = milliseconds(frames.iter().map(|frame| frame.scene_cycles).max());

    // A frame reports the whole time of the previous frame, which for the first frame belongs to
    // another scene.
    let whole = milliseconds(frames[1..].iter().map(|frame| frame.busy_cycles).max());

    let ticks = last
        .sequence
        .wrapping_sub(first.sequence)
        .wrapping_add(dropped);
    let run = 1e3 * (f64::from(ticks) + 2.0) / f64::from(TICK_RATE);

    // A time longer than the whole run is impossible, so the board's clock must be wrong.
    let longest = computing.max(whole);
    let too_long = (longest > run).then(|| {
        format!(
            "a frame of {longest:.2} ms in a run of {run:.2} ms: the board's clock is read wrongly"
        )
    });
    let fault = difference
        .clone()
        .or(too_long)
        .map(|fault| format!("{}: {fault}", name.name()));

    let [computing, whole] = [computing, whole].map(|time| format!("{time:.2}"));
    let compared = compared.to_string();
    let dropped = dropped.to_string();
    section.add(
        vec![
            name.name().into(),
            compared,
            verdict(difference),
            dropped,
            computing,
            whole,
        ],
        fault,
    );
    Ok(())
}
