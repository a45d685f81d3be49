//! Small oscillations: the book's figures, and what modes and motions in them are.

use core::f64::consts::{FRAC_PI_6, PI, TAU};

use double_pendulum::{
    Error, Mode, Modes, Motion, Parameter, Parameters, Pendulum, Real, SmallOscillations, periodic_mass_ratio,
};
use fastrand::Rng;

use super::random::symmetric;
use super::{random, tolerances};

/// A linear motion of 0.5 rad after a whole period, rad: the roundings of w t, 40 rad, in both modes.
const PERIOD: f64 = 1e-13;

/// Figures 3 to 5: mu, w1, w2, the envelope's period (s), the largest |a1| (degrees), as physics gives them to six digits.
const FIGURES: [[f64; 5]; 3] = [
    [0.2, 8.139042, 5.275983, 2.194571, 12.2474],
    [1.0, 11.568802, 4.791955, 0.927155, 21.2132],
    [5.0, 21.211017, 4.526893, 0.376597, 27.3861],
];

fn figure(mu: f64) -> (Modes<f64>, SmallOscillations<f64>) {
    let modes = Modes::new(&Parameters::equal_rods(mu, 0.25, 9.8)).expect("valid parameters");
    (modes, SmallOscillations::new(modes, &Motion::at_rest(0.0, FRAC_PI_6)))
}

#[test]
fn figures_3_to_5_to_all_digits() {
    for [mu, w1, w2, envelope, largest_a1] in FIGURES {
        let (modes, motion) = figure(mu);
        assert!((modes.fast.frequency - w1).abs() < 0.5e-6, "{mu}: w1 = {}", modes.fast.frequency);
        assert!((modes.slow.frequency - w2).abs() < 0.5e-6, "{mu}: w2 = {}", modes.slow.frequency);
        assert!((TAU / modes.exchange() - envelope).abs() < 0.5e-6, "{mu}: {} s", TAU / modes.exchange());
        let sums = [modes.carrier() + modes.modulation() - w1, modes.carrier() - modes.modulation() - w2];
        assert!(sums.iter().all(|off| off.abs() < 0.5e-6), "{mu}: {sums:?}");
        let amplitude = (motion.fast.amplitude() + motion.slow.amplitude()).to_degrees();
        assert!((amplitude - largest_a1).abs() < 0.5e-4, "{mu}: {amplitude} degrees");
    }
}

/// What is drawn are the sines and cosines of the angles but for the terms of the series that are left out.
fn directions_are_those_of_the_angles<R: Real>() {
    let modes = Modes::new(&Parameters::equal_rods(1.0, 0.25, 9.8)).expect("valid parameters");
    let motion = SmallOscillations::<R>::new(modes, &Motion::at_rest(0.0, FRAC_PI_6).cast());
    for tick in 0..600 {
        let t = f64::from(tick) / 60.0;
        let angles = motion.at(t).angles().map(R::to_f64);
        for ([sine, cosine], a) in
            motion.directions(t).map(|direction| direction.map(R::to_f64)).into_iter().zip(angles)
        {
            let rounding = tolerances::FORMULAS.of::<R>();
            assert!((sine - a.sin()).abs() <= a.abs().powi(5) / 120.0 + rounding, "{t:?}: sin {a} = {sine}");
            assert!((cosine - a.cos()).abs() <= a.powi(6) / 720.0 + rounding, "{t:?}: cos {a} = {cosine}");
        }
    }
}

#[test]
fn directions_are_those_of_the_angles_in_either_precision() {
    directions_are_those_of_the_angles::<f32>();
    directions_are_those_of_the_angles::<f64>();
}

/// In `f32`, figure 5 after half a day and a day: no phase is lost with the time.
#[test]
fn a_day_later_the_phase_is_right() {
    for mu in [0.2, 1.0, 5.0] {
        let (modes, exact) = figure(mu);
        let single = SmallOscillations::<f32>::new(modes, &Motion::at_rest(0.0, FRAC_PI_6).cast());
        for tick in 0..600 {
            for hours in [0.0, 12.0, 24.0] {
                let t = 3600.0 * hours + f64::from(tick) / 60.0;
                let [single, exact] = [single.at(t).angles().map(f64::from), exact.at(t).angles()];
                let error = (single[0] - exact[0]).abs().max((single[1] - exact[1]).abs());
                assert!(error <= FRAC_PI_6 * tolerances::CLOSED_FORM, "{mu} at {t} s: {error:e} rad");
            }
        }
    }
}

#[test]
fn amplitude_and_phase_are_the_same_oscillation() {
    let mut rng = Rng::with_seed(4);
    for _ in 0..1000 {
        let modes = Modes::new(&random::parameters(&mut rng)).expect("there is gravity");
        let [a1, a2, w1, w2] = [0; 4].map(|_| symmetric(&mut rng));
        let motion = SmallOscillations::<f64>::new(modes, &Motion { a1, a2, w1, w2 });
        let t = 3.0 * rng.f64();
        let (fast, slow) = (motion.fast, motion.slow);
        let a1 = fast.amplitude() * (modes.fast.frequency * t + fast.phase()).cos()
            + slow.amplitude() * (modes.slow.frequency * t + slow.phase()).cos();
        let scale = (fast.amplitude() + slow.amplitude()) * (1.0 + modes.fast.frequency * t);
        assert!((motion.at(t).a1 - a1).abs() < tolerances::FORMULAS.double * scale, "{a1}");
    }
}

