//! The one-colour panel: its frame, and its driver against a controller that is stricter than the real one.

mod bus;
mod controller;

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use fastrand::Rng;
use firmware::app::player::Player;
use firmware::config::{STM32F405, TICK_RATE};
use firmware::display::{Display, Ssd1306, Ssd1306Error};
use firmware::graphics::bitmap::Bitmap;
use firmware::graphics::canvas::{Canvas, HEIGHT, WIDTH};
use firmware::graphics::frame_buffers::FrameBuffers;
use firmware::motion::settings::Settings;
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

use bus::{BYTE, Bus, Line};
use controller::Controller;

/// No answer.
const SILENCE: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
/// Bits that 400 kHz carry in a tick.
const TICK: u32 = 400_000 / TICK_RATE;
/// As much time as any frame needs, with all that wakes the panel.
const LONG: u32 = 4 * TICK;

/// The application's first scene after some ticks.
fn scene(ticks: u32) -> Canvas {
    let FrameBuffers { mut canvas, mut ink } = FrameBuffers::default();
    let mut player = Player::new(Settings::default(), &mut ink).expect("the default settings are a pendulum");
    (0..ticks).for_each(|_| player.tick(|_| ()));
    player.draw(&mut canvas);
    canvas
}

#[test]
fn black_is_dark_and_the_upper_half_of_the_greys_is_solid() {
    let share = |grey: u8, all_greys: bool| {
        let mut canvas = Canvas::default();
        if all_greys {
            canvas.use_all_greys();
        }
        (0..HEIGHT as i32).for_each(|y| (0..WIDTH as i32).for_each(|x| canvas.update(x, y, |_| grey)));
        let bitmap = Bitmap::from(&canvas);
        bitmap.pages().as_flattened().iter().map(|byte| byte.count_ones()).sum::<u32>() as usize * 16 / (WIDTH * HEIGHT)
    };
    let shares: Vec<_> = (0..16).map(|grey| share(grey, false)).collect();
    assert_eq!(shares, [0, 0, 0, 3, 6, 8, 11, 14, 16, 16, 16, 16, 16, 16, 16, 16], "lit pixels of 16");
    let shares: Vec<_> = (0..16).map(|grey| share(grey, true)).collect();
    assert_eq!(shares, [0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16], "lit pixels of 16 in a picture");
}

#[test]
fn every_pixel_is_in_its_place() {
    for (x, y) in [(0, 0), (127, 0), (0, 63), (127, 63), (5, 9), (64, 32)] {
        let mut canvas = Canvas::default();
        canvas.update(x, y, |_| 15);
        let bitmap = Bitmap::from(&canvas);
        let lit = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))).filter(|&(x, y)| bitmap.is_lit(x, y));
        assert_eq!(lit.collect::<Vec<_>>(), [(x as usize, y as usize)]);
    }
}

/// A frame of these pixels.
fn pixels(mut is_lit: impl FnMut() -> bool) -> Canvas {
    let mut canvas = Canvas::default();
    let places = (0..HEIGHT as i32).flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)));
    places.filter(|_| is_lit()).for_each(|(x, y)| canvas.update(x, y, |_| 15));
    canvas
}

#[test]
fn the_panel_shows_each_picture_at_either_address() {
    let mut rng = Rng::with_seed(1);
    // Whole frames of noise, and a few pixels here and there.
    let noise = [2, 2, 1000, 300, 100, 30, 10, 3].map(|rarity| pixels(|| rng.u32(..rarity) == 0));
    let frames: Vec<_> = [0, 1, 2, 30, 31, 400].map(scene).into_iter().chain(noise).collect();
    for address in [0x3C, 0x3D] {
        let line = Line::to(Controller::at(address));
        let mut panel = Ssd1306::new(Bus::new(&line));
        for (number, frame) in frames.iter().enumerate() {
            // It is found by its first frame, at the second address by its second.
            for _ in 0..if number == 0 { 2 } else { 1 } {
                assert_eq!(panel.flush(frame), Ok(()));
                line.borrow_mut().run(LONG);
            }
            assert!(line.borrow().panel.shows(&Bitmap::from(frame)), "frame {number}, at {address:#04x}");
        }
    }
}

#[test]
fn what_has_not_changed_is_not_sent() {
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut canvas = scene(30);
    for changed in [&[][..], &[], &[20], &[20, 90]] {
        changed.iter().for_each(|&x| canvas.update(x, 7, |grey| 15 - grey));
        assert_eq!(panel.flush(&canvas), Ok(()));
        line.borrow_mut().run(LONG);
    }
    assert_eq!(line.borrow().sent, 3, "the second frame was the first");
    // Twice an address, what follows, and the window; an address, what follows, and one byte; the stop.
    assert_eq!(line.borrow().taken, 2 * ((1 + 8 * BYTE) + (1 + 3 * BYTE)) + 1);
}

/// Frames of each scene: 5 s.
const FRAMES: u32 = 5 * TICK_RATE;

