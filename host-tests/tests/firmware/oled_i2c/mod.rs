//! The one-colour panel: its frame, and its driver with controllers that are stricter than the real
//! ones.

mod bus;

use std::collections::VecDeque;

use embedded_hal::i2c::ErrorKind;
use emulator::host::Show;
use emulator::qemu::Screenshot;
use fastrand::Rng;
use firmware::config::{STM32F405, TICK_RATE};
use firmware::display::{
    BusFault, By, Controller as Name, Display, Found, OledError, OledI2c, PanelReport, PanelState,
    SILENCE,
};
use firmware::graphics::{Bitmap, Canvas, Format, Palette};
use firmware::scenes::SceneName;

use crate::bench::{blank, places};
use bus::{
    BLIND, BYTE, Controller, IDEAL, Kind, Line, SH1106, SH1107, SILENT, SSD1306, Says, USUAL, WORST,
};

/// A number of bits that is larger than any frame needs, including the settings that wake the
/// panel.
const LONG: u32 = 4 * 400_000 / TICK_RATE;
/// The largest number of frames until a panel at the first address shows one.
const FIRST: u32 = 6;
/// The largest number of frames until a panel is back: 2 s.
const BACK: u32 = 2 * TICK_RATE;

const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;

type Panel = OledI2c<'static, Line>;

/// Returns a driver of this panel.
fn panel(controller: Controller) -> Panel {
    on(Line::to(controller), None)
}

/// Returns a driver of the panel on this bus, with the controller that the build has chosen, if
/// any.
fn on(line: Line, chosen: Option<Name>) -> Panel {
    OledI2c::new(line, Box::leak(Box::new(Bitmap::BLACK)), chosen)
}

/// Sends a frame, and advances the time of the bus by `bits` bits.
fn flush(panel: &mut Panel, frame: &Canvas, bits: u32) -> Result<(), OledError> {
    let result = panel.flush(frame);
    panel.bus.run(bits);
    result
}

/// Sends a frame, and advances the time by a tick.
fn tick(panel: &mut Panel, frame: &Canvas) -> Result<(), OledError> {
    let result = panel.flush(frame);
    panel.bus.run_tick();
    result
}

/// Returns true if the memory of the panel has exactly the picture of the frame.
fn shows(panel: &Panel, frame: &Canvas) -> bool {
    panel.bus.panel.shows(&Bitmap::from(frame))
}

/// Returns the scene with its own initial settings, on the fastest class of processors.
fn shown(name: SceneName) -> Show {
    Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue")
}

/// Returns the frame of the application's first scene after some ticks.
fn scene(ticks: u32) -> Canvas<'static> {
    let mut show = shown(SceneName::Page);
    (0..ticks).for_each(|_| show.tick());
    show.player.draw();
    show.player.canvas
}

/// A canvas of one grey has a fixed share of lit pixels for each grey, in sixteenths. In a scene
/// with all greys the share grows evenly.
#[test]
fn greys_become_patterns_of_pixels() {
    // The number of lit pixels out of 16 for each grey. A scene with all greys spreads them evenly.
    for (palette, lit) in [
        (
            Palette::Trail,
            [0, 0, 0, 3, 6, 8, 11, 14, 16, 16, 16, 16, 16, 16, 16, 16],
        ),
        (
            Palette::Map,
            [0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16],
        ),
    ] {
        for (grey, lit) in (0..).zip(lit) {
            let mut canvas = blank();
            canvas.blank(palette);
            canvas.on_ink();
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
                "pixels of 16 at {grey}, {palette:?}"
            );
        }
    }
}

/// Pixels in the corners and elsewhere have the same place in the bitmap's pages as on the canvas.
#[test]
fn every_pixel_is_in_its_place() {
    for (x, y) in [(0, 0), (127, 0), (0, 63), (127, 63), (5, 9), (64, 32)] {
        let mut canvas = blank();
        canvas.update(x, y, |_| 15);
        assert!(
            Screenshot::from_pages(Bitmap::from(&canvas).pages.as_flattened())
                == Screenshot::from(&canvas)
        );
    }
}

/// Returns a frame with these pixels.
fn pixels(mut is_lit: impl FnMut() -> bool) -> Canvas<'static> {
    let mut canvas = blank();
    places()
        .filter(|_| is_lit())
        .for_each(|(x, y)| canvas.update(x, y, |_| 15));
    canvas
}

