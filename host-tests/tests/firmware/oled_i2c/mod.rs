//! The one-colour panel: its frame, and its driver with controllers that are stricter than the real
//! ones.

mod bus;

use boards::host::Show;
use boards::qemu::Screenshot;
use embedded_hal::i2c::ErrorKind;
use fastrand::Rng;
use firmware::config::{STM32F405, TICK_RATE};
use firmware::display::{
    BusFault, By, Controller as Name, Display, Found, OledError, OledI2c, PanelOptions,
    PanelReport, PanelState,
};
use firmware::graphics::{Bitmap, Canvas, Format, Palette};
use firmware::scenes::SceneName;

use crate::bench::{blank, places};
use bus::{BYTE, Controller, Kind, Line, SH1106, SH1107, SSD1306, Says, USUAL};

/// More bits than any frame needs, including the settings that wake the panel.
const LONG: u32 = 4 * 400_000 / TICK_RATE;
const FIRST: u32 = 6;
/// The largest number of frames until a panel is back: 2 s.
const BACK: u32 = 2 * TICK_RATE;

const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;

type Panel = OledI2c<'static, Line>;

fn panel(controller: Controller) -> Panel {
    on(Line::to(controller), None)
}

fn on(line: Line, chosen: Option<Name>) -> Panel {
    OledI2c::new(line, Box::leak(Box::new(Bitmap::BLACK)), chosen)
}

fn flush(panel: &mut Panel, frame: &Canvas, bits: u32) -> Result<(), OledError> {
    let result = panel.flush(frame);
    panel.bus.run(bits);
    result
}

fn tick(panel: &mut Panel, frame: &Canvas) -> Result<(), OledError> {
    let result = panel.flush(frame);
    panel.bus.run_tick();
    panel.catch_up(frame);
    result
}

fn shows(panel: &Panel, frame: &Canvas) -> bool {
    panel.bus.panel.shows(&Bitmap::from(frame))
}

fn shown(name: SceneName) -> Show {
    Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue")
}

fn scene(ticks: u32) -> Canvas<'static> {
    let mut show = shown(SceneName::Page);
    (0..ticks).for_each(|_| show.tick());
    show.player.draw();
    show.player.canvas
}

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
            canvas.on_clear_foreground();
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

fn pixels(mut is_lit: impl FnMut() -> bool) -> Canvas<'static> {
    let mut canvas = blank();
    places()
        .filter(|_| is_lit())
        .for_each(|(x, y)| canvas.update(x, y, |_| 15));
    canvas
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
        (SSD1306, Says::Always(0x00), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0x03), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0x07), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0x43), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0x46), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0x47), Name::Ssd1306, Memory),
        (SSD1306, Says::Always(0xFF), Name::Ssd1306, Memory),
        (SSD1306, Says::Nothing, Name::Ssd1306, Silence),
        (SH1106, Says::Off(0x08), Name::Sh1106, Memory),
        (SH1106, Says::Off(0x00), Name::Sh1106, Memory),
        (SH1106, Says::FirstThen(0x06, 0x08), Name::Sh1106, Memory),
        (SH1106, Says::Always(0x43), Name::Sh1106, Memory),
        (SH1106, Says::Always(0xFF), Name::Sh1106, Memory),
        (SH1107, Says::Off(0x07), Name::Sh1107, Memory),
    ]
};

/// Each module is plugged in after the driver has begun to look for it. Then it shows every frame:
/// of a scene, and noise of any density.
#[test]
fn every_module_in_the_field_shows_the_picture() {
    let mut rng = Rng::with_seed(1);
    let noise = [2, 2, 1000, 300, 100, 30, 10, 3].map(|rarity| pixels(|| rng.u32(..rarity) == 0));
    let frames: Vec<_> = [0, 1, 2, 30, 31, 400]
        .map(scene)
        .into_iter()
        .chain(noise)
        .collect();

    for (kind, says, controller, by) in MODULES {
        for address in [0x3C, 0x3D] {
            let module = format!("{kind:?} {says:?} at {address:#04x}");
            let mut panel = panel(Controller::new(kind.says(says), address).plugged(false));
            let mut found = Vec::new();
            for number in 0..BACK + FIRST {
                panel.bus.panel.plugged_in = number > FIRST;
                let _ = tick(&mut panel, &frames[0]);
                found.extend(panel.found());
            }
            for (number, frame) in frames.iter().enumerate() {
                assert_eq!(flush(&mut panel, frame, LONG), Ok(()), "{module}");
                assert!(shows(&panel, frame), "{module}: frame {number}");
            }

            let found: Vec<_> = found
                .iter()
                .map(|found| (found.controller, found.by))
                .collect();
            assert_eq!(found, [(controller, by)], "{module}");
            assert_eq!(panel.bus.panel.lit, 1, "{module}");
        }
    }
}

