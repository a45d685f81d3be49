//! Every board plays every scene as the host does, each frame on time and bit for bit, on the panel too, within its budgets of memory
//! and time; and a second time with the stack no deeper than an interrupt takes it. Drift, leaks or a count that runs over show.
//!
//! The clock of an emulated board is the counted one, so that an hour of it takes minutes. The long one:
//! `cargo test -p host-tests --test boards scenes:: -- --ignored`, or `cargo verify --long`. The table in the README is what
//! `cargo test -p host-tests --test boards scenes:: -- --nocapture` prints.

use std::time::Duration;

use crate::budgets::{Next, beyond, exercise, wire};
use crate::support::{LIMIT, PAINT, application, depth, on, show, stack};
use cycles::{Core, Cost, Image};
use firmware::config::TICK_RATE;
use firmware::protocol::{Command, Frame, ToHost};
use firmware::scenes::SceneName;
use host_tests::commands::count::FrameProfile;
use host_tests::emulator::boards::{BOARDS, Board, PICO};
use host_tests::emulator::budgets;
use host_tests::emulator::host::Show;
use host_tests::emulator::pico::PicoMachine;
use host_tests::emulator::qemu::{Machine, Screenshot, Settings};
use host_tests::emulator::toolchain;
use host_tests::link::Counts;
use rayon::prelude::*;

/// Every so many frames the panel is compared.
const EVERY: u32 = 25;
/// Frames after the start of a scene whose cost is not watched.
const SETTLING: u32 = 6;
/// An hour of all scenes, twice.
const LONG: u32 = 3600 * TICK_RATE / (2 * SceneName::ALL.len() as u32);
/// Guards a long run against a hang: the slowest board on a slow host takes a tenth of it.
const LONG_LIMIT: Duration = Duration::from_secs(6 * 3600);
/// The most that one interrupt puts on the stack, bytes: the processor, which saves its floating-point registers too, and the
/// handler. No second one comes on top. When the host's bytes come is not up to the counted clock, so an interrupt may strike
/// where the stack is deepest in one round and not in the other.
const INTERRUPT: u32 = 108 + 96;
/// What a firmware says whose panel QEMU does not emulate.
const NO_PANEL: &str = "panel: Absent";
/// No frame takes as many cycles for an instruction on average: 1.3 to 1.7 are found.
const MOST_CYCLES: f64 = 3.0;

/// Frames of a scene in a short run. Within 1.1 s the stack has been as deep as it gets in an hour, an interrupt apart, whichever
/// tick a scene is left at. On the M3 the butterfly's curve grows, and the most expensive frame comes after 10 s.
fn short(board: &Board, name: SceneName) -> u32 {
    if (board.core(), name) == (Core::M3, SceneName::Butterfly) {
        10 * TICK_RATE
    } else {
        3 * EVERY
    }
}

#[test]
fn every_board_plays_every_scene_as_the_host_does_within_its_budgets() -> anyhow::Result<()> {
    every_board_plays(LIMIT, short)
}

#[test]
#[ignore = "an hour of five boards"]
fn every_board_plays_every_scene_for_an_hour() -> anyhow::Result<()> {
    every_board_plays(LONG_LIMIT, |_, _| LONG)
}

fn every_board_plays(limit: Duration, ticks: fn(&Board, SceneName) -> u32) -> anyhow::Result<()> {
    println!(
        "| board | text | data | bss | stack | idle (estimated) |\n| --- | ---: | ---: | ---: | ---: | ---: |"
    );
    let too_much = BOARDS
        .par_iter()
        .map(|board| plays(board, limit, ticks))
        .collect::<Result<Vec<_>, _>>()?
        .concat();
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}

/// Tells a board that runs freely something, and waits for its next frame.
fn told(machine: &mut Machine, words: &[u8]) -> anyhow::Result<Vec<ToHost>> {
    machine.send_bytes(words)?;
    let mut messages = Vec::new();
    while messages
        .last()
        .is_none_or(|last: &ToHost| last.frame().is_none())
    {
        messages.push(machine.receive()?);
    }
    Ok(messages)
}

/// A scene on a board beside the same on the host.
struct SceneRun<'a> {
    board: &'a Board,
    name: SceneName,
    show: Show,
    /// What the board is yet to be told.
    words: Vec<u8>,
    /// The highest costs of the scene and of a whole frame, counts of the board's clock.
    highest: [u32; 2],
}

impl<'a> SceneRun<'a> {
    fn new(board: &'a Board, name: SceneName) -> Self {
        let words = wire(Command::Choose(name));
        Self {
            board,
            name,
            show: show(board, name),
            words,
            highest: [0; 2],
        }
    }

    fn step(&self) -> u32 {
        self.show.report().step as u32
    }

    /// Goes on to a tick of the scene: each frame is the host's, none is late.
    fn to(&mut self, until: u32, next: Next) -> anyhow::Result<()> {
        while self.step() < until {
            let messages = next(&std::mem::take(&mut self.words))?;
            // The command may not have been executed yet.
            let is_here = |frame: &Frame| frame.scene == self.name;
            for frame in messages
                .into_iter()
                .filter_map(ToHost::frame)
                .filter(is_here)
            {
                let (place, step) = (
                    format!("{}: {}", self.board.name, self.name.name()),
                    self.step() + 1,
                );
                assert_eq!(
                    (frame.report.step, frame.dropped),
                    (step.into(), 0),
                    "{place}"
                );
                assert_eq!(frame, self.show.expected(&frame), "{place}");
                if step > SETTLING {
                    let [scene, whole] = self.highest;
                    self.highest = [scene.max(frame.scene_cycles), whole.max(frame.busy_cycles)];
                }
            }
        }
        Ok(())
    }
}

