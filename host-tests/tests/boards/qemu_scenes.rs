//! The scenes on the emulated boards: the panel shows what the host draws, within the budgets, garbage or not.

use crate::support::{application, on};
use cycles::Core;
use cycles::{Cost, Image};
use fastrand::Rng;
use firmware::config::TICK_RATE;
use firmware::graphics::canvas::{HEIGHT, WIDTH};
use firmware::protocol::{Choose, Done, Frame};
use firmware::scenes::SceneName;
use host_tests::commands::count::FrameProfile;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::budgets;
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::{Lockstep, Machine};
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

/// Chooses a scene; the first frame of it.
fn choose(machine: &mut Lockstep, name: SceneName) -> anyhow::Result<Frame> {
    machine.machine().serial.send(&Choose { request: 1, scene: name.code() })?;
    loop {
        let frame = machine.next_frame()?;
        if frame.scene == name.code() && frame.time < 0.1 {
            return Ok(frame);
        }
    }
}

/// The panel shows of `board` what the host draws in the same tick.
fn compare(machine: &mut Lockstep, board: &Board, frame: &Frame, show: &mut Show) -> anyhow::Result<()> {
    let ticks = (frame.time * f64::from(TICK_RATE)).round();
    while show.report().time < ticks / f64::from(TICK_RATE) - 1e-9 {
        show.tick();
    }
    let (canvas, screenshot) = (show.frame(), machine.screenshot()?);
    let host = (0..WIDTH * HEIGHT).map(|i| canvas.get((i % WIDTH) as i32, (i / WIDTH) as i32));
    let is_same = host.eq(screenshot.greys().iter().copied().map(Some));
    assert!(is_same, "{}: {} at {} s\n{screenshot:?}", board.name, frame.scene, frame.time);
    Ok(())
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
        choose(&mut machine, name)?;
        let mut show = Show::on(board.processor(), name, &name.first_settings()).expect("a scene of the catalogue");
        // The map of flips is computed in another arithmetic and at another pace where there is a floating-point unit: test
        // `qemu_flips`.
        let is_compared = name != SceneName::Flips || board.core() != Core::M4F;
        let (mut scene, mut busy) = (0, 0);
        for number in 1..=watched(board, name) {
            let frame = machine.next_frame()?;
            assert_eq!((frame.scene, frame.dropped), (name.code(), 0), "{}: {}", board.name, name.name());
            // The first frames pay for the start.
            if number > SETTLING {
                (scene, busy) = (scene.max(frame.scene_cycles), busy.max(frame.busy_cycles));
            }
            if is_compared && number % EVERY == 0 {
                compare(&mut machine, board, &frame, &mut show)?;
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

/// Messages waited for until a command is repeated.
const PATIENCE: usize = 60;

#[test]
fn garbage_on_the_link_disturbs_nothing() -> anyhow::Result<()> {
    let mut machine = on(&BOARDS[0], Machine::start)?;
    let mut rng = Rng::with_seed(7);
    for frame in 0..15 * TICK_RATE {
        let length = rng.usize(..600);
        let garbage: Vec<u8> = std::iter::repeat_with(|| rng.u8(..)).take(length).collect();
        machine.serial.send_bytes(&garbage)?;
        let received: Frame = machine.wait_for()?;
        assert_eq!((received.sequence, received.dropped), (frame, 0));
    }
    assert_eq!((machine.serial.counts().damaged, machine.serial.counts().lost), (0, 0));
    // The flood still waits in the host's pipe, on a busy machine for many seconds, and fills the board's queue, which
    // may cost a command: it is repeated until it is answered. Two delimiters end what the garbage left unfinished.
    loop {
        machine.serial.send_bytes(&[0, 0])?;
        machine.serial.send(&Choose { request: 5, scene: SceneName::Figure7.code() })?;
        for _ in 0..PATIENCE {
            if let Some(done) = machine.receive()?.read::<Done>() {
                assert_eq!(done.request, 5);
                return machine.quit();
            }
        }
    }
}
