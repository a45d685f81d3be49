//! The page's equal-rod form as printed, against the right one, at the settings of its figure 7.

use double_pendulum::{Parameters, Pendulum, State, rk4};
use firmware::config::{HALF_PIXEL, TICK_RATE};
use firmware::graphics::{Place, View};
use firmware::motion::Misprinted;
use host_tests::oracle::{textbook, tolerances};

const MU: f64 = 2.75;
const STEPS_PER_SECOND: usize = 512;
const SECONDS: usize = 100;
/// Either system is chaotic, so one run says little: the start is varied by as many millionths of a radian.
const RUNS: usize = 32;

fn figure_7() -> (Pendulum<f64>, State<f64>) {
    let pendulum = Pendulum::new(&Parameters::equal_rods(MU, 1.0, 9.8))
        .expect("figure 7's parameters are valid");
    (
        pendulum,
        State::at_rest(171_f64.to_radians(), 171_f64.to_radians()),
    )
}

/// Of all runs the mean energy and the largest error of it, J, and bob 2's share of the time above the pivot.
fn run(rhs: impl Fn(&[f64; 4]) -> [f64; 4]) -> [f64; 3] {
    let (pendulum, figure_7) = figure_7();
    let (mut energy, mut error, mut above) = (0.0, 0.0_f64, 0.0);
    for run in 0..RUNS {
        let angle = figure_7.a1 + 1e-6 * run as f64;
        let start = State::at_rest(angle, angle);
        let start_energy = pendulum.energy(&start);
        let mut z = start.into();
        for _ in 0..SECONDS * STEPS_PER_SECOND {
            z = rk4::step(&rhs, &z, 1.0 / STEPS_PER_SECOND as f64);
            let state = State::from(z);
            let [_, bob2] = pendulum.positions(state.angles());
            energy += pendulum.energy(&state);
            error = error.max((pendulum.energy(&state) - start_energy).abs());
            above += f64::from(u8::from(bob2.y > 0.0));
        }
    }
    let samples = (RUNS * SECONDS * STEPS_PER_SECOND) as f64;
    [energy / samples, error, above / samples]
}

#[test]
fn printed_form_does_not_keep_the_energy_and_hangs_below_the_pivot_on_average() {
    let [energy, _, above] = run(|z| textbook::misprinted_equal_rods(MU, 1.0, 9.8, z));
    assert!(
        (energy + 18.7).abs() < tolerances::MISPRINT_ENERGY,
        "mean energy {energy} J"
    );
    assert!(
        above < tolerances::MISPRINT_ABOVE,
        "{above} above the pivot"
    );
}

#[test]
fn right_form_keeps_the_energy_and_spends_half_its_time_above_the_pivot() {
    let (pendulum, start) = figure_7();
    assert!((pendulum.energy(&start) - 62.9).abs() < tolerances::LAST_DIGIT_OF_62_9);
    let [_, error, above] = run(|z| pendulum.derivatives(z));
    assert!(
        error < tolerances::FIGURE_7_ENERGY,
        "energy error {error} J"
    );
    assert!(
        (above - 0.507).abs() < tolerances::FIGURE_7_ABOVE,
        "{above} above the pivot"
    );
}

#[test]
fn with_equal_masses_the_printed_form_is_right() {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 0.5, 9.8)).expect("valid parameters");
    let z = [0.7, -1.9, 0.3, -0.4];
    let printed = textbook::misprinted_equal_rods(1.0, 0.5, 9.8, &z);
    for (printed, right) in printed.into_iter().zip(pendulum.derivatives(&z)) {
        let apart = (printed - right).abs() / right.abs().max(1.0);
        assert!(
            apart < tolerances::DERIVATIVES.double,
            "{printed} instead of {right}"
        );
    }
}

#[test]
fn what_is_shown_of_the_printed_form_is_right_to_half_a_pixel_for_10_s() {
    const STEPS_PER_TICK: usize = 64;
    let (pendulum, start) = figure_7();
    let mut shown = Misprinted::new(&pendulum.parameters().cast(), &start.cast());
    let view = View::new(
        &pendulum.parameters().cast(),
        Place::HALVES[1],
        shown.directions(),
    );
    let mut z = start.into();
    for tick in 1..=10 * TICK_RATE {
        shown.tick();
        for _ in 0..STEPS_PER_TICK {
            let rhs = |z: &[f64; 4]| textbook::misprinted_equal_rods(MU, 1.0, 9.8, z);
            z = rk4::step(rhs, &z, 1.0 / (TICK_RATE as usize * STEPS_PER_TICK) as f64);
        }
        let state = State::from(z);
        let exact =
            view.bobs([state.a1, state.a2].map(|angle| [angle.sin() as f32, angle.cos() as f32]));
        for ((x, y), (exact_x, exact_y)) in view.bobs(shown.directions()).into_iter().zip(exact) {
            let off = (x - exact_x).hypot(y - exact_y);
            assert!(off <= HALF_PIXEL, "{off} pixels in tick {tick}");
        }
        if tick <= 5 * TICK_RATE {
            let (energy, exact) = (f64::from(shown.energy()), pendulum.energy(&state));
            let off = (energy - exact).abs();
            assert!(
                off < tolerances::MISPRINT_SHOWN,
                "{energy} J instead of {exact} in tick {tick}"
            );
        }
    }
}