/// Each kind of controller, at both addresses, shows every frame completely: scenes, and noise of
/// any density.
#[test]
fn the_panel_shows_each_picture_at_either_address() {
    let mut rng = Rng::with_seed(1);

    // Whole frames of noise, and frames with a few pixels.
    let noise = [2, 2, 1000, 300, 100, 30, 10, 3].map(|rarity| pixels(|| rng.u32(..rarity) == 0));
    let frames: Vec<_> = [0, 1, 2, 30, 31, 400]
        .map(scene)
        .into_iter()
        .chain(noise)
        .collect();
    for (kind, address) in [SSD1306, SH1106, SH1107, SILENT]
        .into_iter()
        .flat_map(|kind| [0x3C, 0x3D].map(|address| (kind, address)))
    {
        let mut panel = panel(Controller::new(kind, address));
        for (number, frame) in frames.iter().enumerate() {
            // A panel is found, identified and woken with the first frame. A whole frame of noise
            // is sent in parts.
            for _ in 0..if number == 0 { FIRST + 1 } else { 4 } {
                assert_eq!(flush(&mut panel, frame, LONG), Ok(()));
            }
            assert!(
                shows(&panel, frame),
                "frame {number}, {kind:?} at {address:#04x}"
            );
        }
    }
}

/// The modules that were found in the field, and the way to identify each.
///
/// Source of the status bytes: Meshtastic's `probeOLED` and its threads 1363, 8850 and 11265;
/// MeshCom 458; ss_oled 61.
const MODULES: [(Kind, Says, Name, By); 21] = {
    use By::{Memory, Silence};
    [
        (SSD1306, Says::Off(0x06), Name::Ssd1306, Memory),
        (SSD1306, Says::Off(0x03), Name::Ssd1306, Memory),
        (SSD1306, Says::Off(0x00), Name::Ssd1306, Memory),
        (SSD1306, Says::Off(0x04), Name::Ssd1306, Memory),
        (SSD1306, Says::Off(0x07), Name::Ssd1306, Memory),
        (SSD1306, Says::Off(0x08), Name::Ssd1306, Memory),
        (SSD1306, Says::FirstThen(0x06, 0x08), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x00), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x03), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x07), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x43), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x46), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0x47), Name::Ssd1306, Memory),
        (BLIND, Says::Always(0xFF), Name::Ssd1306, Memory),
        (BLIND, Says::Nothing, Name::Ssd1306, Silence),
        (SH1106, Says::Off(0x08), Name::Sh1106, Memory),
        (SH1106, Says::Off(0x00), Name::Sh1106, Memory),
        (SH1106, Says::FirstThen(0x06, 0x08), Name::Sh1106, Memory),
        (SH1106, Says::Always(0x43), Name::Sh1106, Memory),
        (SH1106, Says::Always(0xFF), Name::Sh1106, Memory),
        (SH1107, Says::Off(0x07), Name::Sh1107, Memory),
    ]
};

/// The modules of [`MODULES`] are at the same address 0x3C. They differ in the controller, in the
/// status bytes, and in whether their memory can be read. The panel is plugged in after the driver
/// has begun to look for it. Within two seconds it must be identified, once, as the expected
/// controller by the expected property, and be switched on once. From then on it shows every frame
/// completely.
#[test]
fn every_module_in_the_field_shows_the_picture() {
    for (kind, says, controller, by) in MODULES {
        // The panel is identified only once, by the expected property.
        let kind = kind.says(says);
        let mut panel = panel(Controller::new(kind, 0x3C).plugged(false));
        let mut found = Vec::new();

        // The panel is plugged in after the first attempt.
        for number in 0..4 * TICK_RATE {
            panel.bus.panel.plugged_in = number > FIRST;
            let frame = scene(number / 10);
            let result = tick(&mut panel, &frame);
            found.extend(panel.found());
            if number > FIRST + BACK {
                assert_eq!(result, Ok(()), "{kind:?}");
                assert!(shows(&panel, &frame), "{kind:?}, frame {number}");
            }
        }
        let found: Vec<_> = found
            .iter()
            .map(|found| (found.controller, found.by))
            .collect();
        assert_eq!(found, [(controller, by)], "{kind:?}");
        assert_eq!(panel.bus.panel.lit, 1, "{kind:?} is switched on once");
    }
}

