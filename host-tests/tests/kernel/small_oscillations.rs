//! Small oscillations: the book's figures, the frequencies to the last place, and the limit of the exact motion.

use std::f64::consts::{FRAC_PI_6, PI, TAU};

use double_pendulum::{
    Error, Mode, Modes, Motion, Parameter, Parameters, Pendulum, Real, SmallOscillations, periodic_mass_ratio,
};
use fastrand::Rng;
use host_tests::oracle::random::{log_uniform, symmetric};
use host_tests::oracle::reference::series::divide;
use host_tests::oracle::reference::{Constants, Reference};
use host_tests::oracle::tolerances;
use twofloat::TwoFloat;

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
        let amplitude = (motion.fast().amplitude() + motion.slow().amplitude()).to_degrees();
        assert!((amplitude - largest_a1).abs() < 0.5e-4, "{mu}: {amplitude} degrees");
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

#[test]
fn carrier_modulation_and_exchange() {
    let (modes, _) = figure(1.0);
    let (w1, w2) = (modes.fast.frequency, modes.slow.frequency);
    for (value, exact) in
        [(modes.carrier(), (w1 + w2) / 2.0), (modes.modulation(), (w1 - w2) / 2.0), (modes.exchange(), w1 - w2)]
    {
        assert!((value - exact).abs() < tolerances::FORMULAS.double * exact, "{value} instead of {exact}");
    }
}

/// The modes by the book's own formulas, differences and all, in double-double precision.
fn exact_modes(parameters: &Parameters<f64>) -> [TwoFloat; 5] {
    let Constants { masses: [m1, m2], lengths: [l1, l2], gravity: g } = parameters.into();
    let total = m1 + m2;
    let sum = l1 + l2;
    let root = (total * (total * sum * sum - m1 * l1 * l2 * 4.0)).sqrt();
    let square = |sign: f64| divide(g * (total * sum + root * sign), m1 * l1 * l2 * 2.0);
    let shape = |square: TwoFloat| divide(square * l1, g - square * l2);
    let (fast, slow) = (square(1.0), square(-1.0));
    [fast.sqrt(), slow.sqrt(), shape(fast), shape(slow), fast.sqrt() - slow.sqrt()]
}

/// How far `value` is from `exact`, in units of the last place of `R` there.
fn ulps<R: Real>(value: R, exact: TwoFloat) -> f64 {
    let binade = 2_f64.powi(f64::from(exact).abs().log2().floor() as i32);
    f64::from(exact - value.to_f64()).abs() / (binade * R::EPSILON.to_f64())
}

fn modes_to_the_last_places<R: Real>() {
    let mut rng = Rng::with_seed(1);
    for n in 0..50_000 {
        let rounded = |x: f64| R::from_f64(x).to_f64();
        let m1 = rounded(log_uniform(&mut rng, 0.1, 10.0));
        let l1 = rounded(log_uniform(&mut rng, 0.1, 10.0));
        let parameters = Parameters {
            m1,
            m2: rounded(m1 * log_uniform(&mut rng, 1e-7, 1e7)),
            l1,
            // every other pendulum has equal rods, where the plain formula cancels
            l2: if n % 2 == 0 { l1 } else { rounded(l1 * log_uniform(&mut rng, 1e-3, 1e3)) },
            g: rounded(log_uniform(&mut rng, 1.0, 20.0)),
        };
        let modes = Modes::new(&parameters.cast::<R>()).expect("valid parameters");
        let values = [modes.fast.frequency, modes.slow.frequency, modes.fast.shape, modes.slow.shape, modes.exchange()];
        for (i, (value, exact)) in values.into_iter().zip(exact_modes(&parameters)).enumerate() {
            let error = ulps(value, exact);
            let budget = if i < 2 { tolerances::FREQUENCY_ULP } else { tolerances::MODE_ULP };
            assert!(error <= budget, "number {i} is off by {error} ulp for {parameters:?}");
        }
    }
}

#[test]
fn modes_to_the_last_places_f32() {
    modes_to_the_last_places::<f32>();
}

#[test]
fn modes_to_the_last_places_f64() {
    modes_to_the_last_places::<f64>();
}

