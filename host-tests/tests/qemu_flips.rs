//! The map of flips on the emulated boards, with a floating-point unit and without: frame by frame, and finished, the host's.

mod support;

use double_pendulum::form::{DirectionForm, Fixed32Form, Plain, Watched};
use firmware::config::{FLIPS_M3, FLIPS_M4F, FlipsPace};
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::graphics::fade_layer::FadeLayer;
use firmware::motion::settings::Settings;
use firmware::protocol::Choose;
use firmware::scenes::SceneName;
use firmware::scenes::flips::FlipsMap;
use firmware::scenes::scene::Scene;
use host_tests::emulator::boards::{BOARDS, Core};
use host_tests::emulator::qemu::{Lockstep, QemuError, Screenshot};
use support::{application, settings, toolchain};

/// A frame with the map half done is compared, too.
const EARLY: u32 = 100;

#[test]
fn the_map_of_a_board_is_the_hosts() -> Result<(), QemuError> {
    BOARDS.iter().filter(|board| board.has_panel).try_for_each(|board| {
        let (toolchain, elf) = (toolchain(), application(board));
        let mut machine = Lockstep::start(&settings(&toolchain, board, &elf))?;
        machine.machine().serial.send(&Choose { request: 1, scene: SceneName::Flips.code() })?;
        let frames = match board.core() {
            Core::M3 => played::<Fixed32Form>(FLIPS_M3),
            Core::M4F => played::<DirectionForm<f32, Plain>>(FLIPS_M4F),
        };
        for (ticks, expected) in frames {
            let (mut frame, mut late) = (machine.next_frame()?, 0);
            while frame.scene != SceneName::Flips.code() || frame.step < ticks {
                frame = machine.next_frame()?;
                late = frame.dropped;
            }
            assert_eq!((frame.step, late), (ticks, 0), "{}: no frame is delayed", board.name);
            assert!(shows(&machine.screenshot()?, &expected), "{} after {ticks} ticks", board.name);
        }
        Ok(())
    })
}

/// The frame early on, and that of the finished map, on the host, each with its tick.
fn played<F: Watched<f32>>(pace: FlipsPace) -> [(u32, Canvas); 2] {
    let (mut ink, mut ticks) = (FadeLayer::NONE, 0);
    let mut scene = FlipsMap::<F>::at_pace(&Settings::default(), pace).expect("good settings");
    let mut until = |done: &dyn Fn(&FlipsMap<F>, u32) -> bool| {
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