/// Plays all scenes twice, the panel compared now and then; what is beyond the board's budgets.
fn plays(
    board: &'static Board,
    limit: Duration,
    ticks: fn(&Board, SceneName) -> u32,
) -> anyhow::Result<Vec<String>> {
    let elf = application(board);
    let (image, stack) = (Image::read(&elf)?, stack(&elf));
    let mut machine = on(board, |settings| {
        Machine::halted(&Settings { limit, ..*settings })
    })?;
    machine.write(stack.start, &vec![PAINT; stack.len()])?;
    // The link is up once a frame has come.
    (0..EVERY).try_for_each(|_| machine.run_to_frame().map(drop))?;
    let (mut too_much, mut reached, mut least_idle) = (Vec::new(), Vec::new(), 1.0_f64);
    let mut profile = FrameProfile::of_next(&mut machine, &image, board.core())?;
    for round in 0..2 {
        let mut name = SceneName::Page;
        for _ in SceneName::ALL {
            // Never the one that is on.
            name = name.next();
            let mut run = SceneRun::new(board, name);
            for until in (EVERY..=ticks(board, name)).step_by(EVERY as usize) {
                machine.run()?;
                run.to(until, &mut |words| told(&mut machine, words))?;
                machine.stop()?;
                // The panel shows exactly the frame that has come when the processor is about to sleep.
                run.to(run.step() + 1, &mut |_| machine.run_to_frame())?;
                let shown = board.has_panel.then(|| machine.screenshot()).transpose()?;
                let is_it = shown
                    .as_ref()
                    .is_none_or(|shown| *shown == Screenshot::from(&run.show.frame()));
                assert!(is_it, "{}: {}\n{shown:?}", board.name, name.name());
            }
            // The cost is taken in the first round.
            if round > 0 {
                continue;
            }
            let frame =
                board.instruction() * f64::from(board.processor_hertz()) / f64::from(TICK_RATE);
            let [scene, whole] = run
                .highest
                .map(|cycles| f64::from(cycles) / f64::from(board.hertz) / frame);
            let is_profiled = match board.core() {
                Core::M3 => true,
                Core::M0Plus => {
                    MOST_CYCLES * scene > budgets::SCENE
                        || 1.0 - MOST_CYCLES * whole < budgets::IDLE
                }
                Core::M4F => false,
            };
            if is_profiled {
                profile = FrameProfile::of_next(&mut machine, &image, board.core())?;
            }
            // The board's clock counts instructions; how many cycles one takes is estimated on a frame that QEMU logs whole.
            let Cost {
                instructions,
                cycles,
                ..
            } = profile.whole;
            let cycles = cycles as f64 / instructions as f64;
            let (scene, idle, showing) =
                (scene * cycles, 1.0 - whole * cycles, profile.showing.cycles);
            let found = format!(
                "{:15} {:12} {:4.1} % of a frame, idle {:4.1} %, at {cycles:.2} cycles for an instruction; shown in {showing}",
                board.name,
                name.name(),
                100.0 * scene,
                100.0 * idle
            );
            println!("{found}");
            // The budgets of a scene and of showing it are for the slower cores.
            let is_long = board.core() != Core::M4F && scene > budgets::SCENE;
            if is_long
                || idle < budgets::IDLE
                || board.core() == Core::M3 && showing > budgets::SHOWING
            {
                too_much.push(found);
            }
            least_idle = least_idle.min(idle);
        }
        reached.push(depth(&machine.read(stack.clone())?));
    }
    assert!(
        reached[1] <= reached[0] + INTERRUPT,
        "{}: the stack reaches ever deeper: {reached:?}",
        board.name
    );
    let Counts { damaged, lost, .. } = machine.counts();
    assert_eq!((damaged, lost), (0, 0), "{}", board.name);
    let lines = machine.lines().into_iter().filter(|line| line.is_bad());
    let bad: Vec<_> = lines
        .filter(|line| board.has_panel || !line.text.contains(NO_PANEL))
        .collect();
    assert!(bad.is_empty(), "{}: {bad:#?}", board.name);
    machine.run()?;
    exercise(&mut |words| told(&mut machine, words))?;
    machine.stop()?;
    too_much.extend(beyond(
        board,
        &elf,
        depth(&machine.read(stack)?),
        least_idle,
    ));
    Ok(too_much)
}

/// Its emulator counts cycles itself, by the processor's manual; it knows of no waiting for the flash.
#[test]
fn the_pico_plays_every_scene_as_the_host_does_within_its_budgets() -> anyhow::Result<()> {
    let node = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    let elf = application(&PICO);
    let stack = stack(&elf);
    let mut machine = PicoMachine::start(&node, &elf, LIMIT)?;
    machine.tell(&format!("fill {} {} {PAINT}", stack.start, stack.len()))?;
    machine.next_frame()?;
    let mut next = |words: &[u8]| {
        machine.send_bytes(words)?;
        machine.run_to_frame()
    };
    let (mut name, mut highest) = (SceneName::Page, 0);
    for _ in SceneName::ALL {
        name = name.next();
        let mut run = SceneRun::new(&PICO, name);
        run.to(EVERY, &mut next)?;
        highest = highest.max(run.highest[1]);
    }
    exercise(&mut next)?;
    let idle = 1.0 - f64::from(highest * TICK_RATE) / f64::from(PICO.hertz);
    let too_much = beyond(
        &PICO,
        &elf,
        depth(&machine.tell(&format!("read {} {}", stack.start, stack.len()))?),
        idle,
    );
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}
