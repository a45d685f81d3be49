//! Every board plays every scene like the host. Each frame is on time and bit-identical. The panel
//! is compared every [`EVERY`] ticks and at the end of a short round, and the first round is judged
//! by the board's budgets of time. The scenes are played twice: in the second round, which the long
//! test extends to an hour, the stack may be deeper only by one interrupt, so that drift, leaks and
//! overflows of counters are detected.
//!
//! The clock of an emulated board counts instructions, so that an hour of it takes minutes. The
//! long test is run by `cargo test -p host-tests --test boards all_scenes:: -- --ignored` or `cargo
//! verify --long`. The command `cargo test -p host-tests --test boards all_scenes:: -- --nocapture`
//! prints the memory and the idle time of each board.

use std::time::Duration;

use crate::budgets::{Next, beyond, exercise, wire};
use crate::support::{LIMIT, PAINT, application, depth, on, show, stack};
use boards::budgets;
use boards::host::Show;
use boards::link::Counts;
use boards::pico::PicoMachine;
use boards::qemu::{Machine, MachineSettings};
use boards::toolchain;
use boards::{BOARDS, Board, PICO};
use cycles::{Core, Cost, Image};
use firmware::config::TICK_RATE;
use firmware::graphics::PanelName;
use firmware::protocol::{Command, Frame, ToHost};
use firmware::scenes::SceneName;
use host_tests::count::FrameProfile;
use rayon::prelude::*;

/// The ticks between two comparisons of the panel. The board is stopped for each, which is slow.
const EVERY: u32 = 75;
/// The ticks before the first scene, of a scene in a short second round, and of one on the Pico.
const SHORT: u32 = 25;
const SETTLING: u32 = 6;
/// The ticks of a scene in an hour.
const LONG: u32 = 3600 * TICK_RATE / SceneName::ALL.len() as u32;
/// The slowest board on a slow host takes a tenth of it.
const LONG_LIMIT: Duration = Duration::from_secs(6 * 3600);
/// The largest stack use of one interrupt, bytes: the processor's, which also saves the
/// floating-point registers, and the handler's. Interrupts do not nest. The counted clock does not
/// determine when the host's bytes arrive, so an interrupt may occur at the deepest place of the
/// stack in one round only.
const INTERRUPT: u32 = 108 + 96;
const NO_PANEL: &str = "panel: absent";
/// The largest number of cycles per instruction, averaged over the work of a frame. A scene that
/// keeps its budgets even at this number is not profiled.
const MOST_CYCLES: f64 = 2.2;

/// Returns the number of ticks of a scene in the first round.
///
/// Within 1.1 s the stack has been as deep as in an hour, except for an interrupt, at whatever tick
/// the scene is left. The M3 plays two scenes for 10 s, because their most expensive frames come
/// late: the butterfly's curve grows, and the page has a budget of its own.
fn ticks(board: &Board, name: SceneName) -> u32 {
    if board.core() == Core::M3 && matches!(name, SceneName::Butterfly | SceneName::Page) {
        10 * TICK_RATE
    } else {
        EVERY
    }
}

#[test]
fn every_board_plays_every_scene_as_the_host_does_within_its_budgets() -> anyhow::Result<()> {
    every_board_plays(LIMIT, SHORT)
}

#[test]
#[ignore = "an hour of four boards"]
fn every_board_plays_every_scene_for_an_hour() -> anyhow::Result<()> {
    every_board_plays(LONG_LIMIT, LONG)
}

/// In the second round a scene is played for `again` ticks.
fn every_board_plays(limit: Duration, again: u32) -> anyhow::Result<()> {
    println!(
        "| board | text | data | bss | stack | idle (estimated) |\n\
        | --- | ---: | ---: | ---: | ---: | ---: |"
    );
    let too_much = BOARDS
        .par_iter()
        .map(|board| plays(board, limit, again))
        .collect::<Result<Vec<_>, _>>()?
        .concat();
    assert!(too_much.is_empty(), "{too_much:#?}");
    Ok(())
}