/// K h = w^2 M h for both modes, h = (1, r).
#[test]
fn modes_solve_the_matrix_equation() {
    let mut rng = Rng::with_seed(2);
    for _ in 0..1000 {
        let pendulum = Pendulum::new(host_tests::oracle::random::parameters(&mut rng)).expect("valid parameters");
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

/// Whatever the masses, lengths, angles and velocities: at 1e-6 rad the exact motion is the linear one.
#[test]
fn linear_motion_is_the_limit_of_the_exact_motion() {
    let mut rng = Rng::with_seed(3);
    for _ in 0..20 {
        let parameters = host_tests::oracle::random::parameters(&mut rng);
        let modes = Modes::new(&parameters).expect("there is gravity");
        let rate = 1e-6 * modes.slow.frequency;
        let [a1, a2, w1, w2] = [1e-6, 1e-6, rate, rate].map(|size| size * symmetric(&mut rng));
        let start = Motion { a1, a2, w1, w2 };
        let linear = SmallOscillations::new(modes, &start);
        let mut exact = Reference::new(&parameters, &start);
        for t in [0.0, 1.0, 10.0] {
            exact.advance_to(t);
            let [linear, exact]: [[f64; 4]; 2] = [linear.at(t).into(), exact.motion().into()];
            let fast = modes.fast.frequency;
            for (i, scale) in [1e-6, 1e-6, 1e-6 * fast, 1e-6 * fast].into_iter().enumerate() {
                let error = (linear[i] - exact[i]).abs() / scale;
                assert!(error < tolerances::LINEAR, "component {i} at {t} s: {error:e} for {parameters:?}");
            }
        }
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
fn directions_are_those_of_the_angles_f32() {
    directions_are_those_of_the_angles::<f32>();
}

#[test]
fn directions_are_those_of_the_angles_f64() {
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
        let modes = Modes::new(&host_tests::oracle::random::parameters(&mut rng)).expect("there is gravity");
        let [a1, a2, w1, w2] = [0; 4].map(|_| symmetric(&mut rng));
        let motion = SmallOscillations::<f64>::new(modes, &Motion { a1, a2, w1, w2 });
        let t = 3.0 * rng.f64();
        let (fast, slow) = (motion.fast(), motion.slow());
        let a1 = fast.amplitude() * (modes.fast.frequency * t + fast.phase()).cos()
            + slow.amplitude() * (modes.slow.frequency * t + slow.phase()).cos();
        let scale = (fast.amplitude() + slow.amplitude()) * (1.0 + modes.fast.frequency * t);
        assert!((motion.at(t).a1 - a1).abs() < tolerances::FORMULAS.double * scale, "{a1}");
    }
}

#[test]
fn periodic_mass_ratios_of_equal_rods() {
    for (fast, slow, mu) in [(3, 2, 25.0 / 144.0), (2, 1, 9.0 / 16.0), (5, 2, 441.0 / 400.0), (3, 1, 16.0 / 9.0)] {
        assert_eq!(periodic_mass_ratio(fast, slow, [1.0, 1.0]), Ok(mu));
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
        assert!((later.a1 - start.a1).abs() + (later.a2 - start.a2).abs() < tolerances::PERIOD, "{later:?}");
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

/// About the inverted rest the two frequencies are growth rates: a push along a mode's shape grows as e^(wt).
#[test]
fn inverted_rest_falls_at_the_same_two_rates() {
    let parameters = Parameters { m1: 1.3, m2: 0.4, l1: 0.7, l2: 1.1, g: 9.81 };
    let modes = Modes::new(&parameters).expect("valid parameters");
    let upright = twofloat::consts::PI;
    for Mode { frequency, shape } in [modes.fast, modes.slow] {
        let push = 1e-10;
        let angles = [upright + push, upright + push * shape];
        let velocities = [push * frequency, push * shape * frequency].map(TwoFloat::from);
        let mut exact = Reference::exact((&parameters).into(), angles, velocities);
        exact.advance_to(1.0);
        let [a1, a2, ..] = exact.exact_state();
        let growth = [f64::from(a1 - upright) / push, f64::from(a2 - upright) / (push * shape)];
        for growth in growth {
            assert!(
                (growth / frequency.exp() - 1.0).abs() < tolerances::INVERTED_GROWTH,
                "{growth} instead of {}",
                frequency.exp()
            );
        }
    }
}
