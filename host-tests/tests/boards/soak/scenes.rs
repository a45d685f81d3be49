//! All scenes, one after the other, and all of them a second time, which must be the first time over again: state for state,
//! and the stack no deeper than an interrupt takes it.

use std::collections::BTreeMap;

use firmware::config::TICK_RATE;
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;

use host_tests::emulator::qemu::{Lockstep, QemuError, Settings, Stack};
use host_tests::link::Received;

use super::Outcome;

/// How often every scene is played.
const ROUNDS: usize = 2;
/// No frame's time may be further than this from its tick, s.
const ON_TIME: f64 = 1e-9;
/// The largest energy error of a scene. Step errors are what is seen, and most where the motion is wildest.
const GREATEST_ENERGY_ERROR: f64 = 1e-3;
/// The most that one interrupt puts on the stack, bytes: the processor, which saves its floating-point registers too, and the
/// handler. No second one comes on top. When the host's bytes come is not up to the counted clock, so an interrupt may strike
/// where the stack is deepest in one round and not in the other.
const INTERRUPT: u32 = 108 + 96;

/// Plays every scene twice, in `seconds` of the board's time all together.
pub(super) fn scenes(settings: &Settings, seconds: u32) -> Result<Outcome, QemuError> {
    let each = (u64::from(seconds) * u64::from(TICK_RATE) / (ROUNDS * SceneName::ALL.len()) as u64).max(1);
    let stack = Stack::of(settings.elf)?;
    let mut machine = Lockstep::start(settings)?;
    stack.paint(&mut machine)?;
    // The link is up once a frame has come.
    let mut outcome = Outcome::default();
    outcome.frame(&machine.next_frame()?);
    let mut first_round = BTreeMap::new();
    let mut scene = SceneName::Page;
    let mut reached = Vec::new();
    for turn in 1..=ROUNDS * SceneName::ALL.len() {
        // Never the one that is on.
        scene = scene.next();
        machine.machine().serial.send(&Choose { request: 0, scene: scene.code() })?;
        let mut tick = 0;
        let mut played = Vec::new();
        while tick < each {
            // More than one where the board had no time to sleep between them.
            let frames = machine.run_to_frame()?.iter().filter_map(Received::read).collect::<Vec<Frame>>();
            frames.iter().for_each(|frame| outcome.frame(frame));
            // The command may not have been executed yet.
            for frame in frames.iter().filter(|frame| frame.scene == scene.code()).take((each - tick) as usize) {
                tick += 1;
                let late = frame.time - tick as f64 / f64::from(TICK_RATE);
                if late.abs() > ON_TIME {
                    outcome.fault(format!("{}: tick {tick} is off by {late} s", scene.name()));
                }
                let energy_error = f64::from(frame.energy_error.abs());
                outcome.energy_error = outcome.energy_error.max(energy_error);
                if energy_error.is_nan() || energy_error > GREATEST_ENERGY_ERROR {
                    outcome.fault(format!("{}: energy error {energy_error:.1e} at {} s", scene.name(), frame.time));
                }
                played.push((frame.state.map(f32::to_bits), frame.horizon.to_bits()));
            }
        }
        match first_round.get(scene.name()) {
            None => drop(first_round.insert(scene.name(), played)),
            Some(before) if *before == played => {}
            Some(_) => outcome.fault(format!("{}: not the same the second time", scene.name())),
        }
        if turn.is_multiple_of(SceneName::ALL.len()) {
            reached.push(stack.reached(&mut machine)?);
        }
    }
    outcome.stack = reached.last().copied();
    if let [first, .., last] = reached[..]
        && last > first + INTERRUPT
    {
        outcome.fault(format!("the stack reaches ever deeper: {reached:?} bytes"));
    }
    outcome.end(machine.machine(), settings.board);
    Ok(outcome)
}
