//! The conversion of buttons to commands, of commands to settings, and of settings to labels.

use firmware::app::{Controls, Pressed};
use firmware::config::{
    DEBOUNCE_TICKS, HOLD_TICKS, MASS_RATIOS, MOST_TICKS_BETWEEN_TAPS, REPEAT_DELAY_TICKS,
    REPEAT_PERIOD_TICKS,
};
use firmware::graphics::label;
use firmware::motion::{Horizon, Settings};
use firmware::protocol::Command;

const NONE: Pressed = Pressed {
    up: false,
    down: false,
    left: false,
    right: false,
    select: false,
    letters: [false; 4],
};
const UP: Pressed = Pressed { up: true, ..NONE };
const SELECT: Pressed = Pressed {
    select: true,
    ..NONE
};

fn commands(
    controls: &mut Controls,
    readings: impl IntoIterator<Item = Pressed>,
) -> Vec<(usize, Command)> {
    let each = |(tick, pressed)| {
        controls
            .tick(pressed)
            .map(move |command| (tick, command))
            .collect::<Vec<_>>()
    };
    readings.into_iter().enumerate().flat_map(each).collect()
}

fn proven() -> Controls {
    let mut controls = Controls::default();
    assert_eq!(commands(&mut controls, [NONE; 10]), []);
    controls
}

#[test]
fn a_button_held_since_reset_counts_only_once_released() {
    let mut controls = Controls::default();
    let arrows = Pressed {
        up: true,
        down: true,
        left: true,
        right: true,
        select: false,
        letters: [false; 4],
    };
    let all = Pressed {
        select: true,
        ..arrows
    };
    assert_eq!(commands(&mut controls, [all; 200]), []);
    assert_eq!(commands(&mut controls, [NONE; 10]), []);
    let fired: Vec<_> = commands(&mut controls, [arrows; 10])
        .into_iter()
        .map(|(_, command)| command)
        .collect();
    assert_eq!(
        fired,
        [
            Command::Heavier,
            Command::Lighter,
            Command::TurnLeft,
            Command::TurnRight
        ]
    );
}

#[test]
fn readings_become_commands() {
    let held = |readings: &[(Pressed, usize)]| {
        readings
            .iter()
            .flat_map(|&(one, ticks)| vec![one; ticks])
            .collect::<Vec<_>>()
    };
    let first = usize::from(DEBOUNCE_TICKS) - 1;
    let delay = usize::from(REPEAT_DELAY_TICKS);
    let period = usize::from(REPEAT_PERIOD_TICKS);
    let repeated = [
        first,
        first + delay,
        first + delay + period,
        first + delay + 2 * period,
    ];
    let next_scene = first + usize::from(HOLD_TICKS) - 1;

    let mut cases = vec![
        ("bounces do not count", [UP, NONE].repeat(3), vec![]),
        (
            "nor when let go",
            [vec![UP; 10], [NONE, UP].repeat(2), vec![UP; 2]].concat(),
            vec![(first, Command::Heavier)],
        ),
        (
            "held, it repeats",
            vec![UP; 36],
            repeated.map(|tick| (tick, Command::Heavier)).to_vec(),
        ),
        (
            "let go, it restarts",
            held(&[(SELECT, 10), (NONE, 10)]),
            vec![(10 + first, Command::Restart)],
        ),
        (
            "once, and no restart after it",
            held(&[(SELECT, 200), (NONE, 10)]),
            vec![(next_scene, Command::NextScene)],
        ),
    ];

    for (arrow, command) in [
        (Pressed { up: true, ..SELECT }, Command::TogglePause),
        (
            Pressed {
                down: true,
                ..SELECT
            },
            Command::Step(1),
        ),
        (
            Pressed {
                left: true,
                ..SELECT
            },
            Command::PreviousScene,
        ),
        (
            Pressed {
                right: true,
                ..SELECT
            },
            Command::NextScene,
        ),
    ] {
        let readings = held(&[(SELECT, 10), (arrow, 100), (SELECT, 100), (NONE, 10)]);
        cases.push((
            "with select it neither repeats nor restarts",
            readings,
            vec![(10 + first, command)],
        ));
    }

    for (what, readings, fired) in cases {
        assert_eq!(commands(&mut proven(), readings), fired, "{what}");
    }
}

#[test]
fn taps_before_a_hold_select_its_command() {
    let tap = || [SELECT; 5].into_iter().chain([NONE; 5]);
    let after = |taps: usize, pause: usize, held: usize| {
        let taps = (0..taps)
            .flat_map(|_| tap())
            .chain([NONE; 60].into_iter().take(pause));
        let readings = taps
            .chain([SELECT; 200].into_iter().take(held))
            .chain([NONE; 10]);
        let fired = commands(&mut proven(), readings)
            .into_iter()
            .map(|(_, command)| command);
        fired
            .filter(|command| *command != Command::Restart)
            .collect::<Vec<_>>()
    };
    let held = usize::from(HOLD_TICKS) + 2 * usize::from(REPEAT_PERIOD_TICKS) + 2;

    for (taps, command) in [
        Command::Heavier,
        Command::Lighter,
        Command::TurnRight,
        Command::TurnLeft,
    ]
    .into_iter()
    .enumerate()
    {
        assert_eq!(
            after(taps + 1, 0, held),
            [command; 3],
            "after {} taps",
            taps + 1
        );
        assert_eq!(
            after(taps + 1, 30, held),
            [Command::NextScene],
            "too long after {} taps",
            taps + 1
        );
    }

    // From the end of a tap to a press are 5 ticks more than the pause.
    let longest = usize::from(MOST_TICKS_BETWEEN_TAPS) - 5;
    assert_eq!(after(1, longest, held), [Command::Heavier; 3]);
    assert_eq!(after(1, longest + 1, held), [Command::NextScene]);

    assert_eq!(after(5, 0, held), [], "five taps have no command");
    assert_eq!(after(3, 0, 20), [], "not held long enough");
}

