//! Hamilton's equations: what must hold at every state, against the page's form and the gradient of H.

use double_pendulum::{EqualRods, Parameters, Pendulum, Real, State, Units};
use fastrand::Rng;
use host_tests::oracle::reference::Constants;
use host_tests::oracle::reference::series::{divide, sin_cos};
use host_tests::oracle::{random, textbook, tolerances};
use twofloat::TwoFloat;

const STATES: usize = 100_000;

/// Random pendulums and states as f64 that are exact in f32, with the kernel's pendulum in `R`.
fn each_state<R: Real>(seed: u64, states: usize, mut check: impl FnMut(&Parameters<f64>, &Pendulum<R>, &State<f64>)) {
    let mut rng = Rng::with_seed(seed);
    for _ in 0..states {
        let parameters = random::parameters(&mut rng);
        let state = random::state(&mut rng, &parameters);
        check(&parameters, &pendulum(&parameters), &state);
    }
}

fn pendulum<R: Real>(parameters: &Parameters<f64>) -> Pendulum<R> {
    Pendulum::new(parameters.cast()).expect("random parameters are valid")
}

fn derivatives<R: Real>(pendulum: &Pendulum<R>, state: &State<f64>) -> [f64; 4] {
    let z: [f64; 4] = (*state).into();
    pendulum.derivatives(&z.map(R::from_f64)).map(R::to_f64)
}

/// Each of `values` against `exact`, relative to the largest term.
fn assert_close<R: Real>(values: [f64; 4], exact: [f64; 4], largest_terms: [f64; 4], what: &Parameters<f64>) {
    for i in 0..4 {
        let error = (values[i] - exact[i]).abs() / largest_terms[i];
        assert!(error <= tolerances::DERIVATIVES.of::<R>(), "component {i} is off by {error:e} for {what:?}");
    }
}

fn derivatives_are_the_pages<R: Real>() {
    each_state::<R>(1, STATES, |parameters, pendulum, state| {
        let page = textbook::general_form(parameters, &(*state).into());
        assert_close::<R>(derivatives(pendulum, state), page.derivatives, page.largest_terms, parameters);
    });
}

#[test]
fn derivatives_are_the_pages_f32() {
    derivatives_are_the_pages::<f32>();
}

#[test]
fn derivatives_are_the_pages_f64() {
    derivatives_are_the_pages::<f64>();
}

/// The textbook H in double-double precision, from p1, p2 and the sines and cosines of a1, a2.
fn hamiltonian(constants: &Constants, p: [TwoFloat; 2], [(s1, c1), (s2, c2)]: [(TwoFloat, TwoFloat); 2]) -> TwoFloat {
    let Constants { masses: [m1, m2], lengths: [l1, l2], gravity: g } = *constants;
    let [p1, p2] = p;
    let (sin_d, cos_d) = (s1 * c2 - c1 * s2, c1 * c2 + s1 * s2);
    let numerator = p1 * p1 * m2 * l2 * l2 + p2 * p2 * (m1 + m2) * l1 * l1 - p1 * p2 * m2 * l1 * l2 * cos_d * 2.0;
    let denominator = m2 * l1 * l1 * l2 * l2 * (m1 + m2 * sin_d * sin_d) * 2.0;
    divide(numerator, denominator) - (m1 + m2) * g * l1 * c1 - m2 * g * l2 * c2
}

/// (dH/dp1, dH/dp2, -dH/da1, -dH/da2) by central differences with a step of 2^-40, good to 1e-19.
fn gradient(constants: &Constants, &State { a1, a2, p1, p2 }: &State<f64>) -> [f64; 4] {
    let step = 2_f64.powi(-40);
    let (sin_h, cos_h) = sin_cos(step.into());
    let turned = |(s, c): (TwoFloat, TwoFloat), by: TwoFloat| (s * cos_h + c * by, c * cos_h - s * by);
    let (wave1, wave2) = (sin_cos(a1.into()), sin_cos(a2.into()));
    let p = [p1, p2].map(TwoFloat::from);
    let slope = |h: &dyn Fn(TwoFloat) -> TwoFloat, by: TwoFloat| f64::from((h(by) - h(-by)) / (2.0 * step));
    [
        slope(&|h| hamiltonian(constants, [p[0] + h, p[1]], [wave1, wave2]), step.into()),
        slope(&|h| hamiltonian(constants, [p[0], p[1] + h], [wave1, wave2]), step.into()),
        -slope(&|h| hamiltonian(constants, p, [turned(wave1, h), wave2]), sin_h),
        -slope(&|h| hamiltonian(constants, p, [wave1, turned(wave2, h)]), sin_h),
    ]
}

fn derivatives_are_the_gradient_of_h<R: Real>() {
    each_state::<R>(2, STATES, |parameters, pendulum, state| {
        let largest = textbook::general_form(parameters, &(*state).into()).largest_terms;
        let gradient = gradient(&parameters.into(), state);
        assert_close::<R>(derivatives(pendulum, state), gradient, largest, parameters);
    });
}

#[test]
fn derivatives_are_the_gradient_of_h_f32() {
    derivatives_are_the_gradient_of_h::<f32>();
}

#[test]
fn derivatives_are_the_gradient_of_h_f64() {
    derivatives_are_the_gradient_of_h::<f64>();
}