/// The panel answers the read of its status, and then nothing more, so its memory cannot be read.
/// It is identified by its status byte.
#[test]
fn status_byte_decides_only_if_reading_memory_fails() {
    for (kind, status, controller) in [
        (SH1106, 0x08, Name::Sh1106),
        (BLIND, 0x06, Name::Ssd1306),
        (BLIND, 0x07, Name::Ssd1306),
    ] {
        let says = Says::Off(status);
        let mut panel = panel(Controller::new(kind.says(says), 0x3C));

        // The panel is switched off and its status read; then it no longer answers.
        (0..2).for_each(|_| assert_eq!(flush(&mut panel, &scene(1), LONG), Ok(())));
        panel.bus.panel.kind.says = Says::Nothing;
        let found = (0..2).find_map(|_| {
            let _ = panel.flush(&scene(1));
            panel.bus.run(LONG);
            panel.found()
        });

        let expected = Found {
            controller,
            by: By::Status,
            status: Some(status | 0x40),
        };
        assert_eq!(found, Some(expected));
    }
}

/// A module that cannot be identified, and is taken for another one, shows the frame within 2 s of
/// the command that chooses its controller, and only with the right one. A choice of the build
/// applies from the start.
#[test]
fn chosen_controller_has_precedence_and_is_applied_at_once() {
    // An SH1106 that answers no read.
    let kind = Kind {
        own: &[(0x20, 1), (0x2E, 0), (0x8D, 1), (0xAD, 1), (0xDA, 1)],
        needed: &[],
        for_lit: BLIND.for_lit,
        ..SH1106.says(Says::Nothing)
    };
    let frame = scene(40);
    let mut panel = panel(Controller::new(kind, 0x3C));
    let run = |panel: &mut Panel| (0..BACK).for_each(|_| _ = tick(panel, &frame));
    run(&mut panel);
    assert!(!shows(&panel, &frame), "it is shifted by two columns");

    // The choice can change at any time.
    for chosen in [
        None,
        Some(Name::Sh1106),
        Some(Name::Ssd1306),
        Some(Name::Sh1106),
    ] {
        assert!(panel.choose(chosen));
        run(&mut panel);
        let is_right = chosen == Some(Name::Sh1106);
        assert_eq!(shows(&panel, &frame), is_right, "{chosen:?}");

        let found = Found {
            controller: chosen.unwrap_or_default(),
            by: if chosen.is_some() {
                By::Choice
            } else {
                By::Silence
            },
            status: None,
        };
        let report = panel.report();
        assert_eq!(
            (report.state, report.chosen),
            (PanelState::Shown(found), chosen)
        );
    }

    // The choice of the build applies first.
    let mut panel = on(Line::to(Controller::new(kind, 0x3C)), Some(Name::Sh1106));
    run(&mut panel);
    assert!(shows(&panel, &frame));
}

/// Returns the bits of columns of a page: an address, a control byte and the place; an address, a
/// control byte and the columns.
const fn bits(columns: u32) -> u32 {
    (1 + 5 * BYTE) + (1 + (2 + columns) * BYTE)
}

/// The number of bits on the bus for a frame: without a change only the part of 16 columns that is
/// always sent again, and in addition one column, or two columns of the same page with a single
/// address. Up to five unchanged columns between two changed ones are sent, too.
#[test]
fn only_changes_are_sent_and_one_part_again() {
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let mut canvas = scene(30);
    // No change, one changed column, and two in the same page, far from each other or near.
    let taken = [&[][..]; 10]
        .into_iter()
        .chain([&[20][..], &[20, 90], &[20, 27], &[20, 26]])
        .map(|changed| {
            for &x in changed {
                canvas.update(x, 7, |grey| 15 - grey);
            }
            assert_eq!(flush(&mut panel, &canvas, LONG), Ok(()));
            panel.bus.taken
        })
        .collect::<Vec<_>>();

    // The second run of a page does not contain the page's address.
    let two = 2 * bits(1) - BYTE;
    let changes = [0, bits(1), two, two, bits(7)];
    assert_eq!(
        taken[9..],
        changes.map(|change| change + bits(16) + 1),
        "and the stop"
    );
}

