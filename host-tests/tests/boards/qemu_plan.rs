//! The plan on the emulated boards: found in the very tick, and followed from the very tick, that the host says, without
//! delaying a frame; answered and logged.

use crate::support::{on, show};
use double_pendulum::Method;
use double_pendulum::plan::Plan;
use firmware::app::News;
use firmware::config::{HALF_PIXEL, TICK_RATE};
use firmware::protocol::{AskPlan, Choose, Done, Frame, Planned, limit_code, method_code};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::Machine;
use rayon::prelude::*;

/// One that goes another way soon, nothing that moves; a motion that ends early, a model.
const SCENES: [SceneName; 4] = [SceneName::Beats2To1, SceneName::Frequencies, SceneName::Page, SceneName::SmallLight];
/// By then all is found, ticks.
const FOLLOWED: u32 = 18 * TICK_RATE;

#[test]
fn every_board_finds_the_hosts_plan_and_follows_it_from_the_same_tick() -> anyhow::Result<()> {
    every_board_plans(&SCENES[..2])
}

#[test]
#[ignore = "minutes: two scenes more"]
fn every_board_plans_as_the_host_does_whatever_it_shows() -> anyhow::Result<()> {
    every_board_plans(&SCENES[2..])
}

fn every_board_plans(scenes: &[SceneName]) -> anyhow::Result<()> {
    BOARDS.par_iter().try_for_each(|board| {
        let mut machine = on(board, Machine::start)?;
        machine.wait_for::<Frame>()?;
        for &name in scenes {
            machine.serial.send(&Choose { request: 1, scene: name.code() })?;
            machine.wait_for::<Done>()?;
            machine.log.arrived().for_each(drop);
            followed(&mut machine, board, name)?;
        }
        let counts = machine.serial.counts();
        assert_eq!((counts.damaged, counts.lost), (0, 0), "{}", board.name);
        Ok(())
    })
}

/// Frame by frame as the host shows it, then the answer and the log.
fn followed(machine: &mut Machine, board: &Board, name: SceneName) -> anyhow::Result<()> {
    let mut show = show(board, name);
    loop {
        let frame: Frame = machine.wait_for()?;
        assert_eq!(frame.dropped, 0, "{}: {frame:?}", board.name);
        assert_eq!(frame, show.expected(&frame), "{}: {}", board.name, name.name());
        if frame.step >= FOLLOWED {
            break;
        }
    }
    let changes = show.news.iter().filter(|(_, news)| matches!(news, News::Shown(..))).count();
    machine.serial.send(&AskPlan { request: 2 })?;
    let answer: Planned = machine.wait_for()?;
    let lines: Vec<_> = machine.log.arrived().map(|line| line.text).collect();
    let logged = |head: &str| lines.iter().filter(|line| line.starts_with(head)).count();
    let plan = show.news.iter().find_map(|(_, news)| match news {
        News::Found(Ok(plan)) => Some(*plan),
        _ => None,
    });
    println!("{} {}: {} changes, {plan:?}", board.name, name.name(), changes);
    assert_eq!(name == SceneName::Frequencies, plan.is_none(), "{}: {} {lines:#?}", board.name, name.name());
    let Some(Plan { method, steps, error, cost, limit, .. }) = plan else { return Ok(()) };
    let answered = (answer.found, answer.method, answer.steps, answer.error, answer.cycles, answer.limit);
    let expected = (2, method_code(method), steps, HALF_PIXEL * error, cost, limit_code(limit));
    assert_eq!(answered, expected, "{}: {}", board.name, name.name());
    // What is said at the start may have come before the first frame of it.
    assert!(logged("plan: ") == 1 && (changes..=1 + changes).contains(&logged("shown: ")), "{lines:#?}");
    assert_eq!(changes > 0, name == SceneName::Beats2To1 && method != Method::Extrapolation10Fixed64, "{lines:#?}");
    Ok(())
}