fn energy_is_h<R: Real>() {
    each_state::<R>(3, 10_000, |parameters, pendulum, state| {
        let [p1, p2] = [state.p1, state.p2].map(TwoFloat::from);
        let waves = [state.a1, state.a2].map(|a| sin_cos(a.into()));
        let exact = hamiltonian(&parameters.into(), [p1, p2], waves);
        let z: [f64; 4] = (*state).into();
        let state = State::from(z.map(R::from_f64));
        let range = pendulum.energy_above_rest(&state).to_f64() - pendulum.least_energy().to_f64();
        let error = |energy: R| f64::from(exact - energy.to_f64()).abs() / range;
        let worst =
            error(pendulum.energy(&state)).max(error(pendulum.energy_above_rest(&state) + pendulum.least_energy()));
        assert!(worst <= tolerances::FORMULAS.of::<R>(), "H is off by {worst:e} for {parameters:?}");
    });
}

#[test]
fn energy_is_h_f32() {
    energy_is_h::<f32>();
}

#[test]
fn energy_is_h_f64() {
    energy_is_h::<f64>();
}

#[test]
fn energy_above_rest_keeps_its_precision_in_the_smallest_motion() {
    let pendulum = Pendulum::new(Parameters { m1: 1.0_f32, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.8 }).expect("valid");
    let above = pendulum.energy_above_rest(&State::at_rest(1e-10, 2e-10));
    let exact = 9.8 * (2.0 * 1e-20 + 4e-20) / 2.0; // K = ((m1 + m2) g l1 a1^2 + m2 g l2 a2^2)/2
    assert!((f64::from(above) / exact - 1.0).abs() < tolerances::FORMULAS.single, "{above} instead of {exact}");
}

#[test]
fn phase_flow_has_no_divergence() {
    let h = 2_f64.powi(-17);
    each_state::<f64>(4, 10_000, |parameters, pendulum, state| {
        let z: [f64; 4] = (*state).into();
        let moved = |i: usize, by: f64| {
            let mut z = z;
            z[i] += by;
            pendulum.derivatives(&z)[i]
        };
        let slopes: [f64; 4] = std::array::from_fn(|i| (moved(i, h) - moved(i, -h)) / (2.0 * h));
        let largest = slopes.iter().fold(1.0_f64, |largest, slope| largest.max(slope.abs()));
        let divergence = slopes.iter().sum::<f64>().abs() / largest;
        assert!(divergence < tolerances::DIVERGENCE, "divergence {divergence:e} for {parameters:?}");
    });
}

fn equal_rods_are_the_general_form<R: Real>() {
    let mut rng = Rng::with_seed(5);
    for _ in 0..10_000 {
        let own = Parameters::equal_rods(random::log_uniform(&mut rng, 0.01, 100.0) as f32 as f64, 1.0, 1.0);
        let z: [f64; 4] = random::state(&mut rng, &own).into();
        let z = z.map(R::from_f64);
        let rods = EqualRods::new(R::from_f64(own.m2)).expect("a valid mass ratio");
        // in its own units it is the general form to the bit
        assert_eq!(rods.derivatives(&z), pendulum::<R>(&own).derivatives(&z));
        let state = State::from(z);
        assert_eq!(rods.energy(&state), pendulum::<R>(&own).energy(&state));
        assert_eq!(rods.energy_above_rest(&state), pendulum::<R>(&own).energy_above_rest(&state));
        assert_eq!(rods.to_motion(&state), pendulum::<R>(&own).to_motion(&state));
        assert_eq!(rods.parameters(), *pendulum::<R>(&own).parameters());
    }
}

#[test]
fn equal_rods_are_the_general_form_f32() {
    equal_rods_are_the_general_form::<f32>();
}

#[test]
fn equal_rods_are_the_general_form_f64() {
    equal_rods_are_the_general_form::<f64>();
}

#[test]
fn units_turn_equal_rods_into_si() {
    let si = Parameters { m1: 0.7, m2: 1.9, l1: 0.25, l2: 0.25, g: 9.8 };
    let units = Units::of(&si).expect("equal rods");
    let rods = EqualRods::new(si.mass_ratio()).expect("a valid mass ratio");
    let mut state = State { a1: 0.4, a2: -1.1, p1: 0.05, p2: -0.08 };
    let mut own = units.from_si(&state);
    let general: Pendulum<f64> = pendulum(&si);
    let energy = rods.energy(&own) * units.energy;
    assert!((energy - general.energy(&state)).abs() < tolerances::FORMULAS.double * 10.0, "{energy} J");
    let back = rods.to_state(&rods.to_motion(&own));
    let error = (back.p1 - own.p1).abs().max((back.p2 - own.p2).abs());
    assert!(error < tolerances::FORMULAS.double, "momenta come back {error:e} off");
    let w1 = rods.to_motion(&own).w1 * units.angular_velocity;
    assert!((w1 - general.to_motion(&state).w1).abs() < tolerances::FORMULAS.double * 10.0, "{w1} rad/s");
    for _ in 0..1024 {
        state = general.step(&state, 1.0 / 1024.0);
        own = rods.step(&own, 1.0 / 1024.0 / units.time);
    }
    let [own, state]: [[f64; 4]; 2] = [units.to_si(&own).into(), state.into()];
    for (own, si) in own.into_iter().zip(state) {
        assert!((own - si).abs() < tolerances::RETURN, "{own} instead of {si}");
    }
}