fn messages_after(machine: &mut Machine, words: &[u8]) -> anyhow::Result<Vec<ToHost>> {
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

struct SceneRun<'a> {
    board: &'a Board,
    name: SceneName,
    show: Show,
    words: Vec<u8>,
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

    fn to(&mut self, until: u32, next: Next) -> anyhow::Result<()> {
        while self.step() < until {
            let messages = next(&std::mem::take(&mut self.words))?;

            let is_here = |frame: &Frame| frame.scene == self.name;
            for frame in messages
                .into_iter()
                .filter_map(ToHost::frame)
                .filter(is_here)
            {
                let place = format!("{}: {}", self.board.name, self.name.name());
                let step = self.step() + 1;
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

fn cycles_per_instruction(cost: Cost) -> f64 {
    cost.cycles as f64 / cost.instructions as f64
}

fn plays(board: &'static Board, limit: Duration, again: u32) -> anyhow::Result<Vec<String>> {
    // The unused stack is painted, so that its depth can be read at the end.
    let elf = application(board);
    let image = Image::read(&elf)?;
    let stack = stack(&elf);
    let mut machine = on(board, |settings| {
        Machine::halted(&MachineSettings { limit, ..*settings })
    })?;
    machine.write(stack.start, &vec![PAINT; stack.len()])?;

    machine.run()?;
    (0..SHORT).try_for_each(|_| messages_after(&mut machine, &[]).map(drop))?;
    machine.stop()?;
    machine.run_to_frame()?;
    let mut too_much = Vec::new();
    let mut reached = Vec::new();
    let mut least_idle = 1.0_f64;
    let mut profile = FrameProfile::of_next(&mut machine, &image, board.core())?;

    for round in 0..2 {
        let mut name = SceneName::Page;
        for _ in SceneName::ALL {
            name = name.next();
            let mut run = SceneRun::new(board, name);
            let last = if round == 0 {
                ticks(board, name)
            } else {
                again
            };
            for until in (EVERY.min(last)..=last).step_by(EVERY as usize) {
                machine.run()?;
                run.to(until, &mut |words| messages_after(&mut machine, words))?;
                machine.stop()?;

                run.to(run.step() + 1, &mut |_| machine.run_to_frame())?;
                let shown = board.has_panel.then(|| machine.screenshot()).transpose()?;
                let is_it = shown
                    .as_ref()
                    .is_none_or(|shown| *shown == run.show.frame());
                assert!(is_it, "{}: {}\n{shown:?}", board.name, name.name());
            }

            if round > 0 {
                continue;
            }

            // The share of a frame that the scene and the whole frame take, in instructions.
            let frame =
                board.instruction() * f64::from(board.processor_hertz()) / f64::from(TICK_RATE);
            let [scene, whole] = run
                .highest
                .map(|cycles| f64::from(cycles) / f64::from(board.hertz) / frame);

            let most = if (board.core(), name) == (Core::M3, SceneName::Page) {
                budgets::PAGE
            } else {
                budgets::SCENE
            };

            // The largest share of a budget that the scene takes, at these numbers of cycles per
            // instruction of the scene and of the whole frame. The budget of a scene is for the
            // slower cores.
            let load = |of_scene: f64, of_whole: f64| {
                let of_budget = match board.core() {
                    Core::M3 | Core::M0Plus => of_scene * scene / most,
                    Core::M4F => 0.0,
                };
                of_budget.max(of_whole * whole / (1.0 - budgets::IDLE))
            };

            // Logging a frame takes a second. A frame is profiled if the scene may exceed its
            // budgets. On the M3 it is also profiled in the two scenes that are the most expensive
            // to show.
            let is_shown_slowly = board.core() == Core::M3
                && matches!(name, SceneName::Butterfly | SceneName::SmallHeavy);
            let is_profiled = is_shown_slowly || load(MOST_CYCLES, MOST_CYCLES) > 1.0;
            if is_profiled {
                profile = FrameProfile::of_next(&mut machine, &image, board.core())?;
            }

            // The board's clock counts instructions. The numbers of cycles per instruction are
            // estimated from a frame that QEMU logs, of this scene or an earlier one.
            let [of_scene, of_whole] = [profile.scene, profile.busy].map(cycles_per_instruction);
            assert!(
                of_scene.max(of_whole) <= MOST_CYCLES,
                "{}, {}: {of_scene:.2} and {of_whole:.2} cycles for an instruction",
                board.name,
                name.name()
            );
            let showing = profile.showing.cycles;
            let idle = 1.0 - whole * of_whole;
            let found = format!(
                "{:15} {:12} {:4.1} % of a frame, idle {:4.1} %, \
                at {of_scene:.2} and {of_whole:.2} cycles for an instruction; shown in {showing}",
                board.name,
                name.name(),
                100.0 * scene * of_scene,
                100.0 * idle
            );
            println!("{found}");

            // Only the M3 has a budget for showing a frame.
            if load(of_scene, of_whole) > 1.0
                || is_profiled && board.core() == Core::M3 && showing > budgets::SHOWING
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

    // The commands can use more stack than the scenes.
    machine.run()?;
    exercise(&mut |words| messages_after(&mut machine, words))?;
    machine.stop()?;
    too_much.extend(beyond(
        board,
        &elf,
        depth(&machine.read(stack)?),
        least_idle,
    ));
    Ok(too_much)
}

/// The Pico's emulator counts cycles by the processor's manual. It does not model wait states of
/// the flash.
#[test]
fn the_pico_plays_every_scene_as_the_host_does_within_its_budgets() -> anyhow::Result<()> {
    let node = toolchain::ready_for_pico().unwrap_or_else(|missing| panic!("{missing}"));
    let elf = application(&PICO);
    let stack = stack(&elf);
    let mut machine = PicoMachine::start(&node, &elf, PanelName::Oled, LIMIT)?;
    machine.tell(&format!("fill {} {} {PAINT}", stack.start, stack.len()))?;
    machine.next_frame()?;
    let mut next = |words: &[u8]| {
        machine.send_bytes(words)?;
        machine.run_to_frame()
    };

    let mut name = SceneName::Page;
    let mut highest = 0;

    for _ in SceneName::ALL {
        name = name.next();
        let mut run = SceneRun::new(&PICO, name);
        run.to(SHORT, &mut next)?;
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
