use core::f64::consts::{FRAC_PI_6, TAU};

use double_pendulum::{
    Mode, Modes, Motion, Parameters, Pendulum, Real, SmallOscillations, periodic_mass_ratio,
};
use fastrand::Rng;

use super::random::symmetric;
use super::{random, tolerances};

/// The rounding error of w t, 40 rad, in both modes.
const PERIOD: f64 = 1e-13;

/// Figures 3 to 5: mu, w1, w2, the period of the envelope (s), and the largest |a1| (degrees),
/// computed to six digits.
const FIGURES: [[f64; 5]; 3] = [
    [0.2, 8.139042, 5.275983, 2.194571, 12.2474],
    [1.0, 11.568802, 4.791955, 0.927155, 21.2132],
    [5.0, 21.211017, 4.526893, 0.376597, 27.3861],
];

/// The motions are a1 = (pi/12) sqrt(mu/(1 + mu)) (cos w2 t - cos w1 t), a2 = (pi/12)(cos w1 t +
/// cos w2 t).
#[test]
fn figures_3_to_5_are_those_of_the_book() {
    for [mu, w1, w2, envelope, largest_a1] in FIGURES {
        let modes = Modes::new(&Parameters::equal_rods(mu, 0.25, 9.8)).expect("valid parameters");
        let start = Motion::at_rest(0.0, FRAC_PI_6);
        let double = SmallOscillations::new(modes, &start);
        let single = SmallOscillations::new(modes, &start.cast());
        let fast = modes.fast.frequency;
        let slow = modes.slow.frequency;
        let amplitude = (double.fast.amplitude() + double.slow.amplitude()).to_degrees();

        for (value, exact, digits) in [
            (fast, w1, 1e-6),
            (slow, w2, 1e-6),
            (modes.carrier() + modes.modulation(), w1, 1e-6),
            (modes.carrier() - modes.modulation(), w2, 1e-6),
            (TAU / modes.exchange(), envelope, 1e-6),
            (amplitude, largest_a1, 1e-4),
        ] {
            assert!(
                (value - exact).abs() < 0.5 * digits,
                "{mu}: {value} instead of {exact}"
            );
        }

        let off = |t: f64, [a1, a2]: [f64; 2]| {
            let fast = (fast * t).cos();
            let slow = (slow * t).cos();
            let exact1 = FRAC_PI_6 / 2.0 * (mu / (1.0 + mu)).sqrt() * (slow - fast);
            let exact2 = FRAC_PI_6 / 2.0 * (fast + slow);
            (a1 - exact1).abs().max((a2 - exact2).abs())
        };

        // In `f32` after half a day and a day, too.
        for t in (0..600).map(|tick| f64::from(tick) / 60.0) {
            let error = off(t, double.at(t).angles());
            assert!(
                error < tolerances::FORMULAS.double,
                "{mu} at {t} s: {error:e} rad"
            );
            for later in [0.0, 12.0, 24.0].map(|hours| 3600.0 * hours + t) {
                let error = off(later, single.at(later).angles().map(f64::from));
                assert!(
                    error <= FRAC_PI_6 * tolerances::CLOSED_FORM,
                    "{mu} in f32 at {later} s: {error:e} rad"
                );
            }

            directions_are_those_of_the_angles::<f64>(&double, t);
            directions_are_those_of_the_angles::<f32>(&single, t);
        }

        // Large angles, of 0.9 to 10 rad.
        for start in [0.9, 2.0, 3.0, 10.0].map(|a1| Motion::at_rest(a1, -0.5)) {
            let double = SmallOscillations::new(modes, &start);
            let single = SmallOscillations::new(modes, &start.cast());
            for t in (0..60).map(|tick| f64::from(tick) / 60.0) {
                directions_are_those_of_the_angles::<f64>(&double, t);
                directions_are_those_of_the_angles::<f32>(&single, t);
            }
        }
    }
}