#[test]
fn buttons_visit_every_mass_ratio_and_stop_at_the_ends() {
    let mut settings = Settings::equal_rods(MASS_RATIOS[0], 120.0);
    for ratio in MASS_RATIOS {
        assert_eq!(settings.parameters.mass_ratio(), ratio);
        assert!(settings.start().is_ok());
        settings = settings.heavier();
    }
    for ratio in MASS_RATIOS.into_iter().rev() {
        assert_eq!(settings.parameters.mass_ratio(), ratio);
        settings = settings.lighter();
    }
    assert_eq!(settings.parameters.mass_ratio(), MASS_RATIOS[0]);

    let between = Settings::equal_rods(2.75, 120.0);
    assert_eq!(
        (
            between.lighter().mass_ratio(),
            between.heavier().mass_ratio()
        ),
        (2.5, 3.15)
    );
}

#[test]
fn buttons_visit_every_mass_ratio_whatever_the_mass_of_bob_1() {
    for m1 in [0.1, 0.7, 1.3, 3.0] {
        let mut settings = Settings::equal_rods(1.0, 120.0);
        settings.parameters.m1 = m1;
        settings = settings.with_mass_ratio(MASS_RATIOS[0]);
        let is_at = |settings: Settings, ratio: f64| {
            (settings.parameters.mass_ratio() / ratio - 1.0).abs() <= f64::EPSILON
        };

        for ratio in MASS_RATIOS {
            assert!(is_at(settings, ratio), "{m1}, up to {ratio}");
            settings = settings.heavier();
        }
        for ratio in MASS_RATIOS.into_iter().rev() {
            assert!(is_at(settings, ratio), "{m1}, down to {ratio}");
            settings = settings.lighter();
        }
    }
}

#[test]
fn angles_stop_at_straight_up() {
    let mut settings = Settings::equal_rods(1.0, 170.5);
    for _ in 0..20 {
        settings = settings.turned(1);
    }
    assert_eq!(
        (settings.degrees, settings.angles()),
        ([180.0; 2], [std::f64::consts::PI; 2])
    );
    for _ in 0..400 {
        settings = settings.turned(-1);
    }
    assert_eq!(settings.degrees, [-180.0; 2]);
}

#[test]
fn labels_show_the_settings() {
    let ratios = [
        0.01,
        0.0125,
        0.1,
        0.315,
        1.0,
        2.75,
        9.0 / 16.0,
        12.5,
        31.5,
        100.0,
    ]
    .map(label::mass_ratio);
    let expected = [
        "0.0100", "0.0125", "0.100", "0.315", "1.00", "2.75", "0.563", "12.5", "31.5", "100",
    ];
    assert_eq!(
        ratios.map(|label| label.to_string()),
        expected.map(|text| format!("μ {text}"))
    );

    let angles = [0.0, 120.0, -7.0, 171.5, -0.5].map(|degrees| label::degrees("α ", degrees));
    let expected = ["α 0°", "α 120°", "α -7°", "α 171.5°", "α -0.5°"];
    assert_eq!(angles.map(|label| label.to_string()), expected);

    // Times are rounded down to tenths, and remain short for weeks.
    let times = [0.0, 0.099, 59.96, 999.99, 3600.9, 99_999.9, 1e5, 1e6].map(label::time);
    assert_eq!(
        times.map(|label| label.to_string()),
        [
            "0.0 s", "0.0 s", "59.9 s", "999.9 s", "3600 s", "99999 s", "27.7 h", "277.7 h"
        ]
    );

    let horizons = [
        (Horizon::Until(8.46), "½px 8.4 s"),
        (Horizon::Until(9370.2), "½px 9370 s"),
        (Horizon::AtLeast(1e6), "½px>277.7 h"),
        (Horizon::Until(1.0 / 60.0), "½px 0.02 s"),
        (Horizon::Until(1.0), "½px 1.0 s"),
        (Horizon::AtLeast(8.46), "½px>8.4 s"),
        (Horizon::Undecided, "½px ?"),
        (Horizon::Always, "½px ok"),
    ];
    for (horizon, text) in horizons {
        assert_eq!(horizon.label().to_string(), text, "{horizon:?}");
    }

    let ticks = [0.0, 0.05, 0.2, 1.0, 50.0].map(|time| label::tick(time, " s"));
    assert_eq!(
        ticks.map(|label| label.to_string()),
        ["0 s", "0.05 s", "0.2 s", "1 s", "50 s"]
    );
}

#[test]
fn labels_of_any_numbers_are_safe() {
    for number in [f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX, 1e-30] {
        let _ = (
            label::mass_ratio(number),
            label::degrees("α ", number.into()),
            label::time(number.into()),
        );
        let _ = (
            Horizon::AtLeast(number).label(),
            label::tick(number, " s"),
            label::label("true ", number, 1, " J"),
        );
    }
}