/// The status byte reports that the display is off. Settings are not repeated, and a panel that
/// lost its power is set up again.
#[test]
fn panel_that_lost_its_power_is_set_up_again() {
    for kind in [SSD1306, SH1106, SH1107] {
        let mut panel = panel(Controller::new(kind, 0x3C));
        let frame = scene(30);
        // The power fails at different moments of the frame's transfer.
        for moment in [97, 60, 83] {
            for _ in 0..moment {
                let _ = tick(&mut panel, &frame);
            }
            assert!(shows(&panel, &frame));
            panel.bus.panel.lose_power();
            let back = (0..BACK).find(|_| {
                let _ = tick(&mut panel, &frame);
                shows(&panel, &frame)
            });
            assert!(back.is_some(), "{kind:?}");
        }

        // A single wrong answer has no effect.
        for _ in 0..FIRST {
            assert_eq!(tick(&mut panel, &frame), Ok(()));
        }

        // The panel reports once that it is off, although it is on.
        panel.bus.panel.kind.says = Says::Always(0x46);
        panel.bus.panel.last_read = None;
        while panel.bus.panel.last_read != Some(0x46) {
            assert_eq!(tick(&mut panel, &frame), Ok(()));
        }
        panel.bus.panel.kind = kind;
        for _ in 0..BACK {
            assert_eq!(tick(&mut panel, &frame), Ok(()));
        }
        assert_eq!(panel.bus.panel.lit, 1, "since power came last");
    }
}

/// A panel with a useless status byte loses its power, and acknowledges all the same. Within 70
/// ticks it has the number of rows and the layout of its pins, which may be sent to a lit display,
/// and the whole picture again.
#[test]
fn panel_without_a_status_is_set_up_again_by_repetition() {
    for says in [Says::Always(0x43), Says::Always(0x03), Says::Nothing] {
        let kind = Kind {
            needed: &[&[0xA8, 0x3F], &[0xDA, 0x12]],
            ..BLIND.says(says)
        };
        let frame = scene(30);
        let mut panel = panel(Controller::new(kind, 0x3C));
        (0..BACK).for_each(|_| _ = tick(&mut panel, &frame));
        assert!(shows(&panel, &frame), "{says:?}");

        panel.bus.panel.lose_power();
        for _ in 0..70 {
            assert_eq!(tick(&mut panel, &frame), Ok(()));
        }
        assert!(shows(&panel, &frame), "{says:?}");
    }
}

/// The numbers of ticks without a panel. At 0 the panel is away between two ticks, so shortly that
/// no answer is missed.
const AWAY: [u32; 5] = [0, 0, 1, 50, 100];
/// The number of moments in each run, which lasts 40 s.
const MOMENTS: usize = 15;

/// The number of last frames that may be visible: the first picture takes two ticks.
const RECENT: usize = 3;

/// A panel that shows a scene, playing or paused, is pulled for 0 to 100 ticks and plugged in
/// again, 15 times. Within 2 s it shows one of the last three frames, and then does so in every
/// tick. No frame disturbs the transfer of the one before.
#[test]
fn panel_plugged_in_again_shows_every_scene_within_two_seconds() {
    let runs = [SSD1306, SH1106]
        .into_iter()
        .flat_map(|kind| [false, true].map(|is_paused| (kind, is_paused)));

    for ((kind, is_paused), &name) in
        runs.flat_map(|run| SceneName::ALL.iter().map(move |name| (run, name)))
    {
        let mut panel = panel(Controller::new(kind, 0x3C));
        let mut scene = shown(name);
        let mut recent = VecDeque::new();
        let mut longest = 0;
        let run = format!("{:12} paused {is_paused}, {kind:?}", name.name());

        // Returns true if the panel shows the last frames when the next one comes.
        let mut step = |panel: &mut Panel| {
            if !is_paused {
                scene.tick();
            }
            let was_idle = panel.bus.is_idle();
            let is_shown = panel.bus.panel.shows_any_of(&Vec::from_iter(&recent));
            let sent = panel.bus.sent;
            scene.player.draw();
            let frame = &scene.player.canvas;
            recent.push_back(Bitmap::from(frame));
            recent.drain(..recent.len().saturating_sub(RECENT));
            let _ = tick(panel, frame);
            if !was_idle {
                assert_eq!(panel.bus.sent, sent, "it disturbs the one before");
            }
            was_idle && is_shown
        };
        // The panel shows each frame, is pulled, and plugged in again.
        for (away, moment) in AWAY
            .into_iter()
            .zip([97, 101, 83, 89, 103])
            .cycle()
            .take(MOMENTS)
        {
            // The first picture must come in time, and every later one.
            let back = (0..BACK).find(|_| step(&mut panel));
            longest = longest.max(back.unwrap_or_else(|| panic!("{run}: it is not back")));
            for _ in 0..moment {
                assert!(step(&mut panel), "{run}");
            }

            panel.bus.panel.lose_power();
            panel.bus.panel.plugged_in = false;
            for _ in 0..away {
                step(&mut panel);
            }
            panel.bus.panel.plugged_in = true;
        }
        println!("{run}: back after {longest} ticks at most");
    }
}

