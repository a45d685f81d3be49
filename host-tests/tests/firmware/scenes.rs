//! Every scene of the catalogue on the host: its frame to the pixel, and the properties that all
//! scenes share.

use std::f64::consts::TAU;

use crate::snapshot;
use boards::host::Show;
use boards::qemu::Screenshot;
use double_pendulum::{Modes, State};
use firmware::app::PlannerEvent;
use firmware::config::{
    CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, PIVOT, PROCESSOR, Processor, REACH, STM32F405, TICK_RATE,
    TRAIL_FADING, TRAIL_HALF_WIDTH,
};
use firmware::graphics::{Anchor, Format, PanelName, plot, text};
use firmware::job::CRC;
use firmware::motion::{Resources, Settings};
use firmware::protocol::{Command, PlayState};
use firmware::scenes::{AnyScene, Flips, Scene, SceneName};

use crate::bench::{app, blank, places, wire};

/// The relative error of a height that follows from a number of three digits.
const SHOWN_HEIGHT: f32 = 1e-3;

const LINE: i32 = Format::OLED.line();
const LOWEST: i32 = Format::OLED.lowest();
const WIDTH: i32 = Format::OLED.right();
const HEIGHT: i32 = Format::OLED.bottom();

const RESOURCES: Resources = Resources {
    processor: PROCESSOR,
    method: None,
    format: Format::OLED,
};

/// The ticks when everything is visible, and later.
const PICTURED: [u32; 2] = [60, 240];

fn scene(name: SceneName) -> Show {
    Show::new(name, &name.first_settings())
        .unwrap_or_else(|error| panic!("{}: {error}", name.name()))
}

fn after(name: SceneName, ticks: u32) -> Show {
    let mut scene = scene(name);
    (0..ticks).for_each(|_| scene.tick());
    scene
}

fn picture(screenshot: &Screenshot) -> String {
    snapshot::text(&screenshot.greys, WIDTH as usize)
}

fn has_text(frame: &Screenshot, words: &str, anchor: Anchor) -> bool {
    let mut canvas = blank();
    text::write(&mut canvas, words, anchor);
    places().all(|(x, y)| canvas.get(x, y) == Some(0) || canvas.get(x, y) == frame.get(x, y))
}

