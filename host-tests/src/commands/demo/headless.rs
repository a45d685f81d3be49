//! Without a terminal: frame by frame, repeatable to the bit, with a summary at the end.

use std::time::Duration;

use firmware::config::TICK_RATE;
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;

use super::record::{Recording, TICKS_PER_FRAME, save};
use super::summary::Summary;
use super::{Stage, broken};
use crate::console::cli::{complain, say};
use crate::console::progress::Progress;
use crate::emulator::qemu::{Clock, Lockstep, Screenshot, Settings};

/// How long a run takes if nothing else is asked for, s.
const DEFAULT_SECONDS: f64 = 10.0;
/// The most time a run may take: so much, and so much for each second of the board's time.
const LIMIT: (Duration, f64) = (Duration::from_secs(60), 20.0);

/// Runs, prints the summary; whether all was well.
pub fn run(stage: &Stage, mut recording: Option<Recording>) -> anyhow::Result<bool> {
    let options = stage.options;
    let seconds = options.seconds.unwrap_or(DEFAULT_SECONDS);
    let mut machine = Lockstep::start(&Settings {
        qemu: stage.toolchain.qemu(),
        board: options.board,
        elf: &stage.elf,
        debugger: true,
        clock: Clock::Counted,
        window: None,
        limit: LIMIT.0 + Duration::from_secs_f64(LIMIT.1 * seconds),
    })
    .map_err(broken)?;
    let mut summary = Summary::default();
    let mut progress = Progress::start(&format!("running {} for {seconds} s of its time", options.board.name));

    let mut first = choose(&mut machine, options.scene, &mut summary)?;
    let begun = summary.ticks().saturating_sub(u32::from(first.is_some()));
    let ticks = (seconds * f64::from(TICK_RATE)).ceil() as u32;
    while summary.ticks() < begun + ticks || first.is_some() {
        let frame = match first.take() {
            Some(frame) => frame,
            None => {
                let frame = machine.next_frame().map_err(broken)?;
                summary.frame(&frame);
                frame
            }
        };
        machine.machine().log.arrived().for_each(|line| summary.line(&line));
        if let Some(recording) = &mut recording
            && (frame.sequence.wrapping_add(frame.dropped).wrapping_sub(begun)).is_multiple_of(TICKS_PER_FRAME)
        {
            recording.add(
                machine.screenshot().map_err(broken)?,
                frame.sequence.wrapping_add(frame.dropped).wrapping_sub(begun),
            )?;
        }
        progress.alive(None);
    }
    drop(progress);
    finish(stage, recording, || machine.screenshot().map_err(broken))?;
    machine.machine().log.arrived().for_each(|line| summary.line(&line));
    let counts = machine.machine().serial.counts();

    let faults = summary.faults(counts);
    faults.iter().for_each(|fault| complain(format_args!("not well: {fault}")));
    let said = say(format_args!("board                 {}\n{}", options.board.name, summary.report(counts)));
    // A fault is one even if no one reads the summary.
    if faults.is_empty() {
        said?;
    }
    Ok(faults.is_empty())
}

/// Has the board play a scene, unless it is the one it starts with; its first frame.
fn choose(machine: &mut Lockstep, scene: SceneName, summary: &mut Summary) -> anyhow::Result<Option<Frame>> {
    if scene == SceneName::Page {
        return Ok(None);
    }
    let mut next = |machine: &mut Lockstep| -> anyhow::Result<Frame> {
        let frame = machine.next_frame().map_err(broken)?;
        summary.frame(&frame);
        Ok(frame)
    };
    // The link is up once a frame has come.
    next(machine)?;
    machine.machine().serial.send(&Choose { request: 0, scene: scene.code() }).map_err(broken)?;
    loop {
        let frame = next(machine)?;
        if frame.scene == scene.code() {
            return Ok(Some(frame));
        }
    }
}

/// Completes the files that were asked for.
pub fn finish(
    stage: &Stage,
    recording: Option<Recording>,
    last: impl FnOnce() -> anyhow::Result<Screenshot>,
) -> anyhow::Result<()> {
    recording.map_or(Ok(()), Recording::finish)?;
    stage.options.screenshot.as_deref().map_or(Ok(()), |path| save(&last()?, path))
}