/// The number of frames in each run: 40 s.
const FRAMES: u32 = 2400;

/// The largest delay of a page relative to its frame, ticks, at any speed.
const LATE: u32 = 1;

/// At least a part of every frame of every scene is sent, at any speed of the bus. The rest follows
/// with the next frame. At the ideal speed, nine of ten frames are complete within their tick.
#[test]
fn no_frame_of_any_scene_is_skipped_at_any_bus_speed() {
    // The smallest number of frames out of ten that are sent completely.
    const SPEEDS: [(u32, u32); 3] = [(IDEAL, 9), (USUAL, 0), (WORST, 0)];

    for &name in SceneName::ALL {
        let mut scene = shown(name);
        let mut panels = SPEEDS.map(|speed| {
            let line = Line::at(speed.0, Controller::new(SSD1306, 0x3C));
            on(line, None)
        });
        // For each speed: skipped frames, complete frames, and the largest age of a page.
        let mut counts = [(0, 0, 0); 3];
        let mut ages = [[0; HEIGHT / 8]; 3];
        for number in 0..FRAMES {
            scene.tick();
            scene.player.draw();
            let frame = &scene.player.canvas;
            let bitmap = Bitmap::from(frame);
            for ((panel, count), ages) in panels.iter_mut().zip(&mut counts).zip(&mut ages) {
                let was_idle = panel.bus.is_idle();
                let _ = tick(panel, frame);
                // The panel is identified first.
                if number < 2 * FIRST {
                    continue;
                }

                let late = panel.bus.panel.late_pages(&[&bitmap]);
                for (page, age) in ages.iter_mut().enumerate() {
                    *age = if late.contains(&page) { *age + 1 } else { 0 };
                    count.2 = count.2.max(*age);
                }
                count.0 += u32::from(!was_idle);
                count.1 += u32::from(late.is_empty());
            }
        }

        // No frame is skipped, and every page is at most one tick late.
        for (((byte_nanos, least), panel), (skipped, whole, late)) in
            SPEEDS.iter().zip(&panels).zip(counts)
        {
            let report = panel.report();
            println!(
                "{:12} {:4.1} us a byte: {skipped} frames skipped, {whole} whole, \
                 a page at most {late} ticks late; in the last second {} and {}",
                name.name(),
                f64::from(*byte_nanos) / 1e3,
                report.shown,
                report.whole
            );
            assert_eq!(skipped, 0, "{}", name.name());
            assert_eq!(u32::from(report.shown), TICK_RATE, "{}", name.name());
            assert!(late <= LATE, "{}", name.name());
            assert!(
                10 * whole >= least * (FRAMES - 2 * FIRST),
                "{}",
                name.name()
            );
        }
    }
}

/// A frame that takes longer to compute comes later in its tick, so the next one follows soon. The
/// driver still reports 60 frames in every second, at each speed of the bus.
#[test]
fn no_frame_is_skipped_when_frames_are_not_equally_far_apart() {
    const SLICES: u32 = 64;

    // The longest piece of planning between two attempts: 4 ms.
    const PIECE: u32 = 16;
    let mut rng = Rng::with_seed(3);

    for byte_nanos in [IDEAL, USUAL, WORST] {
        let mut scene = shown(SceneName::SmallHeavy);
        let mut panel = on(Line::at(byte_nanos, Controller::new(SSD1306, 0x3C)), None);
        let slice = 1_000_000_000 / TICK_RATE / (byte_nanos / BYTE) / SLICES;
        for number in 0..10 * TICK_RATE {
            scene.tick();

            // The delay is at most a third of the tick, as with planning.
            let late = rng.u32(..SLICES / 3);
            panel.bus.run(late * slice);
            scene.player.draw();
            let frame = &scene.player.canvas;
            let _ = panel.flush(frame);
            let mut done = late;
            // The bus makes progress in pieces, and the frame may be completed between them.
            while done < SLICES {
                let piece = rng.u32(1..=PIECE);
                panel.bus.run(piece.min(SLICES - done) * slice);
                done += piece;

                // The last piece extends into the next tick.
                if done < SLICES {
                    panel.catch_up(frame);
                }
            }
            if number % TICK_RATE == 0 && number > TICK_RATE {
                let report = panel.report();
                assert_eq!(u32::from(report.shown), TICK_RATE, "{byte_nanos} ns");
            }
        }
    }
}

