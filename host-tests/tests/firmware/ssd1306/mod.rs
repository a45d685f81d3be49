//! The one-colour panel: its frame, and its driver against controllers that are stricter than the real ones.

mod bus;

use embedded_hal::i2c::ErrorKind;
use fastrand::Rng;
use firmware::config::{STM32F405, TICK_RATE};
use firmware::display::{By, Controller as Name, Display, Found, SILENCE, Ssd1306, Ssd1306Error};
use firmware::graphics::{Bitmap, Canvas, HEIGHT, WIDTH};
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::Screenshot;

use crate::bench::places;
use bus::{BYTE, Controller, Kind, Line, SH1106, SILENT, SSD1306};

/// Bits that 400 kHz carry in a tick.
const TICK: u32 = 400_000 / TICK_RATE;
/// As much time as any frame needs, with all that wakes the panel.
const LONG: u32 = 4 * TICK;

type Panel = Ssd1306<Line>;

/// The driver of such a panel.
fn panel(controller: Controller) -> Panel {
    Ssd1306::new(Line::to(controller), None)
}

/// Sends a frame, and lets the bus have the time of so many bits.
fn flush(panel: &mut Panel, frame: &Canvas, bits: u32) -> Result<(), Ssd1306Error> {
    let told = panel.flush(frame);
    panel.bus.run(bits);
    told
}

fn shows(panel: &Panel, frame: &Canvas) -> bool {
    panel.bus.panel.shows(&Bitmap::from(frame))
}

fn shown(name: SceneName) -> Show {
    Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue")
}

/// The application's first scene after some ticks.
fn scene(ticks: u32) -> Canvas {
    let mut show = shown(SceneName::Page);
    (0..ticks).for_each(|_| show.tick());
    show.frame()
}

#[test]
fn black_is_dark_and_the_upper_half_of_the_greys_is_solid_but_in_a_picture() {
    for (all_greys, lit) in [
        (
            false,
            [0, 0, 0, 3, 6, 8, 11, 14, 16, 16, 16, 16, 16, 16, 16, 16],
        ),
        (
            true,
            [0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16],
        ),
    ] {
        for (grey, lit) in (0..).zip(lit) {
            let mut canvas = Canvas {
                all_greys,
                ..Canvas::default()
            };
            places().for_each(|(x, y)| canvas.update(x, y, |_| grey));
            let ones: u32 = Bitmap::from(&canvas)
                .pages
                .as_flattened()
                .iter()
                .map(|byte| byte.count_ones())
                .sum();
            assert_eq!(
                ones * 16 / (WIDTH * HEIGHT) as u32,
                lit,
                "pixels of 16 at {grey}, in a picture: {all_greys}"
            );
        }
    }
}

#[test]
fn every_pixel_is_in_its_place() {
    for (x, y) in [(0, 0), (127, 0), (0, 63), (127, 63), (5, 9), (64, 32)] {
        let mut canvas = Canvas::default();
        canvas.update(x, y, |_| 15);
        assert!(
            Screenshot::from_pages(Bitmap::from(&canvas).pages.as_flattened())
                == Screenshot::from(&canvas)
        );
    }
}

/// A frame of these pixels.
fn pixels(mut is_lit: impl FnMut() -> bool) -> Canvas {
    let mut canvas = Canvas::default();
    places()
        .filter(|_| is_lit())
        .for_each(|(x, y)| canvas.update(x, y, |_| 15));
    canvas
}

#[test]
fn the_panel_shows_each_picture_at_either_address() {
    let mut rng = Rng::with_seed(1);
    // Whole frames of noise, and a few pixels here and there.
    let noise = [2, 2, 1000, 300, 100, 30, 10, 3].map(|rarity| pixels(|| rng.u32(..rarity) == 0));
    let frames: Vec<_> = [0, 1, 2, 30, 31, 400]
        .map(scene)
        .into_iter()
        .chain(noise)
        .collect();
    for (kind, address) in [
        (SSD1306, 0x3C),
        (SSD1306, 0x3D),
        (SH1106, 0x3C),
        (SH1106, 0x3D),
        (SILENT, 0x3C),
    ] {
        let mut panel = panel(Controller::new(kind, address));
        for (number, frame) in frames.iter().enumerate() {
            // It is looked for, asked and woken with the first frame, at the second address with one more.
            for _ in 0..if number == 0 { FIRST + 1 } else { 1 } {
                assert_eq!(flush(&mut panel, frame, LONG), Ok(()));
            }
            assert!(
                shows(&panel, frame),
                "frame {number}, {kind:?} at {address:#04x}"
            );
        }
    }
}