const FAULTS: [(Fault, BusFault); 3] = [
    (Fault::Pulled, BusFault::NoAnswer),
    (Fault::Disturbed, BusFault::Disturbed),
    (Fault::Held, BusFault::Stuck),
];

#[derive(Clone, Copy, Debug)]
enum Fault {
    Pulled,
    Disturbed,
    Held,
}

impl Fault {
    fn set(self, bus: &mut Line, is_on: bool) {
        match self {
            Self::Pulled => {
                bus.panel = Controller::new(SSD1306, 0x3C).plugged(!is_on);
            }
            Self::Disturbed => bus.fails = is_on.then_some(ErrorKind::ArbitrationLoss),
            Self::Held => bus.hangs = is_on,
        }
    }
}

/// Each fault begins while the panel is woken, or shows a scene that plays or is paused, and lasts
/// for a tick, or for seconds.
#[test]
fn every_fault_makes_the_panel_absent_until_it_is_over() {
    // The frames before the fault: during each step of waking, and later.
    let moments = (0..=FIRST).chain([TICK_RATE, TICK_RATE + 7]);
    for ((fault, reported), moment) in FAULTS
        .into_iter()
        .flat_map(|row| moments.clone().map(move |moment| (row, moment)))
    {
        for (is_paused, lasts) in [(false, 1), (true, 1), (true, 3 * TICK_RATE)] {
            let case = format!("{fault:?} after {moment} frames for {lasts}, paused {is_paused}");
            let mut panel = panel(Controller::new(SSD1306, 0x3C));
            let mut scene = shown(SceneName::Page);
            let mut tick = |panel: &mut Panel, is_paused: bool| {
                if !is_paused {
                    scene.tick();
                }
                scene.player.draw();
                tick(panel, &scene.player.canvas)
            };
            (0..moment).for_each(|_| _ = tick(&mut panel, false));

            fault.set(&mut panel.bus, true);
            let mut sent = panel.bus.sent;
            for number in 0..lasts {
                let result = tick(&mut panel, is_paused);
                if number >= 10 {
                    assert_eq!(result, Err(OledError(reported)), "{case}");
                    assert_eq!(panel.report().state, PanelState::Absent(reported), "{case}");
                } else {
                    sent = panel.bus.sent;
                }
            }
            let most = 2 * lasts / TICK_RATE + 1;
            assert!(panel.bus.sent - sent <= most, "{case}");

            fault.set(&mut panel.bus, false);
            (0..BACK).for_each(|_| _ = tick(&mut panel, is_paused));
            let last = &scene.player.canvas;
            assert_eq!(flush(&mut panel, last, LONG), Ok(()), "{case}");
            assert!(shows(&panel, last), "{case}");
        }
    }
}

#[test]
fn chosen_controller_has_precedence_and_is_applied_at_once() {
    // An SH1106 that answers no read.
    let kind = Kind {
        own: &[(0x20, 1), (0x2E, 0), (0x8D, 1), (0xAD, 1), (0xDA, 1)],
        needed: &[],
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
        let options = PanelOptions {
            controller: chosen,
            ..PanelOptions::default()
        };
        assert!(panel.choose(options));
        let starting = PanelReport {
            state: PanelState::Starting,
            chosen: options,
            ..PanelReport::default()
        };
        assert_eq!(panel.report(), starting);
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
            (PanelState::Shown(found), options)
        );
    }

    let mut panel = on(Line::to(Controller::new(kind, 0x3C)), Some(Name::Sh1106));
    run(&mut panel);
    assert!(shows(&panel, &frame));
}