/// A frame without a change counts as sent whole: a still picture gives 60 such frames in a second.
#[test]
fn a_still_picture_is_sent_whole() {
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let frame = scene(30);
    (0..3 * TICK_RATE).for_each(|_| _ = tick(&mut panel, &frame));
    let report = panel.report();
    assert_eq!((report.shown, report.whole), (60, 60));
}

/// If the bus transfers only every other frame, the driver returns the error `Slow` with 30 frames,
/// and none before and after.
#[test]
fn a_bus_that_is_held_up_is_reported_once_a_second() {
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let mut second = |is_slow: bool| {
        let mut result = Ok(());
        for number in 0..2 * TICK_RATE {
            result = panel.flush(&scene(number));

            // In every other tick another device holds the clock.
            if !is_slow || number % 2 == 1 {
                panel.bus.run_tick();
            }
        }
        (result, panel.report().shown)
    };
    assert_eq!(second(false), (Ok(()), 60));
    let shown = TICK_RATE / 2;
    assert_eq!(second(true), (Err(OledError::Slow { shown }), 30));
    assert_eq!(second(false), (Ok(()), 60));
}

/// A choice of the controller on a slow bus begins a new search: until the panel has shown frames
/// for a second again, the report neither calls it absent nor repeats the old counts, and no frame
/// returns `Slow`.
#[test]
fn a_choice_on_a_slow_bus_forgets_the_counts() {
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    for number in 0..2 * TICK_RATE {
        let _ = panel.flush(&scene(number));
        if number % 2 == 1 {
            panel.bus.run_tick();
        }
    }
    let frame = scene(1);
    assert!(matches!(
        panel.flush(&frame),
        Err(OledError::Slow { shown: 30 })
    ));
    assert!(panel.report().shown > 0);

    assert!(panel.choose(Some(Name::Ssd1306)));
    let starting = PanelReport {
        state: PanelState::Starting,
        chosen: Some(Name::Ssd1306),
        ..PanelReport::default()
    };
    assert_eq!(panel.report(), starting);
    let mut frames = 0;
    while !matches!(panel.report().state, PanelState::Shown(_)) {
        assert_eq!(panel.report(), starting);
        assert_eq!(tick(&mut panel, &frame), Ok(()));
        frames += 1;
        assert!(frames < BACK, "the panel is back within 2 s");
    }
    assert_eq!((panel.report().shown, panel.report().whole), (0, 0));
}

/// The texts of the errors, as the log prints them.
#[test]
fn errors_of_the_panel_are_printed_in_words() {
    let text = |error: OledError| error.to_string();
    assert_eq!(
        text(OledError::Absent(SILENCE)),
        "absent: no answer at 0x3C and 0x3D"
    );
    assert_eq!(
        text(OledError::Absent(ErrorKind::Other)),
        "absent: the bus hangs"
    );
    let slow = text(OledError::Slow { shown: 30 });
    assert!(
        slow.starts_with("the bus is slow: 30 of 60 frames"),
        "{slow}"
    );
}