/// Each scene is drawn over another scene's frame. Nothing of it may remain.
#[test]
fn every_scene_equals_its_snapshot() {
    let check = |name: SceneName, ticks| {
        let mut show = after(SceneName::Page, 100);
        show.player.draw();
        show.player
            .play(name, name.first_settings())
            .expect("a scene of the catalogue");
        (0..ticks).for_each(|_| show.tick());
        snapshot::check(&format!("{}-{ticks}", name.name()), &picture(&show.frame()))
    };
    let differences: Vec<_> = SceneName::ALL
        .iter()
        .flat_map(|&name| PICTURED.map(|ticks| check(name, ticks)))
        .filter_map(Result::err)
        .collect();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

/// The brightness depends on the age where the path has not been visited since.
#[test]
fn the_trail_is_the_path_and_fades_with_age() {
    const FRESH: f64 = 11.0; // of 15 greys: 184/17 rounded
    const FADED: f64 = 64.0 / TRAIL_FADING as f64; // ticks to a grey
    let mut ink = blank();
    let mut path = Vec::new();
    let mut scene = AnyScene::empty();
    scene
        .start(SceneName::Page, &Settings::default(), &RESOURCES)
        .expect("the page");

    for ticks in 1..=400 {
        scene.tick(ticks, &mut ink);
        let State { a1, a2, .. } = scene.report(ticks).state;
        let rod = REACH / 2.0;
        path.push((
            PIVOT.0 + rod * (a1.sin() + a2.sin()),
            PIVOT.1 + rod * (a1.cos() + a2.cos()),
        ));
    }

    ink.on_clear_foreground();
    path.reverse();
    let distance = |at: (f32, f32), [from, to]: [(f32, f32); 2]| {
        let along = (to.0 - from.0, to.1 - from.1);
        let part = ((at.0 - from.0) * along.0 + (at.1 - from.1) * along.1)
            / (along.0 * along.0 + along.1 * along.1);
        let part = part.clamp(0.0, 1.0);
        (at.0 - from.0 - part * along.0).hypot(at.1 - from.1 - part * along.1)
    };

    let mut compared = 0;

    for (x, y) in places() {
        let middle = (x as f32 + 0.5, y as f32 + 0.5);
        let grey = f64::from(ink.get(x, y).expect("inside"));
        let far: Vec<_> = path
            .windows(2)
            .map(|piece| distance(middle, [piece[0], piece[1]]))
            .collect();
        let covers = |far: &f32| *far < TRAIL_HALF_WIDTH - 0.5;
        let touches = |far: &f32| *far < TRAIL_HALF_WIDTH + 0.6;
        let youngest = far.iter().position(touches);

        if youngest.is_none() {
            assert_eq!(grey, 0.0, "no bob was ever at {x}, {y}");
        }
        if let (Some(touched), Some(age)) = (youngest, far.iter().position(covers))
            && age < touched + 5
        {
            let expected = (FRESH - age as f64 / FADED).max(0.0);
            assert!(
                (grey - expected).abs() <= 1.0,
                "{x}, {y}: {grey} after {age} ticks, not {expected}"
            );
            compared += usize::from(expected > 0.0);
        }
    }

    assert!(compared > 50, "{compared} pixels compared");
}

#[test]
fn a_pause_is_marked_and_only_a_pause() -> Result<(), String> {
    let mut app = app();
    let mut pause = |paused: bool, clock: u32| {
        app.receive(wire(1, Command::Pause(paused)), |_| ());
        app.run_to(clock, |_| ());
        Screenshot::from(&app.player.canvas)
    };
    let plain = |ticks| after(SceneName::Page, ticks).frame();
    assert!(pause(false, 1) == plain(1), "a moving scene has no mark");
    snapshot::check("page-paused", &picture(&pause(true, 2)))?;
    assert!(
        pause(false, 3) == plain(2),
        "the mark disappears when the scene continues"
    );
    Ok(())
}

/// Each rod of the planned pendulum is as long as a radian on the frame. As the figure shows angle
/// 1 larger by sqrt((1 + mu)/mu), that is times the root of the mean square of this factor and 1.
#[test]
fn the_planned_height_is_that_of_the_shown_figure() {
    let start = |scene: &mut AnyScene, name: SceneName| {
        scene
            .start(name, &name.first_settings(), &RESOURCES)
            .expect("a scene")
    };
    let mut scene = AnyScene::empty();

    for name in [
        SceneName::Beats3To2,
        SceneName::Beats2To1,
        SceneName::Beats5To2,
        SceneName::Beats3To1,
    ] {
        let height = start(&mut scene, name).expect("it moves");
        assert!(
            scene.planned().is_some(),
            "{} follows its plan",
            name.name()
        );

        let mass_ratio = name.first_settings().mass_ratio();
        let gain = (0.5 * (1.0 + (1.0 + mass_ratio) / mass_ratio)).sqrt();
        let expected = 4.0 * 21.5 / 12.0_f32.to_radians() * gain;
        assert!(
            (height / expected - 1.0).abs() < SHOWN_HEIGHT,
            "{}: {height} for {expected}",
            name.name()
        );
    }

    assert_eq!(start(&mut scene, SceneName::Frequencies), None);
}

#[test]
fn the_map_of_flips_is_computed_as_on_the_boards_processor_and_in_time() {
    let settings = Settings::default();
    let map = |processor: Processor, in_float, ticks: u32| {
        let mut canvas = blank();
        let mut map =
            Flips::at_pace(&settings, processor.flips, in_float, Format::OLED).expect("a map");
        (1..=ticks.into()).for_each(|ticks| map.tick(ticks, canvas.on_ink()));
        map.draw(&map.report(ticks.into()), canvas.on_clear_foreground());
        (Screenshot::from(&canvas), map.is_done())
    };

    assert!(
        map(STM32F405, false, 60) != map(STM32F405, true, 60),
        "they differ"
    );
    let processors = [
        (STM32F405, true, 5),
        (CORTEX_M4F, true, 60),
        (CORTEX_M3, false, 60),
        (CORTEX_M0PLUS, false, 60),
    ];

    for (processor, in_float, seconds) in processors {
        let mut show = Show::on(processor, SceneName::Flips, &settings).expect("a map");
        (0..60).for_each(|_| show.tick());
        assert!(
            show.frame() == map(processor, in_float, 60).0,
            "{processor:?}"
        );
        assert!(
            map(processor, in_float, seconds * TICK_RATE).1,
            "{processor:?}"
        );
    }
}

#[test]
fn only_scenes_with_angles_restart_when_an_angle_is_turned() {
    for &name in SceneName::ALL {
        let mut show = scene(name);
        (0..20).for_each(|_| show.tick());
        for command in [Command::TurnLeft, Command::TurnRight] {
            let started = show.player.execute(command).expect("an angle");
            assert_eq!(started, name.has_angles(), "{}", name.name());
        }
    }
}

#[test]
fn the_catalogue_has_two_figures_and_three_linear_motions() {
    let select = |is: fn(SceneName) -> bool| -> Vec<_> {
        let names = SceneName::ALL.iter().copied();
        names.filter(|&name| is(name)).collect()
    };
    assert_eq!(
        select(|name| !name.has_angles()),
        [SceneName::Frequencies, SceneName::Flips]
    );
    assert_eq!(
        select(SceneName::is_linear),
        [
            SceneName::SmallLight,
            SceneName::SmallEqual,
            SceneName::SmallHeavy
        ]
    );
}

#[test]
fn next_and_previous_scene_are_neighbours_in_the_catalogue() {
    let all = SceneName::ALL;
    for (&name, &next) in all.iter().zip(all.iter().cycle().skip(1)) {
        assert_eq!(name.next(), next);
        assert_eq!(next.previous(), name);
    }
}

#[test]
fn scenes_of_a_motion_that_is_too_fast_do_not_move() {
    for name in [
        SceneName::Page,
        SceneName::Beats2To1,
        SceneName::Figure7,
        SceneName::Butterfly,
        SceneName::Upright,
    ] {
        let settings = Settings {
            velocities: [0.0, 2e4],
            ..name.first_settings()
        };
        let show = Show::new(name, &settings).expect("a start that is too fast is no error");
        assert_eq!(show.player.state(), PlayState::Stopped, "{}", name.name());
    }
}

#[test]
fn the_page_has_a_label_for_each_angle() {
    let settings = Settings {
        degrees: [90.0, -45.0],
        ..Settings::default()
    };
    let frame = Show::new(SceneName::Page, &settings)
        .expect("the page")
        .frame();
    assert!(has_text(&frame, "α₁ 90°", Anchor::Left(LOWEST - LINE)));
    assert!(has_text(&frame, "α₂ -45°", Anchor::Left(LOWEST)));
}

#[test]
fn a_pendulum_at_rest_has_no_amplitude() {
    let first_row = 10; // of the label at the upper scale bar of `small-1`
    for (name, label, anchor) in [
        (SceneName::SmallEqual, "0°", Anchor::EndingAt(16, first_row)),
        (SceneName::Beats2To1, "±0°", Anchor::Middle(5 * LINE)),
    ] {
        let settings = Settings {
            degrees: [0.0; 2],
            velocities: [0.0; 2],
            ..name.first_settings()
        };
        let frame = Show::new(name, &settings).expect("a scene").frame();
        assert!(has_text(&frame, label, anchor), "{}", name.name());
        // A label such as 10° also ends in 0°.
        let is_longer = (1..=9).any(|tens| has_text(&frame, &format!("{tens}0°"), anchor));
        assert!(!is_longer, "{}", name.name());
    }
}

/// The mass ratio 6 widens the plot to 7.5, whose scale has steps of 2.
#[test]
fn the_scale_of_frequencies_has_a_line_at_each_step() {
    let frame = Show::new(SceneName::Frequencies, &Settings::equal_rods(6.0, 0.0))
        .expect("a figure")
        .frame();
    let lines: Vec<_> = (10..54)
        .filter(|&row| frame.get(18, row) == Some(plot::AXIS_GREY))
        .collect();
    assert_eq!(lines, [10, 31, 53]);
}

/// A plot without ink gives the row of its axis.
fn newest_rows(frame: &Screenshot) -> [(i32, i32); 2] {
    [(9..32, 20), (32..55, 43)].map(|(rows, axis)| {
        let is_ink = |y: &i32| frame.get(WIDTH - 1, *y) != Some(0);
        let top = rows.clone().find(is_ink).unwrap_or(axis);
        let bottom = rows.rev().find(is_ink).unwrap_or(axis);
        (top, bottom)
    })
}

/// A curve outside its envelope would break the symmetry.
#[test]
fn curves_of_small_oscillations_stay_within_their_envelopes() {
    let settings = Settings {
        velocities: [1.0, 0.0],
        ..SceneName::SmallEqual.first_settings()
    };
    let mut show = Show::new(SceneName::SmallEqual, &settings).expect("a scene");
    for ticks in 1..=300 {
        show.tick();
        for ((top, bottom), axis) in newest_rows(&show.frame()).into_iter().zip([20, 43]) {
            assert!(
                (top + bottom - 2 * axis).abs() <= 2,
                "rows {top} to {bottom} after {ticks} ticks"
            );
        }
    }
}

#[test]
fn envelopes_of_small_oscillations_are_accurate_for_months() {
    let name = SceneName::SmallEqual;
    let modes: Modes<f64> =
        Modes::new(&name.first_settings().parameters.cast()).expect("a pendulum");
    let exchange = TAU / modes.exchange() * f64::from(TICK_RATE); // ticks
    let envelopes = |exchanges: f64| {
        let mut ink = blank();
        let mut scene = AnyScene::empty();
        scene
            .start(name, &name.first_settings(), &RESOURCES)
            .expect("a scene");
        let last = (exchanges * exchange).round() as u64;
        scene.tick(last - 1, &mut ink);
        scene.tick(last, &mut ink);
        newest_rows(&Screenshot::from(&ink)).map(|(top, _)| top)
    };

    for part in [0.1, 0.3] {
        let early = envelopes(part);
        let late = envelopes(1e7 + part);
        for (early, late) in early.into_iter().zip(late) {
            assert!((early - late).abs() <= 1, "row {late}, not {early}");
        }
    }
}

#[test]
fn beats_have_no_line_across_the_figure() {
    let settings = Settings {
        degrees: [0.0, 179.0],
        velocities: [0.0, 2.0],
        ..SceneName::Beats2To1.first_settings()
    };
    let mut ink = blank();
    let mut scene = AnyScene::empty();
    scene
        .start(SceneName::Beats2To1, &settings, &RESOURCES)
        .expect("a scene");

    let mut has_passed_upright = false;
    for ticks in 1..=60 {
        let before = Screenshot::from(&ink);
        let a2_before = scene.report(ticks).state.a2;
        scene.tick(ticks, &mut ink);
        has_passed_upright |= a2_before > 2.0 && scene.report(ticks).state.a2 < -2.0;
        let new: Vec<_> = places()
            .filter(|&(x, y)| x >= WIDTH / 2 && ink.get(x, y) > before.get(x, y))
            .collect();
        for along in [|&(x, _): &(i32, i32)| x, |&(_, y): &(i32, i32)| y] {
            let least = new.iter().map(along).min().unwrap_or(0);
            let greatest = new.iter().map(along).max().unwrap_or(0);
            assert!(greatest - least < 8, "{least} to {greatest}, tick {ticks}");
        }
    }

    assert!(has_passed_upright);
}

/// Whole turns are not counted, so that the separation is at most 15.3 e-foldings.
#[test]
fn the_separation_of_the_butterfly_does_not_count_whole_turns() {
    let frame = after(SceneName::Butterfly, 15 * TICK_RATE).frame();
    let above: Vec<_> = places()
        .filter(|&(x, y)| x >= 68 && (8..12).contains(&y) && frame.get(x, y) != Some(0))
        .collect();
    assert_eq!(above, []);
}

#[test]
fn text_keeps_off_the_edges() {
    for anchor in [
        Anchor::Left(0),
        Anchor::Right(0),
        Anchor::Left(LOWEST),
        Anchor::Right(LOWEST),
    ] {
        for text in [
            "μ 0.174",
            "½px 12.3 s",
            "α₁ -7.5°",
            "compensated",
            "ω₂ 0.765",
        ] {
            let near = |&(x, y): &(i32, i32)| x < 1 || y < 1 || x > WIDTH - 2 || y > HEIGHT - 2;
            let mut canvas = blank();
            text::write(&mut canvas, text, anchor);
            let ink: Vec<_> = places()
                .filter(|&(x, y)| canvas.get(x, y) != Some(0))
                .collect();
            assert!(
                !ink.is_empty() && !ink.iter().any(near),
                "{text:?} at {anchor:?}"
            );
        }
    }
}

#[test]
fn the_empty_figure_can_be_drawn() {
    let scene = AnyScene::empty();
    let mut canvas = blank();
    scene.draw(&scene.report(0), &mut canvas);
    assert_ne!(canvas, blank());
}

#[test]
fn scales_have_round_steps() {
    let steps = [0.001, 0.3, 1.0, 1.1, 3.9, 30.0, 1e9].map(plot::scale_step);
    assert_eq!(steps, [0.01, 0.5, 1.0, 2.0, 5.0, 50.0, 100.0]);
}

#[test]
fn the_butterfly_is_planned_while_it_is_played() {
    let mut show = Show::new(SceneName::Butterfly, &Settings::equal_rods(1.0, 20.0))
        .expect("a scene of the catalogue");
    let found = (0..60 * TICK_RATE).find_map(|_| {
        show.tick();
        show.news.iter().find_map(|(_, news)| {
            if let PlannerEvent::Found(Ok(plan)) = news {
                Some(plan.stepping())
            } else {
                None
            }
        })
    });
    assert!(
        found.is_some() && found == show.report().stepping,
        "{found:?}"
    );
}

#[test]
fn every_scene_has_the_golden_colours_on_every_panel() -> Result<(), String> {
    let mut lines = String::from("panel,scene,picture\n");
    for panel in [PanelName::Lcd13, PanelName::Lcd2, PanelName::Display] {
        for &name in SceneName::ALL {
            let settings = name.first_settings();
            let mut show = Show::in_format(panel.format(), CORTEX_M0PLUS, name, &settings)
                .expect("a scene of the catalogue");
            (0..240).for_each(|_| show.tick());
            let colours = show.frame().colours.expect("a colour panel");
            let bytes: Vec<u8> = colours
                .iter()
                .flat_map(|colour| colour.to_le_bytes())
                .collect();
            let hash = CRC.checksum(&bytes);
            lines += &format!("{},{},{hash:08x}\n", panel.name(), name.name());
        }
    }
    snapshot::check_lines("host-tests/golden/colours.csv", &lines)
}

/// Writes a sheet of all scenes for each format, for a person.
#[test]
#[ignore = "writes pictures"]
fn sheets_of_all_formats() {
    for format in PanelName::ALL.iter().map(|panel| panel.format()) {
        for ticks in [300, 1500] {
            let pictures: Vec<_> = SceneName::ALL
                .iter()
                .map(|&name| {
                    let settings = name.first_settings();
                    let mut show =
                        Show::in_format(format, CORTEX_M0PLUS, name, &settings).expect("a scene");
                    (0..ticks).for_each(|_| show.tick());
                    show.frame().rgb(|grey| [17 * grey; 3])
                })
                .collect();
            let (width, height) = (usize::from(format.width), usize::from(format.height));
            let mut sheet =
                format!("P6\n{} {}\n255\n", 5 * (width + 4), 3 * (height + 4)).into_bytes();
            for y in 0..3 * (height + 4) {
                for x in 0..5 * (width + 4) {
                    let place = y % (height + 4) * width + x % (width + 4);
                    let is_inside = x % (width + 4) < width && y % (height + 4) < height;
                    let picture = pictures.get(y / (height + 4) * 5 + x / (width + 4));
                    let rgb = picture
                        .filter(|_| is_inside)
                        .map_or([90, 90, 90], |all| all[place]);
                    sheet.extend(rgb);
                }
            }
            let folder = env!("CARGO_TARGET_TMPDIR");
            let path = format!("{folder}/sheet-{width}x{height}-{ticks}.ppm");
            std::fs::write(path, sheet).expect("a file");
        }
    }
}