#[test]
fn periodic_mass_ratios_of_any_rods_repeat() {
    for (fast, slow, lengths @ [l1, l2]) in [(3, 2, [1.0, 1.0]), (5, 2, [0.3, 1.1]), (7, 3, [2.0, 0.5])] {
        let mu = periodic_mass_ratio(fast, slow, lengths).expect("the ratio is possible");
        let modes = Modes::new(&Parameters { m1: 1.0, m2: mu, l1, l2, g: 9.8 }).expect("valid parameters");
        let ratio = modes.fast.frequency / modes.slow.frequency;
        assert!((ratio * f64::from(slow) / f64::from(fast) - 1.0).abs() < tolerances::FORMULAS.double, "{ratio}");
        let motion = SmallOscillations::new(modes, &Motion { a1: 0.1, a2: -0.2, w1: 0.3, w2: 0.4 });
        let period = TAU * f64::from(fast) / modes.fast.frequency;
        let (start, later) = (motion.at(0.0), motion.at(period));
        assert!((later.a1 - start.a1).abs() + (later.a2 - start.a2).abs() < PERIOD, "{later:?}");
    }
}

#[test]
fn impossible_periods_are_refused() {
    let refusal = |fast, slow, lengths: [f64; 2]| periodic_mass_ratio(fast, slow, lengths).expect_err("impossible");
    let infinite = periodic_mass_ratio(3, 0, [1.0, 1.0]);
    assert_eq!(infinite, Err(Error::NotFinite { parameter: Parameter::FrequencyRatio, value: f64::INFINITY }));
    let too_small = |value, limit| Error::TooSmall { parameter: Parameter::FrequencyRatio, value, limit };
    assert_eq!(refusal(1, 1, [1.0, 1.0]), too_small(1.0, 1.0));
    assert_eq!(refusal(3, 2, [4.0, 1.0]), too_small(1.5, 2.0));
    // at the limit bob 2 would have no mass
    assert_eq!(refusal(2, 1, [4.0, 1.0]), too_small(2.0, 2.0));
    assert_eq!(refusal(2, 1, [1.0, 4.0]), too_small(2.0, 2.0));
    assert_eq!(refusal(3, 2, [0.0, 1.0]), Error::NotPositive { parameter: Parameter::L1, value: 0.0 });
}

/// K h = w^2 M h for both modes, h = (1, r).
#[test]
fn modes_solve_the_matrix_equation() {
    let mut rng = Rng::with_seed(2);
    for _ in 0..1000 {
        let pendulum = Pendulum::new(&random::parameters(&mut rng)).expect("valid parameters");
        let (mass, stiffness) = (pendulum.mass_matrix(1.0), pendulum.stiffness());
        let modes = pendulum.modes().expect("there is gravity");
        for Mode { frequency, shape } in [modes.fast, modes.slow] {
            for row in 0..2 {
                let force = stiffness[row][0] + stiffness[row][1] * shape;
                let inertia = frequency * frequency * (mass[row][0] + mass[row][1] * shape);
                let scale = frequency * frequency * (mass[row][0] + mass[row][1] * shape.abs());
                let error = (force - inertia).abs() / scale;
                assert!(error < tolerances::FORMULAS.double, "{error:e} for {:?}", pendulum.parameters());
            }
        }
    }
}

#[test]
fn periodic_mass_ratios_of_equal_rods() {
    for (fast, slow, mu) in [(3, 2, 25.0 / 144.0), (2, 1, 9.0 / 16.0), (5, 2, 441.0 / 400.0), (3, 1, 16.0 / 9.0)] {
        assert_eq!(periodic_mass_ratio(fast, slow, [1.0, 1.0]), Ok(mu));
    }
}

/// a1 = (pi/12) sqrt(mu/(1 + mu)) (cos w2 t - cos w1 t), a2 = (pi/12)(cos w1 t + cos w2 t).
#[test]
fn worked_example() {
    for mu in [0.2, 1.0, 5.0] {
        let (modes, motion) = figure(mu);
        let (w1, w2) = (modes.fast.frequency, modes.slow.frequency);
        for t in (0..1000).map(|n| f64::from(n) / 100.0) {
            let a1 = PI / 12.0 * (mu / (1.0 + mu)).sqrt() * ((w2 * t).cos() - (w1 * t).cos());
            let a2 = PI / 12.0 * ((w1 * t).cos() + (w2 * t).cos());
            let now = motion.at(t);
            let error = (now.a1 - a1).abs().max((now.a2 - a2).abs());
            assert!(error < tolerances::FORMULAS.double, "mu = {mu}, t = {t}: off by {error:e}");
        }
    }
}