/// Without a panel both addresses are tried, and then one try follows in each second. A panel that
/// is plugged in shows the frame within about a second, also for the second time; a pulled one is
/// reported as lost.
#[test]
fn an_absent_panel_is_searched_once_a_second_and_may_come_and_go() {
    let plug = |panel: &mut Panel, plugged_in| {
        panel.bus.panel = Controller::new(SSD1306, 0x3C).plugged(plugged_in)
    };
    let flush = |panel: &mut Panel, ticks| tick(panel, &scene(ticks));
    let mut panel = panel(Controller::new(SSD1306, 0x3C).plugged(false));
    let absent = Err(OledError::Absent(SILENCE));
    assert_eq!(
        panel.report(),
        PanelReport {
            state: PanelState::Starting,
            ..PanelReport::default()
        }
    );

    // There is no answer at the first address, nor at the second.
    assert_eq!(
        [1; 3].map(|ticks| flush(&mut panel, ticks)),
        [Ok(()), Ok(()), absent]
    );
    let is_absent = PanelState::Absent(BusFault::NoAnswer);
    for _ in 0..TICK_RATE {
        assert_eq!(flush(&mut panel, 1), absent);
        assert_eq!(panel.report().state, is_absent);
    }
    assert_eq!(panel.bus.sent, 2, "no other try within the second");
    assert_eq!((flush(&mut panel, 1), panel.bus.sent), (absent, 3));

    // The panel is plugged in twice, and pulled in between.
    for (ticks, before) in [(1, absent), (4, Err(OledError::Lost))] {
        plug(&mut panel, true);
        let results: Vec<_> = (0..TICK_RATE + 12)
            .map(|_| flush(&mut panel, ticks))
            .collect();
        assert!(
            results.contains(&before) && results.last() == Some(&Ok(())),
            "within a second"
        );
        assert!(shows(&panel, &scene(ticks)));
        assert!(matches!(panel.report().state, PanelState::Shown(_)));
        plug(&mut panel, false);
        assert_eq!(
            [2, 3].map(|ticks| flush(&mut panel, ticks)),
            [Ok(()), Err(OledError::Lost)]
        );
        assert_eq!(panel.report().state, is_absent);
        assert_eq!(panel.report().shown, 0);
    }
}

/// A bus on which no transfer ends is reported as lost within 10 ticks, and freed once, then once a
/// second. After it lets go, the panel shows the frame within about a second.
#[test]
fn a_bus_that_hangs_delays_nothing_and_is_freed() {
    let flush = |panel: &mut Panel, ticks| tick(panel, &scene(ticks));
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    (0..10).for_each(|ticks| assert_eq!(flush(&mut panel, ticks), Ok(())));
    panel.bus.hangs = true;
    let results: Vec<_> = (5..20).map(|ticks| flush(&mut panel, ticks)).collect();
    assert!(
        results.starts_with(&[Ok(()); 5]) && results.ends_with(&[Err(OledError::Lost); 5]),
        "{results:?}"
    );
    assert_eq!(panel.bus.freed, 1);

    // While it hangs, it is freed once a second.
    for _ in 0..2 * TICK_RATE {
        let _ = flush(&mut panel, 20);
    }
    assert_eq!(
        (flush(&mut panel, 20), panel.bus.freed),
        (Err(OledError::Absent(ErrorKind::Other)), 2)
    );
    assert_eq!(panel.report().state, PanelState::Absent(BusFault::Stuck));

    panel.bus.hangs = false;
    let last = (0..TICK_RATE + 12).map(|_| flush(&mut panel, 21)).last();
    assert!(last == Some(Ok(())) && shows(&panel, &scene(21)));
}

/// A panel counts as absent if the bus hangs during its identification, even though it has answered
/// before.
#[test]
fn a_bus_that_hangs_during_identification_is_reported() {
    // The first frame switches the display off, the second one requests the status, and the third
    // one the memory.
    for before in [1, 2] {
        let mut panel = panel(Controller::new(SSD1306, 0x3C));
        (0..before).for_each(|_| assert_eq!(tick(&mut panel, &scene(1)), Ok(())));
        panel.bus.hangs = true;
        let last = (0..10).map(|_| tick(&mut panel, &scene(1))).last();
        assert_eq!(
            last,
            Some(Err(OledError::Absent(ErrorKind::Other))),
            "after {before} frames"
        );
        assert_eq!(panel.report().state, PanelState::Absent(BusFault::Stuck));
    }
}

/// The third frame of an identification only reads: it has the length of a place in memory, of a
/// command that begins a read, and of an answer of two bytes, with their addresses.
#[test]
fn third_frame_of_an_identification_has_the_length_of_a_read() {
    let mut panel = panel(Controller::new(SH1106, 0x3C));
    (0..3).for_each(|_| assert_eq!(tick(&mut panel, &scene(1)), Ok(())));
    let [place, read, answer] = [5, 4, 3].map(|bytes| 1 + bytes * BYTE);
    assert_eq!(panel.bus.taken, place + read + answer);
}