/// The omitted terms of the series, for angles of at most 0.6 rad, are a^5/120 and a^6/720.
fn directions_are_those_of_the_angles<R: Real>(motion: &SmallOscillations<R>, t: f64) {
    let rounding = tolerances::FORMULAS.of::<R>();
    for (direction, a) in motion
        .directions(t)
        .into_iter()
        .zip(motion.at(t).angles().map(R::to_f64))
    {
        let [sine, cosine] = direction.map(R::to_f64);

        let small = a.abs().min(0.6);
        assert!(
            (sine - a.sin()).abs() <= small.powi(5) / 120.0 + rounding * (1.0 + a.abs()),
            "{t:?}: sin {a} = {sine}"
        );
        assert!(
            (cosine - a.cos()).abs() <= small.powi(6) / 720.0 + rounding * (1.0 + a.abs()),
            "{t:?}: cos {a} = {cosine}"
        );
    }
}

/// The modes satisfy K h = w^2 M h with h = (1, r).
#[test]
fn modes_solve_the_matrix_equation_and_motions_have_amplitudes_and_phases() {
    let mut rng = Rng::with_seed(2);
    for _ in 0..1000 {
        let pendulum = Pendulum::new(&random::parameters(&mut rng)).expect("valid parameters");
        let mass = pendulum.mass_matrix(1.0);
        let stiffness = pendulum.stiffness();
        let modes = pendulum.modes().expect("there is gravity");
        for Mode { frequency, shape } in [modes.fast, modes.slow] {
            for row in 0..2 {
                let force = stiffness[row][0] + stiffness[row][1] * shape;
                let inertia = frequency * frequency * (mass[row][0] + mass[row][1] * shape);
                let scale = frequency * frequency * (mass[row][0] + mass[row][1] * shape.abs());
                let error = (force - inertia).abs() / scale;
                assert!(
                    error < tolerances::FORMULAS.double,
                    "{error:e} for {:?}",
                    pendulum.parameters()
                );
            }
        }

        let motion =
            SmallOscillations::<f64>::new(modes, &[0; 4].map(|_| symmetric(&mut rng)).into());
        let t = 3.0 * rng.f64();
        let fast = motion.fast;
        let slow = motion.slow;
        let a1 = fast.amplitude() * (modes.fast.frequency * t + fast.phase()).cos()
            + slow.amplitude() * (modes.slow.frequency * t + slow.phase()).cos();
        let scale = (fast.amplitude() + slow.amplitude()) * (1.0 + modes.fast.frequency * t);
        assert!(
            (motion.at(t).a1 - a1).abs() < tolerances::FORMULAS.double * scale,
            "{a1}"
        );
    }
}

/// For equal rods the ratio is a fraction of two whole numbers.
#[test]
fn motions_with_a_periodic_mass_ratio_repeat() {
    for (fast, slow, lengths @ [l1, l2], exact) in [
        (3, 2, [1.0, 1.0], Some(25.0 / 144.0)),
        (2, 1, [1.0, 1.0], Some(9.0 / 16.0)),
        (5, 2, [1.0, 1.0], Some(441.0 / 400.0)),
        (3, 1, [1.0, 1.0], Some(16.0 / 9.0)),
        (5, 2, [0.3, 1.1], None),
        (7, 3, [2.0, 0.5], None),
    ] {
        let mu = periodic_mass_ratio(fast, slow, lengths).expect("the ratio is possible");

        assert!(
            exact.is_none_or(|exact| mu == exact),
            "{mu} instead of {exact:?}"
        );

        let modes = Modes::new(&Parameters {
            m1: 1.0,
            m2: mu,
            l1,
            l2,
            g: 9.8,
        })
        .expect("valid parameters");

        let ratio = modes.fast.frequency / modes.slow.frequency;
        assert!(
            (ratio * f64::from(slow) / f64::from(fast) - 1.0).abs() < tolerances::FORMULAS.double,
            "{ratio}"
        );

        let motion = SmallOscillations::<f64>::new(
            modes,
            &Motion {
                a1: 0.1,
                a2: -0.2,
                w1: 0.3,
                w2: 0.4,
            },
        );

        let period = TAU * f64::from(fast) / modes.fast.frequency;
        let start = motion.at(0.0);
        let later = motion.at(period);
        assert!(
            (later.a1 - start.a1).abs() + (later.a2 - start.a2).abs() < PERIOD,
            "{later:?}"
        );
    }
}
