//! The scenes on the emulated boards: the panel shows what the host draws, within the budgets.

use crate::support::{application, on};
use cycles::{Core, Cost, Image};
use firmware::config::TICK_RATE;
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;
use host_tests::commands::count::FrameProfile;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::budgets;
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::{Lockstep, Screenshot};
use rayon::prelude::*;

/// Every so many frames the panel is compared.
const EVERY: u32 = 25;
/// Frames after the start whose cost is not watched.
const SETTLING: u32 = 6;

/// Frames of a scene that are watched. On the M3 the butterfly's curve grows, and the most expensive one comes after 10 s.
fn watched(board: &Board, name: SceneName) -> u32 {
    match (board.core(), name) {
        (Core::M3, SceneName::Butterfly) => 10 * TICK_RATE,
        _ => 3 * EVERY,
    }
}

#[test]
fn every_scene_is_the_hosts_and_keeps_within_its_share_of_a_frame() -> anyhow::Result<()> {
    let boards: Vec<_> = BOARDS.iter().filter(|board| board.has_panel).collect();
    let too_costly = boards.into_par_iter().map(too_costly).collect::<Result<Vec<_>, _>>()?.concat();
    assert!(too_costly.is_empty(), "{too_costly:#?}");
    Ok(())
}

/// The scenes that take more of a frame of `board` than they may; on the way its panel is compared with the host's.
///
/// The cycles of a scene are estimated: instructions, counted by the board's clock, of the most expensive screenshot, times the
/// cycles that an instruction takes on average in a screenshot that QEMU logs whole, by the published timings.
fn too_costly(board: &Board) -> anyhow::Result<Vec<String>> {
    let mut too_costly = Vec::new();
    let image = Image::read(&application(board))?;
    let mut machine = on(board, Lockstep::start)?;
    for &name in SceneName::ALL {
        machine.machine().serial.send(&Choose { request: 1, scene: name.code() })?;
        while !matches!(machine.next_frame()?, Frame { scene, step: ..6, .. } if scene == name.code()) {}
        let mut show = Show::on(board.processor(), name, &name.first_settings()).expect("a scene of the catalogue");
        let (mut scene, mut busy) = (0, 0);
        for number in 1..=watched(board, name) {
            let frame = machine.next_frame()?;
            assert_eq!((frame.scene, frame.dropped), (name.code(), 0), "{}: {}", board.name, name.name());
            // The first frames pay for the start.
            if number > SETTLING {
                (scene, busy) = (scene.max(frame.scene_cycles), busy.max(frame.busy_cycles));
            }
            if number % EVERY == 0 {
                assert_eq!(frame, show.expected(&frame), "{}", board.name);
                let screenshot = machine.screenshot()?;
                assert!(screenshot == Screenshot::from(&show.frame()), "{}: {frame:?}\n{screenshot:?}", board.name);
            }
        }
        // Far below its budget, as test `budgets` finds.
        if board.core() == Core::M4F {
            continue;
        }
        let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
        let showing = profile.showing.cycles;
        if board.core() == Core::M3 && showing > budgets::SHOWING {
            too_costly.push(format!("{}: {} is drawn and sent in {showing} cycles", board.name, name.name()));
        }
        let Cost { instructions, cycles, .. } = profile.whole;
        let cycles_per_instruction = cycles as f64 / instructions as f64;
        let [scene, busy] =
            [scene, busy].map(|cycles| f64::from(cycles) / f64::from(board.hertz) / board.instruction());
        let frame = f64::from(board.processor_hertz()) / f64::from(TICK_RATE);
        let share = |instructions: f64| instructions * cycles_per_instruction / frame;
        println!(
            "{:15} {:12} scene {scene:7.0} instructions of {cycles_per_instruction:.2} cycles, {:4.1} % of a frame; \
                 all {busy:7.0}, idle {:4.1} %",
            board.name,
            name.name(),
            100.0 * share(scene),
            100.0 * (1.0 - share(busy)),
        );
        if share(scene) > budgets::SCENE {
            too_costly.push(format!("{}: {} takes {:.3} of a frame", board.name, name.name(), share(scene)));
        }
        if 1.0 - share(busy) < budgets::IDLE {
            too_costly.push(format!("{}: {} leaves {:.3} of a frame", board.name, name.name(), 1.0 - share(busy)));
        }
    }
    Ok(too_costly)
}
