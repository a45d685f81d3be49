//! The plan on the emulated boards: found between the frames without delaying one, logged, answered, and the host's to the bit.

mod support;

use double_pendulum::plan::{Budget, Costs, Plan, Search};
use firmware::config::{CORTEX_M3, CORTEX_M4F, HALF_PIXEL, TICK_RATE};
use firmware::motion::planner::problem;
use firmware::protocol::{AskPlan, Choose, Frame, Planned, limit_code, method_code};
use firmware::scenes::{AnyScene, SceneName};
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Machine, QemuError};
use support::{application, settings, toolchain};

/// Frames between two questions.
const EVERY: u32 = TICK_RATE;
/// Questions until the plan must have been found: minutes of the board's time, many times what the slowest takes.
const PATIENCE: u32 = 240;
/// Where a Cortex-M3 is asked, too: chaos, calm, nothing that moves, a light elbow. It takes its time.
const ON_M3: [SceneName; 4] = [SceneName::Page, SceneName::SmallLight, SceneName::Frequencies, SceneName::Figure7];
/// What `found` says when all is found, and when there is nothing to find.
const ALL: u8 = 3;
const NOTHING: u8 = 0;

/// The search to its end.
fn found(mut search: Search) -> Plan {
    loop {
        if let Some(plan) = search.advance(f32::INFINITY).expect("a good scene") {
            return plan;
        }
    }
}

/// What the board must answer, by the kernel on the host.
fn expected(name: SceneName, costs: &Costs, answer: &Planned) -> Planned {
    let settings = name.first_settings();
    let playing = AnyScene::new(name, &settings).expect("a scene of the catalogue");
    let Some(shown) = playing.shown() else { return Planned { request: answer.request, ..Planned::default() } };
    let scene = problem(&settings, &shown);
    let budget = Budget { frame: answer.frame_budget, planning: answer.planning_budget };
    let plan = found(Search::new(&scene, costs, &budget).expect("a good scene"));
    let seen = found(Search::of(shown.method, shown.steps, &scene, costs, &budget).expect("a good scene"));
    Planned {
        found: ALL,
        method: method_code(plan.method),
        steps: plan.steps,
        dt: plan.dt,
        error: HALF_PIXEL * plan.error,
        cycles: plan.cost,
        horizon: plan.horizon,
        limit: limit_code(plan.limit),
        planning: plan.spent,
        shown_method: method_code(seen.method),
        shown_steps: seen.steps,
        shown_error: HALF_PIXEL * seen.error,
        shown_cycles: seen.cost,
        shown_horizon: seen.horizon,
        shown_limit: limit_code(seen.limit),
        height: shown.height.into(),
        duration: scene.duration,
        ..*answer
    }
}

/// Asks until all is found; how many frames that took.
fn planned(machine: &mut Machine, board: &Board, name: SceneName) -> Result<(Planned, u32), QemuError> {
    let mut frames = 0;
    for request in 2..PATIENCE {
        for _ in 0..EVERY {
            let frame: Frame = machine.serial.next().ok_or_else(|| machine.silence())?;
            assert_eq!(frame.dropped, 0, "{}: {}", board.name, name.name());
            frames += 1;
        }
        machine.serial.send(&AskPlan { request: request as u16 })?;
        loop {
            let message = machine.serial.receive().ok_or_else(|| machine.silence())?;
            frames += u32::from(message.read::<Frame>().is_some());
            match message.read::<Planned>() {
                Some(answer) if [ALL, NOTHING].contains(&answer.found) => return Ok((answer, frames)),
                Some(_) => break,
                None => {}
            }
        }
    }
    panic!("{}: {} has no plan after {frames} frames", board.name, name.name());
}

#[test]
fn every_scene_is_planned_between_the_frames() -> Result<(), QemuError> {
    BOARDS.iter().filter(|board| board.has_panel).try_for_each(|board| {
        let costs = if board.target.ends_with("hf") { CORTEX_M4F } else { CORTEX_M3 };
        let (toolchain, elf) = (toolchain(), application(board));
        let mut machine = Machine::start(&settings(&toolchain, board, &elf))?;
        machine.serial.next::<Frame>().ok_or_else(|| machine.silence())?;
        let names = if costs == CORTEX_M3 { &ON_M3 } else { SceneName::ALL };
        for &name in names {
            machine.serial.send(&Choose { request: 1, scene: name.code() })?;
            while machine.serial.next::<Frame>().ok_or_else(|| machine.silence())?.scene != name.code() {}
            machine.log.arrived().for_each(drop);
            let (answer, frames) = planned(&mut machine, board, name)?;
            let lines: Vec<_> = machine.log.arrived().map(|line| line.text).collect();
            println!("{} {}: {:.1} s {lines:#?}", board.name, name.name(), f64::from(frames) / f64::from(TICK_RATE));
            let expected = expected(name, &costs, &answer);
            assert_eq!(format!("{answer:?}"), format!("{expected:?}"), "{}: {}", board.name, name.name());
            let heads = lines.iter().map(|line| line.split_once(':').map_or("", |(head, _)| head));
            let heads: Vec<_> = heads.filter(|head| ["plan", "shown"].contains(head)).collect();
            let both = ["plan", "shown"];
            assert_eq!(heads, if answer.found == ALL { &both[..] } else { &[] }, "{lines:#?}");
        }
        let counts = machine.serial.counts();
        assert_eq!((counts.damaged, counts.lost), (0, 0), "{}", board.name);
        machine.quit()
    })
}
