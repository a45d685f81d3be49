//! The scenes in closed form: their angles, their figures on the display, and the figures that
//! close.

use std::f64::consts::{FRAC_PI_6, PI, TAU};

use boards::host::Show;
use double_pendulum::{Modes, Motion, Parameters, Pendulum, SmallOscillations};
use exact::taylor::Reference;
use exact::tolerances::CLOSED_FORM;
use firmware::config::TICK_RATE;
use firmware::scenes::SceneName;

/// The error of the angles after the period in which a figure closes, relative to their amplitude:
/// 3.7e-5. It is computed for five periods of the fast mode, the most in any of these scenes.
const CLOSED: f64 = 5.0 * f32::EPSILON as f64 * 2.0 * 5.0 * std::f64::consts::TAU;

/// The distance, pixels: more than the width of a line.
const NOT_CLOSED: f64 = 1.0;

const SMALL: [(SceneName, f64); 3] = [
    (SceneName::SmallLight, 0.2),
    (SceneName::SmallEqual, 1.0),
    (SceneName::SmallHeavy, 5.0),
];
/// The mass ratio and the number of periods of the fast mode until the figure closes.
const BEATS: [(SceneName, f64, f64); 4] = [
    (SceneName::Beats3To2, 25.0 / 144.0, 3.0),
    (SceneName::Beats2To1, 9.0 / 16.0, 2.0),
    (SceneName::Beats5To2, 441.0 / 400.0, 5.0),
    (SceneName::Beats3To1, 16.0 / 9.0, 3.0),
];
const AMPLITUDE: f64 = 12.0 / 180.0 * PI;
const REACH: f64 = 21.5;
const MIDDLES: [[f64; 2]; 2] = [[23.5, 32.5], [104.5, 32.5]];

const FOLLOWED: u32 = 3600;

fn show(name: SceneName) -> Show {
    Show::new(name, &name.first_settings()).expect("a scene of the catalogue")
}

/// Equal rods have w = sqrt(g/l (1 + mu +- sqrt(mu (1 + mu)))).
fn frequencies(mass_ratio: f64, gravity: f64, rod: f64) -> [f64; 2] {
    let root = (mass_ratio * (1.0 + mass_ratio)).sqrt();
    [root, -root].map(|root| (gravity / rod * (1.0 + mass_ratio + root)).sqrt())
}

/// a1 = (pi/12) sqrt(mu/(1 + mu)) (cos w2 t - cos w1 t) and a2 = (pi/12)(cos w1 t + cos w2 t).
#[test]
fn small_oscillation_scenes_follow_the_formulas_for_an_hour() {
    for (name, mass_ratio) in SMALL {
        let mut scene = show(name);
        let [w1, w2] = frequencies(mass_ratio, 9.8, 0.25);
        let mut worst: f64 = 0.0;
        for tick in 1..=FOLLOWED * TICK_RATE {
            scene.tick();
            let t = f64::from(tick) / f64::from(TICK_RATE);
            let report = scene.report();
            let slow = (w2 * t).cos();
            let fast = (w1 * t).cos();

            let a1 = FRAC_PI_6 / 2.0 * (mass_ratio / (1.0 + mass_ratio)).sqrt() * (slow - fast);
            let a2 = FRAC_PI_6 / 2.0 * (fast + slow);
            let error = (f64::from(report.state.a1) - a1)
                .abs()
                .max((f64::from(report.state.a2) - a2).abs());
            let share = error / (FRAC_PI_6 * CLOSED_FORM);
            assert!(share <= 1.0, "{name:?} at {t} s: off by {error:e} rad");
            worst = worst.max(share);
        }

        println!("{}: at most {worst:.2} of the bound", name.name());
    }
}

fn place([x, y]: [f64; 2], mass_ratio: f64, [a1, a2]: [f64; 2]) -> [f64; 2] {
    // The ratio a2/a1 is -shape in the fast mode and +shape in the slow one.
    let shape = ((1.0 + mass_ratio) / mass_ratio).sqrt();
    let slow = (a2 + shape * a1) / 2.0;
    let fast = (a2 - shape * a1) / 2.0;
    [x + REACH / AMPLITUDE * slow, y - REACH / AMPLITUDE * fast]
}

