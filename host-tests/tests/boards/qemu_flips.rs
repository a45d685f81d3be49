//! The map of flips on the emulated boards, with a floating-point unit and without: frame by frame, and finished, the host's.

use crate::support::{application, on};
use cycles::{Cost, Image};
use firmware::config::TICK_RATE;
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::graphics::fade_layer::FadeLayer;
use firmware::motion::settings::Settings;
use firmware::motion::simulation::Means;
use firmware::protocol::Choose;
use firmware::scenes::SceneName;
use firmware::scenes::flips::Flips;
use firmware::scenes::scene::Scene;
use host_tests::commands::count::FrameProfile;
use host_tests::emulator::boards::{BOARDS, Board, STM32F405};
use host_tests::emulator::budgets;
use host_tests::emulator::qemu::{Lockstep, Screenshot};
use rayon::prelude::*;

/// A frame with the map half done is compared, too.
const EARLY: u32 = 100;

/// The map is finished within so long, s: on the chip of 168 MHz, and on those without a floating-point unit or slower.
fn goal(board: &Board) -> f64 {
    if *board == STM32F405 { 5.0 } else { 60.0 }
}

/// Frame by frame, begun and, where that takes seconds only, finished; no frame is late on the way, and there are cycles left in
/// each, as their number is estimated.
#[test]
fn the_map_of_a_board_is_the_hosts() -> anyhow::Result<()> {
    [(&BOARDS[0], 1), (&STM32F405, 2)].into_par_iter().try_for_each(|(board, frames)| map_is_the_hosts(board, frames))
}

#[test]
#[ignore = "minutes: every board to the end of its map"]
fn the_map_of_every_board_is_the_hosts() -> anyhow::Result<()> {
    BOARDS.par_iter().try_for_each(|board| map_is_the_hosts(board, 2))
}

/// The first `compared` of the frames that the host has played.
fn map_is_the_hosts(board: &Board, compared: usize) -> anyhow::Result<()> {
    let image = Image::read(&application(board))?;
    let mut machine = on(board, Lockstep::start)?;
    // The link is up once a frame has come.
    machine.next_frame()?;
    machine.machine().serial.send(&Choose { request: 1, scene: SceneName::Flips.code() })?;
    let frames = played(board);
    let (mut busy, mut cycles_per_instruction) = (0, 0.0);
    for &(ticks, ref expected) in &frames[..compared] {
        let mut frame = machine.next_frame()?;
        while frame.scene != SceneName::Flips.code() || frame.step < ticks {
            frame = machine.next_frame()?;
            busy = busy.max(frame.busy_cycles);
        }
        assert_eq!((frame.step, frame.dropped), (ticks, 0), "{}: no frame is delayed", board.name);
        if board.has_panel {
            assert!(shows(&machine.screenshot()?, expected), "{} after {ticks} ticks", board.name);
        }
        if ticks == EARLY {
            let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
            let Cost { instructions, cycles, .. } = profile.whole;
            cycles_per_instruction = cycles as f64 / instructions as f64;
        }
    }
    let [_, (ticks, _)] = frames;
    let seconds = f64::from(ticks) / f64::from(TICK_RATE);
    let instructions = f64::from(busy) / f64::from(board.hertz) / board.instruction();
    let share = instructions * cycles_per_instruction * f64::from(TICK_RATE) / f64::from(board.processor_hertz());
    println!("{}: {seconds:.1} s, {:.1} % of the highest frame", board.name, 100.0 * share);
    assert!(seconds <= goal(board), "{}: {seconds} s", board.name);
    assert!(1.0 - share >= budgets::IDLE, "{}: {share:.3} of a frame", board.name);
    Ok(())
}

/// The frame early on, and that of the finished map, on the host, each with its tick.
fn played(board: &Board) -> [(u32, Canvas); 2] {
    let (mut ink, mut ticks) = (FadeLayer::NONE, 0);
    let means = Means { processor: board.processor(), method: None };
    let mut scene = Flips::new(&Settings::default(), &means).expect("good settings");
    let mut until = |done: &dyn Fn(&Flips, u32) -> bool| {
        while !done(&scene, ticks) {
            scene.tick(&mut ink);
            ticks += 1;
        }
        let mut canvas = ink.frame().clone();
        scene.draw(&scene.report(), &mut canvas);
        (ticks, canvas)
    };
    [until(&|_, ticks| ticks == EARLY), until(&|scene, _| scene.is_done())]
}

fn shows(screenshot: &Screenshot, canvas: &Canvas) -> bool {
    let grey = |i: usize| canvas.get((i % WIDTH) as i32, (i / WIDTH) as i32);
    (0..WIDTH * HEIGHT).all(|i| grey(i) == screenshot.greys().get(i).copied())
}
