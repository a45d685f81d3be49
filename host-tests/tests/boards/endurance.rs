//! Every board plays all scenes, one after the other, and all of them a second time: each frame on time and the host's, bit for
//! bit, and the stack the second time no deeper than an interrupt takes it. Drift, leaks or a count that runs over show.
//!
//! The clock of the board is the counted one, so that an hour of it takes minutes and any run can be repeated. The long one:
//! `cargo test -p host-tests --test boards endurance:: -- --ignored`, or `cargo verify --long`.

use std::time::Duration;

use firmware::config::TICK_RATE;
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::{Lockstep, Settings, Stack};
use host_tests::link::{Counts, Received};
use rayon::prelude::*;

use crate::support::{LIMIT, application, on};

/// Seconds of the board's time in a short run: 1.25 for each scene, twice. Within 1.1 s the stack has been as deep on every
/// board as it gets in an hour, an interrupt apart, whichever tick a scene is left at.
const SHORT: u32 = 30;
/// An hour.
const LONG: u32 = 3600;
/// Guards a long run against a hang: the slowest board on a slow host takes a tenth of it.
const LONG_LIMIT: Duration = Duration::from_secs(6 * 3600);
/// How often every scene is played.
const ROUNDS: u32 = 2;
/// The most that one interrupt puts on the stack, bytes: the processor, which saves its floating-point registers too, and the
/// handler. No second one comes on top. When the host's bytes come is not up to the counted clock, so an interrupt may strike
/// where the stack is deepest in one round and not in the other.
const INTERRUPT: u32 = 108 + 96;
/// What a firmware says whose panel QEMU does not emulate.
const NO_PANEL: &str = "panel: Absent";

#[test]
fn a_board_plays_all_scenes_twice_as_the_host_does() -> anyhow::Result<()> {
    plays(&BOARDS[0], SHORT, LIMIT)
}

#[test]
#[ignore = "an hour of five boards"]
fn every_board_plays_all_scenes_twice_as_the_host_does_for_an_hour() -> anyhow::Result<()> {
    BOARDS.par_iter().try_for_each(|board| plays(board, LONG, LONG_LIMIT))
}

/// Plays every scene twice, in `seconds` of the board's time all together.
fn plays(board: &Board, seconds: u32, limit: Duration) -> anyhow::Result<()> {
    let ticks = seconds * TICK_RATE / (ROUNDS * SceneName::ALL.len() as u32);
    let stack = Stack::of(&application(board))?;
    let mut machine = on(board, |settings| Lockstep::start(&Settings { limit, ..*settings }))?;
    stack.paint(&mut machine)?;
    // The link is up once a frame has come.
    let mut frames = 1 + machine.next_frame()?.sequence;
    let (mut scene, mut reached) = (SceneName::Page, Vec::new());
    for _ in 0..ROUNDS {
        for _ in SceneName::ALL {
            // Never the one that is on.
            scene = scene.next();
            machine.machine().serial.send(&Choose { request: 0, scene: scene.code() })?;
            let mut show = Show::on(board.processor(), scene, &scene.first_settings()).expect("one of the catalogue");
            let mut played = 0;
            while played < ticks {
                // More than one where the board had no time to sleep between them.
                for frame in machine.run_to_frame()?.iter().filter_map(Received::read::<Frame>) {
                    assert_eq!((frame.sequence, frame.dropped), (frames, 0), "{}: {}", board.name, scene.name());
                    frames += 1;
                    // The command may not have been executed yet.
                    if frame.scene == scene.code() {
                        played += 1;
                        assert_eq!(frame.step, played, "{}: {}", board.name, scene.name());
                        assert_eq!(frame, show.expected(&frame), "{}: {}", board.name, scene.name());
                    }
                }
            }
        }
        reached.push(stack.reached(&mut machine)?);
    }
    println!("{}: {frames} frames, stack {reached:?} bytes", board.name);
    assert!(reached[1] <= reached[0] + INTERRUPT, "{}: the stack reaches ever deeper: {reached:?}", board.name);
    let Counts { damaged, lost, .. } = machine.machine().serial.counts();
    assert_eq!((damaged, lost), (0, 0), "{}", board.name);
    let lines = machine.machine().log.arrived().filter(|line| line.is_bad());
    let bad: Vec<_> = lines.filter(|line| board.has_panel || !line.text.contains(NO_PANEL)).collect();
    assert!(bad.is_empty(), "{}: {bad:#?}", board.name);
    Ok(())
}