/// Frames until a panel at the first address shows one.
const FIRST: u32 = 3;

#[test]
fn controllers_are_told_apart_or_the_build_says_which_it_is() {
    let says = |status, kind: Kind| Kind {
        status: Some(status),
        ..kind
    };
    let other = |status| says(status, SSD1306);
    let by = |status: u8, controller| Found {
        controller,
        by: By::Status(status),
    };
    let built = |controller| Found {
        controller,
        by: By::Build,
    };
    for (kind, built_for, found, told) in [
        (SSD1306, None, by(0x46, Name::Ssd1306), Ok(())),
        (other(0x03), None, by(0x43, Name::Ssd1306), Ok(())),
        (SH1106, None, by(0x48, Name::Sh1106), Ok(())),
        (other(0x00), None, by(0x40, Name::Ssd1306), Ok(())),
        (SILENT, None, Found::SILENT, Ok(())),
        (
            says(0x06, SH1106),
            Some(Name::Sh1106),
            built(Name::Sh1106),
            Ok(()),
        ),
        (
            other(0x08),
            Some(Name::Ssd1306),
            built(Name::Ssd1306),
            Ok(()),
        ),
        (
            other(0x07),
            None,
            by(0x47, Name::Sh1107),
            Err(Ssd1306Error::Sh1107),
        ),
        (
            other(0x0F),
            None,
            by(0x4F, Name::Sh1107),
            Err(Ssd1306Error::Sh1107),
        ),
    ] {
        let line = Line::to(Controller::new(kind, 0x3C).plugged(false));
        let (mut panel, frame, mut all_found) =
            (Ssd1306::new(line, built_for), scene(1), Vec::new());
        // It is plugged in later, looked for within a second, and found once.
        for number in 0..3 * TICK_RATE {
            panel.bus.panel.plugged_in = number > FIRST;
            let _ = flush(&mut panel, &frame, LONG);
            all_found.extend(panel.found());
        }
        assert_eq!(
            (panel.flush(&frame), &all_found[..]),
            (told, &[found][..]),
            "{kind:?}"
        );
        assert_eq!(shows(&panel, &frame), told.is_ok(), "{kind:?}");
    }
}

/// Bits of columns of a page: an address, what follows, and the place; an address, what follows, and the bytes.
const fn bits(columns: u32) -> u32 {
    (1 + 5 * BYTE) + (1 + (2 + columns) * BYTE)
}

#[test]
fn what_has_not_changed_is_not_sent_but_for_the_part_that_is_sent_again() {
    let (mut panel, mut canvas) = (panel(Controller::new(SSD1306, 0x3C)), scene(30));
    let taken = [&[][..], &[], &[], &[], &[20], &[20, 90]].map(|changed| {
        changed
            .iter()
            .for_each(|&x| canvas.update(x, 7, |grey| 15 - grey));
        assert_eq!(flush(&mut panel, &canvas, LONG), Ok(()));
        panel.bus.taken
    });
    assert_eq!(
        taken[3..],
        [0, 1, 2].map(|changed| changed * bits(1) + bits(16) + 1),
        "and the stop"
    );
}

/// Ticks for which the panel is away: between two of them, for so short a time that nobody misses an answer, in one, for longer.
const AWAY: [u32; 5] = [0, 0, 1, 50, 100];
/// Moments in each run, which lasts 40 s.
const MOMENTS: usize = 15;
/// Ticks in which the picture must be back: 2 s.
const BACK: u32 = 2 * TICK_RATE;

/// A frame is held back by nothing but the bus: by what the one before has left to send when it comes.
#[test]
fn as_many_frames_are_shown_as_the_bus_can_carry_within_two_seconds_of_plugging_the_panel_in() {
    let runs = [SSD1306, SH1106]
        .into_iter()
        .flat_map(|kind| [false, true].map(|is_paused| (kind, is_paused)));
    for ((kind, is_paused), &name) in
        runs.flat_map(|run| SceneName::ALL.iter().map(move |name| (run, name)))
    {
        let (mut panel, mut held, mut scene) = (
            panel(Controller::new(kind, 0x3C)),
            Canvas::default(),
            shown(name),
        );
        let (mut longest, mut most) = (0, 0);
        let run = format!(
            "{:12} paused {is_paused}, {} columns",
            name.name(),
            kind.columns
        );
        // Whether the panel shows the last frame when the next one comes; not if the bus is still busy with that.
        let mut tick = |panel: &mut Panel| {
            if !is_paused {
                scene.tick();
            }
            let (was_idle, sent, is_shown) =
                (panel.bus.is_idle(), panel.bus.sent, shows(panel, &held));
            let frame = scene.frame();
            let _ = flush(panel, &frame, TICK);
            if was_idle {
                held = frame;
            } else {
                assert_eq!(panel.bus.sent, sent, "it disturbs the one before");
            }
            was_idle && is_shown
        };
        for (away, moment) in AWAY
            .into_iter()
            .zip([97, 101, 83, 89, 103])
            .cycle()
            .take(MOMENTS)
        {
            let back = (0..BACK).find(|_| tick(&mut panel));
            longest = longest.max(back.unwrap_or_else(|| panic!("{run}: it is not back")));
            for _ in 0..moment {
                assert!(tick(&mut panel), "{run}");
                most = most.max(panel.bus.taken);
            }
            panel.bus.panel = Controller::new(kind, 0x3C).plugged(false);
            for _ in 0..away {
                tick(&mut panel);
            }
            panel.bus.panel.plugged_in = true;
        }
        println!(
            "{run}: {:.1} ms at most, back after {longest} ticks at most",
            f64::from(most) / 400.0
        );
    }
}

