use core::f64::consts::PI;

use double_pendulum::{Parameters, Pendulum, Real, State};

use super::{EQUATIONS, assert_near, random, tolerances};

const STATES: u32 = 100_000;

/// Returns the terms of the derivatives as they are printed in the book.
fn page_terms(
    &Parameters { m1, m2, l1, l2, g }: &Parameters<f64>,
    [a1, a2, p1, p2]: [f64; 4],
    den: f64,
    [sin_d, cos_d]: [f64; 2],
) -> [[f64; 3]; 4] {
    let w1 = [p1 * l2, -p2 * l1 * cos_d, 0.0].map(|term| term / (l1 * l1 * l2 * den));
    let w2 = [p2 * (m1 + m2) * l1, -p1 * m2 * l2 * cos_d, 0.0]
        .map(|term| term / (m2 * l1 * l2 * l2 * den));
    let term_a1 = p1 * p2 * sin_d / (l1 * l2 * den);

    let bracket = p1 * p1 * m2 * l2 * l2 - 2.0 * p1 * p2 * m2 * l1 * l2 * cos_d
        + p2 * p2 * (m1 + m2) * l1 * l1;
    let sin_2d = 2.0 * sin_d * cos_d;
    let term_a2 = bracket * sin_2d / (2.0 * l1 * l1 * l2 * l2 * den * den);

    let p1_rate = [-(m1 + m2) * g * l1 * a1.sin(), -term_a1, term_a2];
    let p2_rate = [-m2 * g * l2 * a2.sin(), term_a1, -term_a2];
    [w1, w2, p1_rate, p2_rate]
}

fn largest(terms: &[f64]) -> f64 {
    terms
        .iter()
        .fold(0.0, |largest: f64, term| largest.max(term.abs()))
}

/// The scale also covers cancellation within a term: in the bracket of A2, and in sin D and cos D.
fn derivatives_are_the_pages<R: Real>() {
    for (pendulum, state) in random::pendulums::<R>(1, STATES) {
        let parameters = pendulum.parameters().cast::<f64>();
        let z @ [a1, a2, p1, p2]: [f64; 4] = state.cast().into();

        let (s1, c1) = a1.sin_cos();

        let (s2, c2) = a2.sin_cos();
        let elbow = a1 - a2;
        let (sin_d, cos_d) = elbow.sin_cos();
        let den = parameters.m1 + parameters.m2 * sin_d * sin_d;
        // With this sign of cos D every term of the bracket is positive.
        let uncancelled = [largest(&[s1 * c2, c1 * s2]), -largest(&[c1 * c2, s1 * s2])];
        let magnitudes = page_terms(&parameters, [a1, a2, p1.abs(), p2.abs()], den, uncancelled);

        let page = page_terms(&parameters, z, den, [sin_d, cos_d]);
        let values = pendulum.derivatives(&state.into()).map(R::to_f64);
        for i in 0..4 {
            let exact = page[i].iter().sum();
            let scale = largest(&magnitudes[i]);
            assert_near(
                EQUATIONS[i],
                values[i],
                exact,
                scale,
                tolerances::DERIVATIVES.of::<R>(),
                &parameters,
            );
        }
    }
}

#[test]
fn derivatives_are_those_of_the_book_in_either_precision() {
    derivatives_are_the_pages::<f32>();
    derivatives_are_the_pages::<f64>();
}

/// Relative to the energies that are subtracted. The truncation error is 1e-11, the rounding error
/// 1e-16/[`STEP`] = 1e-11; the rest is the curvature of 1/den for masses 100 : 1.
const GRADIENT: f64 = 1e-7;
const STEP: f64 = 1.0 / 131_072.0;

/// H is quadratic in the momenta, so that a central difference in the momenta is exact for any
/// step.
#[test]
fn derivatives_are_the_gradient_of_h() {
    for (pendulum, state) in random::pendulums::<f64>(2, STATES) {
        let z: [f64; 4] = state.into();
        let bounds = pendulum.bounds(&state);
        let slope = |i: usize, step: f64| {
            let [ahead, behind] = [step, -step].map(|by| {
                let mut moved = z;
                moved[i] += by;
                pendulum.energy(&moved.into())
            });
            (ahead - behind) / (2.0 * step)
        };

        let gradient = [
            slope(2, bounds.p1),
            slope(3, bounds.p2),
            -slope(0, STEP),
            -slope(1, STEP),
        ];

        let range = pendulum.energy_above_rest(&state) - pendulum.least_energy();
        let scales = [bounds.w1, bounds.w2, range, range];
        let values = pendulum.derivatives(&z);
        for i in 0..4 {
            assert_near(
                format_args!("{} compared with the gradient of H", EQUATIONS[i]),
                values[i],
                gradient[i],
                scales[i],
                GRADIENT,
                pendulum.parameters(),
            );
        }
    }
}

/// A difference of cosines would give 0.
#[test]
fn energy_above_rest_is_accurate_in_a_tiny_motion() {
    let pendulum = Pendulum::new(&Parameters {
        m1: 1.0_f32,
        m2: 1.0,
        l1: 1.0,
        l2: 1.0,
        g: 9.8,
    })
    .expect("valid");

    // The angles are so small that the cosines round to 1.
    let above = pendulum.energy_above_rest(&State::at_rest(1e-10, 2e-10));
    let exact = 9.8 * (2.0 * 1e-20 + 4e-20) / 2.0; // K = ((m1 + m2) g l1 a1^2 + m2 g l2 a2^2)/2
    assert!(
        (f64::from(above) / exact - 1.0).abs() < tolerances::FORMULAS.single,
        "{above} instead of {exact}"
    );
}

#[test]
fn only_motions_below_the_turnover_energy_are_certain_not_to_turn_over() {
    for (g, a2, is_certain) in [(0.0, 0.0, false), (9.81, 0.0, true), (9.81, PI, false)] {
        let parameters = Parameters::equal_rods(1.0, 1.0, g);
        let pendulum = Pendulum::new(&parameters).expect("valid");
        let start = State::at_rest(0.0, a2);
        assert_eq!(pendulum.cannot_turn_over(&start), is_certain, "{g}, {a2}");
    }
}