#[test]
fn the_picture_is_turned_by_a_choice() {
    let frame = scene(40);
    for kind in [SSD1306, SH1106, SH1107] {
        let mut panel = panel(Controller::new(kind, 0x3C));
        for (is_turned, columns, rows) in [(false, 0xA1, 0xC8), (true, 0xA0, 0xC0)] {
            panel.choose(PanelOptions {
                is_turned,
                ..PanelOptions::default()
            });
            (0..BACK).for_each(|_| _ = tick(&mut panel, &frame));
            assert!(shows(&panel, &frame), "{kind:?}");
            let given = &panel.bus.panel;
            assert_eq!(given.last_of([0xA0, 0xA1]), Some(&[columns][..]));
            assert_eq!(given.last_of([0xC0, 0xC8]), Some(&[rows][..]));
        }
    }
}

#[test]
fn the_panel_is_dimmed_unless_it_is_to_stay_bright() {
    let frame = scene(40);
    let contrast = |panel: &mut Panel| {
        (0..BACK).for_each(|_| _ = tick(panel, &frame));
        panel.bus.panel.last_of([0x81; 2]).map(|given| given[1])
    };
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let bright = contrast(&mut panel);
    panel.dim(true);
    assert_eq!(contrast(&mut panel), Some(1));
    Fault::Pulled.set(&mut panel.bus, true);
    tick(&mut panel, &frame).expect("its loss is not known yet");
    Fault::Pulled.set(&mut panel.bus, false);
    assert_eq!(contrast(&mut panel), Some(1));
    panel.dim(false);
    assert_eq!(contrast(&mut panel), bright);

    panel.dim(true);
    panel.choose(PanelOptions {
        stays_bright: true,
        ..PanelOptions::default()
    });
    assert_eq!(contrast(&mut panel), bright);
}

/// An address, a control byte and the place; an address, a control byte and the columns.
const fn bits(columns: u32) -> u32 {
    (1 + 5 * BYTE) + (1 + (2 + columns) * BYTE)
}

/// Up to five unchanged columns between two changed ones are sent, too.
#[test]
fn only_changes_are_sent() {
    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    let mut canvas = scene(30);
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
    let nothing = 1 + 3 * BYTE;
    let two = 2 * bits(1) - BYTE;
    let changes = [nothing, bits(1), two, two, bits(7)];
    assert_eq!(taken[9..], changes.map(|change| change + 1), "and the stop");
}

/// The scenes that need more time on the bus than a tick has, because their plots move all columns.
const SKIPPING: [SceneName; 1] = [SceneName::SmallHeavy];

#[test]
fn every_scene_is_shown_as_fast_as_the_bus_allows() {
    for &name in SceneName::ALL {
        let mut scene = shown(name);
        let mut panel = on(Line::at(USUAL, Controller::new(SSD1306, 0x3C)), None);
        let mut least = u8::MAX;
        for second in 0..20 {
            for _ in 0..TICK_RATE {
                scene.tick();
                scene.player.draw();
                let _ = tick(&mut panel, &scene.player.canvas);
            }
            // The panel is identified in the first second.
            if second > 1 {
                least = least.min(panel.report().shown);
            }
        }
        println!("{:12} {least} frames/s", name.name());
        let needed = if SKIPPING.contains(&name) { 30 } else { 60 };
        assert!(least >= needed, "{}: {least} frames/s", name.name());
    }

    let mut panel = panel(Controller::new(SSD1306, 0x3C));
    for number in 0..3 * TICK_RATE {
        assert_eq!(panel.flush(&scene(number)), Ok(()));
        if number % 2 == 1 {
            panel.bus.run_tick();
        }
    }
    assert_eq!(panel.report().shown, 30);
}

#[test]
fn an_absent_panel_is_printed_in_words() {
    assert_eq!(
        OledError(BusFault::NoAnswer).to_string(),
        "absent: no answer at 0x3C and 0x3D"
    );
}