#[test]
fn a_panel_whose_bus_is_too_slow_says_so() {
    let mut rng = Rng::with_seed(2);
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let mut second = |is_noisy: bool| {
        let mut still = Canvas::default();
        let mut told = Ok(());
        for _ in 0..2 * TICK_RATE {
            if is_noisy {
                still = pixels(|| rng.bool());
            }
            told = flush(&mut panel, &still, TICK);
        }
        told
    };
    assert_eq!(second(false), Ok(()));
    // A whole frame takes a tick and a half, and the next one comes after two.
    assert_eq!(
        second(true),
        Err(Ssd1306Error::Slow {
            shown: TICK_RATE / 2
        })
    );
    assert_eq!(second(false), Ok(()));
}

#[test]
fn an_absent_panel_is_looked_for_once_a_second_and_may_come_and_go() {
    let plug = |panel: &mut Panel, plugged_in| {
        panel.bus.panel = Controller::new(SSD1306, 0x3C).plugged(plugged_in)
    };
    let flush = |panel: &mut Panel, ticks| flush(panel, &scene(ticks), TICK);
    let mut panel = panel(Controller::new(SSD1306, 0x3C).plugged(false));
    let absent = Err(Ssd1306Error::Absent(SILENCE));
    // No answer at the first address, nor at the second.
    assert_eq!(
        [1; 3].map(|ticks| flush(&mut panel, ticks)),
        [Ok(()), Ok(()), absent]
    );
    for _ in 0..TICK_RATE {
        assert_eq!(flush(&mut panel, 1), absent);
    }
    assert_eq!(panel.bus.sent, 2, "no other try within the second");
    assert_eq!((flush(&mut panel, 1), panel.bus.sent), (absent, 3));

    for (ticks, before) in [(1, absent), (4, Err(Ssd1306Error::Lost))] {
        plug(&mut panel, true);
        let told: Vec<_> = (0..TICK_RATE + 10)
            .map(|_| flush(&mut panel, ticks))
            .collect();
        assert!(
            told.contains(&before) && told.last() == Some(&Ok(())),
            "within a second"
        );
        assert!(shows(&panel, &scene(ticks)));
        plug(&mut panel, false);
        assert_eq!(
            [2, 3].map(|ticks| flush(&mut panel, ticks)),
            [Ok(()), Err(Ssd1306Error::Lost)]
        );
    }
}

#[test]
fn a_bus_that_hangs_holds_up_nothing_and_is_freed() {
    let flush = |panel: &mut Panel, ticks| flush(panel, &scene(ticks), TICK);
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    (0..5).for_each(|ticks| assert_eq!(flush(&mut panel, ticks), Ok(())));
    panel.bus.hangs = true;
    let told: Vec<_> = (5..20).map(|ticks| flush(&mut panel, ticks)).collect();
    assert!(
        told.starts_with(&[Ok(()); 5]) && told.ends_with(&[Err(Ssd1306Error::Lost); 5]),
        "{told:?}"
    );
    assert_eq!(panel.bus.freed, 1);
    // As long as it hangs it is freed once a second.
    for _ in 0..2 * TICK_RATE {
        let _ = flush(&mut panel, 20);
    }
    assert_eq!(
        (flush(&mut panel, 20), panel.bus.freed),
        (Err(Ssd1306Error::Absent(ErrorKind::Other)), 2)
    );
    panel.bus.hangs = false;
    let told = (0..TICK_RATE + 10).map(|_| flush(&mut panel, 21)).last();
    assert!(told == Some(Ok(())) && shows(&panel, &scene(21)));
}