/// The left spot follows cos w2 t and sin w1 t, the right one the high-precision motion. After the
/// period the linear motion is at its start again; the exact motion misses it.
#[test]
fn beats_follow_the_formulas_and_only_the_linear_figure_closes() {
    for (name, mass_ratio, periods) in BEATS {
        let [w1, w2] = frequencies(mass_ratio, 9.81, 1.0);
        let period = periods * TAU / w1;
        let settings = name.first_settings();
        let mut exact = Reference::new(&settings.parameters.cast(), &settings.motion().cast());
        let start = exact.motion();
        let mut scene = show(name);
        for tick in 1..=(period * f64::from(TICK_RATE)) as u32 {
            scene.tick();
            let t = f64::from(tick) / f64::from(TICK_RATE);
            exact.advance_to(t);
            let [left, right] = MIDDLES;
            let places = [
                [
                    left[0] + REACH * (w2 * t).cos(),
                    left[1] - REACH * (w1 * t).sin(),
                ],
                place(right, mass_ratio, exact.motion().angles()),
            ];

            let canvas = scene.frame();
            for [x, y] in places {
                assert_eq!(
                    canvas.get(x as i32, y as i32),
                    Some(15),
                    "{name:?} at {t} s: ({x:.2}, {y:.2})"
                );
            }
        }

        let modes = Modes::new(&settings.parameters.cast()).expect("a pendulum");
        let linear = SmallOscillations::<f32>::new(modes, &settings.motion().cast());
        let [first, last] = [0.0, period].map(|t| linear.at(t));
        let parted = |a: f32, b: f32| f64::from((a - b).abs()) / AMPLITUDE;
        let missed = parted(last.a1, first.a1).max(parted(last.a2, first.a2));
        assert!(
            missed < CLOSED,
            "{name:?}: the linear motion misses its start by {missed:e}"
        );
        exact.advance_to(period);
        let [[x0, y0], [x, y]] =
            [start, exact.motion()].map(|motion| place([0.0; 2], mass_ratio, motion.angles()));
        let missed = (x - x0).hypot(y - y0);
        println!(
            "{}: closes after {period:.3} s; the exact motion misses by {missed:.2} pixels",
            name.name()
        );
        assert!(
            missed > NOT_CLOSED,
            "{name:?}: the exact motion closes to {missed} pixels"
        );
    }
}

/// The numbers in the documentation of [`SmallOscillations`].
#[test]
fn the_linear_motion_is_near_the_exact_one_as_documented() {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 0.25, 9.81)).expect("good numbers");
    let parameters = pendulum.parameters();
    let modes = Modes::new(parameters).expect("it hangs stably");

    let farthest = |degrees: f64, seconds: f64| {
        let start = Motion::at_rest(0.0, degrees.to_radians());
        let linear = SmallOscillations::<f64>::new(modes, &start);
        let mut exact = Reference::new(parameters, &start);
        let mut farthest = [0.0_f64; 2];
        for step in 1..=(200.0 * seconds) as u32 {
            let t = f64::from(step) / 200.0;
            exact.advance_to(t);
            let [angles, other] = [linear.at(t).angles(), exact.motion().angles()];
            let [[_, bob], [_, other_bob]] = [angles, other].map(|both| pendulum.positions(both));
            for (angle, other) in angles.into_iter().zip(other) {
                farthest[0] = farthest[0].max((angle - other).abs());
            }
            farthest[1] = farthest[1].max((bob.x - other_bob.x).hypot(bob.y - other_bob.y));
        }
        farthest
    };

    let [_, bob2] = farthest(5.0, 10.0);
    assert!((5e-4..=7e-4).contains(&bob2), "{bob2} m");
    let [before, _] = farthest(30.0, 0.06);
    let [after, _] = farthest(30.0, 0.07);
    let degree = 1_f64.to_radians();
    assert!(before < degree && degree <= after, "{before}, {after}");
}