/// A frame is held back by nothing but the bus: by what the one before has left to send when it comes.
#[test]
fn as_many_frames_are_shown_as_the_bus_can_carry() {
    for &name in SceneName::ALL {
        let line = Line::to(Controller::at(0x3C));
        let mut panel = Ssd1306::new(Bus::new(&line));
        let mut scene = Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue");
        assert_eq!(panel.flush(&scene.frame()), Ok(()));
        line.borrow_mut().run(LONG);
        let (mut shown, mut most, mut held) = (0, 0, Bitmap::from(&scene.frame()));
        for frame in 0..FRAMES {
            scene.tick();
            let canvas = scene.frame();
            let (was_idle, sent) = (line.borrow().is_idle(), line.borrow().sent);
            let _ = panel.flush(&canvas);
            if was_idle {
                assert!(line.borrow().panel.shows(&held), "{}, frame {frame}", name.name());
                (shown, held) = (shown + 1, Bitmap::from(&canvas));
            } else {
                assert_eq!(line.borrow().sent, sent, "{}, frame {frame} disturbs the one before", name.name());
            }
            line.borrow_mut().run(TICK);
            if line.borrow().sent != sent {
                most = most.max(line.borrow().taken);
            }
        }
        line.borrow_mut().run(LONG);
        assert!(line.borrow().panel.shows(&held), "{}", name.name());
        let rate = f64::from(shown * TICK_RATE) / f64::from(FRAMES);
        println!("{:12} {rate:.1} frames a second, {:.1} ms at most", name.name(), f64::from(most) / 400.0);
        assert_eq!(shown, FRAMES, "{}", name.name());
    }
}

#[test]
fn a_panel_whose_bus_is_too_slow_says_so() {
    let mut rng = Rng::with_seed(2);
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut second = |is_noisy: bool| {
        let mut still = Canvas::default();
        let mut told: Vec<_> = (0..2 * TICK_RATE)
            .map(|_| {
                if is_noisy {
                    still = pixels(|| rng.bool());
                }
                let told = panel.flush(&still);
                line.borrow_mut().run(TICK);
                told
            })
            .collect();
        told.pop().expect("a frame")
    };
    assert_eq!(second(false), Ok(()));
    // A whole frame takes a tick and a half, and the next one comes after two.
    assert_eq!(second(true), Err(Ssd1306Error::Slow { shown: TICK_RATE / 2 }));
    assert_eq!(second(false), Ok(()));
}

#[test]
fn an_absent_panel_is_looked_for_once_a_second_and_may_come_and_go() {
    let line = Line::to(Controller::at(0x3C).plugged(false));
    let plug = |plugged_in| line.borrow_mut().panel = Controller::at(0x3C).plugged(plugged_in);
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut flush = |ticks| {
        let told = panel.flush(&scene(ticks));
        line.borrow_mut().run(TICK);
        told
    };
    let absent = Err(Ssd1306Error::Absent(SILENCE));
    assert_eq!(
        [flush(1), flush(1), flush(1)],
        [Ok(()), Ok(()), absent],
        "no answer at the first address, nor at the second"
    );
    for _ in 0..TICK_RATE {
        assert_eq!(flush(1), absent);
    }
    assert_eq!(line.borrow().sent, 2, "no other try within the second");
    assert_eq!(flush(1), absent);
    assert_eq!(line.borrow().sent, 3);

    plug(true);
    let told: Vec<_> = (0..TICK_RATE + 5).map(|_| flush(1)).collect();
    assert!(told.contains(&absent) && told.last() == Some(&Ok(())), "within a second");
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(1))));

    plug(false);
    assert_eq!([flush(2), flush(3)], [Ok(()), Err(Ssd1306Error::Lost)]);
    plug(true);
    let told: Vec<_> = (0..TICK_RATE + 5).map(|_| flush(4)).collect();
    assert!(told.contains(&Err(Ssd1306Error::Lost)) && told.last() == Some(&Ok(())));
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(4))));
}

/// Nothing that is sent fails: it answers again when the next reminder comes.
#[test]
fn a_panel_that_was_without_power_for_a_moment_comes_back_though_the_picture_stands_still() {
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let picture = scene(30);
    assert_eq!(panel.flush(&picture), Ok(()));
    line.borrow_mut().run(LONG);
    line.borrow_mut().panel = Controller::at(0x3C);
    let mut seconds = |seconds: u32| {
        for _ in 0..seconds * TICK_RATE {
            assert_eq!(panel.flush(&picture), Ok(()));
            line.borrow_mut().run(TICK);
            assert!(line.borrow().is_idle(), "the next frame would not be held up");
        }
        (line.borrow().panel.is_on(), line.borrow().panel.shows(&Bitmap::from(&picture)))
    };
    assert_eq!(seconds(1), (true, false), "a part of the picture");
    assert_eq!(seconds(3), (true, true), "all of it");
}

#[test]
fn a_bus_that_hangs_holds_up_nothing_and_is_freed() {
    let line = Line::to(Controller::at(0x3C));
    let mut panel = Ssd1306::new(Bus::new(&line));
    let mut flush = |ticks| {
        let told = panel.flush(&scene(ticks));
        line.borrow_mut().run(TICK);
        told
    };
    (0..5).for_each(|ticks| assert_eq!(flush(ticks), Ok(())));
    line.borrow_mut().hangs = true;
    let told: Vec<_> = (5..20).map(&mut flush).collect();
    assert!(told.starts_with(&[Ok(()); 5]) && told.ends_with(&[Err(Ssd1306Error::Lost); 5]), "{told:?}");
    assert_eq!(line.borrow().freed, 1);
    // As long as it hangs it is freed once a second.
    for _ in 0..2 * TICK_RATE {
        let _ = flush(20);
    }
    assert_eq!((flush(20), line.borrow().freed), (Err(Ssd1306Error::Absent(ErrorKind::Other)), 2));
    line.borrow_mut().hangs = false;
    let told: Vec<_> = (0..TICK_RATE + 10).map(|_| flush(21)).collect();
    assert_eq!(told.last(), Some(&Ok(())));
    assert!(line.borrow().panel.shows(&Bitmap::from(&scene(21))));
}
