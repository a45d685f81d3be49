//! The plan on the emulated boards: it is found and followed in exactly the same ticks as on the
//! host, without delaying a frame. It is reported in answers and in the log.

use crate::support::{on, show};
use boards::qemu::Machine;
use boards::{BOARDS, Board};
use double_pendulum::Method;
use double_pendulum::plan::Plan;
use firmware::app::PlannerEvent;
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Command};
use firmware::scenes::SceneName;
use rayon::prelude::*;

/// A scene that soon changes its method, a scene without a motion, a motion that ends early, and a
/// linear scene. The number is the time for which the scene is followed, s.
const SCENES: [(SceneName, u32); 4] = [
    (SceneName::Beats2To1, 18),
    (SceneName::Frequencies, 1),
    (SceneName::Page, 18),
    (SceneName::SmallLight, 18),
];

#[test]
fn every_board_finds_the_hosts_plan_and_follows_it_from_the_same_tick() -> anyhow::Result<()> {
    every_board_plans(&SCENES[..2])
}

#[test]
#[ignore = "minutes: two scenes more"]
fn every_board_plans_further_scenes_as_the_host_does() -> anyhow::Result<()> {
    every_board_plans(&SCENES[2..])
}

fn every_board_plans(scenes: &[(SceneName, u32)]) -> anyhow::Result<()> {
    BOARDS.par_iter().try_for_each(|board| {
        let mut machine = on(board, Machine::start)?;
        machine.next_frame()?;
        for &(name, seconds) in scenes {
            machine.send(1, Command::Choose(name))?;
            assert_eq!(machine.next_answer()?, (1, Answer::Done));
            machine.lines();
            followed(&mut machine, board, name, seconds)?;
        }
        let counts = machine.counts();
        assert_eq!((counts.damaged, counts.lost), (0, 0), "{}", board.name);
        Ok(())
    })
}

fn followed(
    machine: &mut Machine,
    board: &Board,
    name: SceneName,
    seconds: u32,
) -> anyhow::Result<()> {
    let mut show = show(board, name);
    loop {
        let frame = machine.next_frame()?;
        assert_eq!(frame.dropped, 0, "{}: {frame:?}", board.name);
        assert_eq!(
            frame,
            show.expected(&frame),
            "{}: {}",
            board.name,
            name.name()
        );
        if frame.report.step >= u64::from(seconds * TICK_RATE) {
            break;
        }
    }

    let changes = show
        .news
        .iter()
        .filter(|(_, news)| matches!(news, PlannerEvent::Shown(..)))
        .count();
    machine.send(2, Command::AskPlan)?;
    let (2, Answer::Planned(answer)) = machine.next_answer()? else {
        panic!("no plan")
    };
    let lines: Vec<_> = machine.lines().into_iter().map(|line| line.text).collect();
    let logged = |head: &str| lines.iter().filter(|line| line.starts_with(head)).count();
    let plan = show.news.iter().find_map(|(_, news)| match news {
        PlannerEvent::Found(Ok(plan)) => Some(plan),
        _ => None,
    });
    println!(
        "{} {}: {} changes, {plan:?}",
        board.name,
        name.name(),
        changes
    );

    assert_eq!(
        name == SceneName::Frequencies,
        plan.is_none(),
        "{}: {} {lines:#?}",
        board.name,
        name.name()
    );
    let Some(plan) = plan else { return Ok(()) };
    let Some(Ok(answered)) = answer.and_then(|answer| answer.found) else {
        panic!("{answer:?}")
    };

    let known = |plan: &Plan| (plan.method, plan.steps, plan.error, plan.cost, plan.limit);
    assert_eq!(
        known(&answered),
        known(plan),
        "{}: {}",
        board.name,
        name.name()
    );

    // The lines at the start may have arrived before the first frame of the scene.
    assert!(
        logged("plan: ") == 1 && (changes..=1 + changes).contains(&logged("shown: ")),
        "{lines:#?}"
    );
    assert_eq!(
        changes > 0,
        name == SceneName::Beats2To1 && plan.method != Method::Extrapolation10Fixed64,
        "{lines:#?}"
    );
    Ok(())
}
