//! Small oscillations: frequencies accurate to the last place, and the limit of the exact motion.

use double_pendulum::{Mode, Modes, Motion, Parameters, Real, SmallOscillations};
use exact::random::{log_uniform, parameters, symmetric};
use exact::taylor::{Reference, divide};
use exact::twofloat::TwoFloat;
use fastrand::Rng;

/// The errors of the fast and the slow normal frequency, of the fast and the slow mode shape, and
/// of the difference of the frequencies, in ulps of the numbers, `f32` or `f64`: nine roundings,
/// halved by the square root, and up to ten roundings.
const MODES: [f64; 5] = [4.0, 4.0, 10.0, 10.0, 10.0];

/// The error of the linear motion compared with the exact motion at 1e-6 rad, within 10 s, relative
/// to the amplitude and, in velocities, to the amplitude times the fast frequency: five times the
/// neglected cubic term, 1e-12, times the radians swung in that time (up to 200).
const LINEAR: f64 = 1e-9;

/// The relative error of the factor by which a push of 1e-10 rad from both rods straight up grows
/// in 1 s, in the reference compared with e to the power of a mode's frequency: the contributions
/// of the cubic term and of the other mode, which the rounding of the shape excites.
const INVERTED_GROWTH: f64 = 1e-9;

/// Returns the modes and the difference of the frequencies, in double-double precision, by formulas
/// in which nothing cancels.
fn exact_modes(&Parameters { m1, m2, l1, l2, g }: &Parameters<f64>) -> [TwoFloat; 5] {
    let is_lower_shorter = l2 < l1;
    let [m1, m2, l1, l2, g] = [m1, m2, l1, l2, g].map(TwoFloat::from);
    let total = m1 + m2;
    let sum = l1 + l2;
    let difference = l1 - l2;
    let inertia = m1 * l1 * l2;
    let root = (total * (m1 * difference * difference + m2 * sum * sum)).sqrt();

    // The squares of the frequencies, whose product is M g^2/(m1 l1 l2).
    let fast = divide(g * (total * sum + root), inertia * 2.0);
    let slow = divide(total * g * g, inertia * fast);

    // The shape of the slow mode follows from either equation, that of the fast mode from the
    // product of both.
    let slow_shape = if is_lower_shorter {
        divide(slow * l1, g - slow * l2)
    } else {
        divide(total * (g - slow * l1), slow * m2 * l2)
    };
    let fast_shape = divide(total * l1, m2 * l2 * slow_shape) * -1.0;

    let [fast_root, slow_root] = [fast.sqrt(), slow.sqrt()];
    [
        fast_root,
        slow_root,
        fast_shape,
        slow_shape,
        divide(g * root, inertia * (fast_root + slow_root)),
    ]
}

fn ulps<R: Real>(value: R, exact: TwoFloat) -> f64 {
    let binade = 2_f64.powi(f64::from(exact).abs().log2().floor() as i32);
    f64::from(exact - value.to_f64()).abs() / (binade * R::EPSILON.to_f64())
}

fn modes_to_the_last_places<R: Real>() {
    let mut rng = Rng::with_seed(1);
    let mut accepted = 0;
    for n in 0..50_000 {
        let [m1, m2, l1, other, g] = [(); 5].map(|()| log_uniform(&mut rng, 1.01e-9, 0.99e9));

        // Every other pendulum has equal rods. The plain formula would cancel there.
        let l2 = if n % 2 == 0 { l1 } else { other };
        let parameters = Parameters { m1, m2, l1, l2, g }.cast::<R>().cast::<f64>();

        let Ok(modes) = Modes::new(&parameters.cast::<R>()) else {
            continue;
        };
        accepted += 1;
        let values = [
            modes.fast.frequency,
            modes.slow.frequency,
            modes.fast.shape,
            modes.slow.shape,
            modes.exchange(),
        ];

        for ((value, exact), most) in values.into_iter().zip(exact_modes(&parameters)).zip(MODES) {
            let error = ulps(value, exact);
            assert!(
                error <= most,
                "{value} is off by {error} ulp for {parameters:?}"
            );
        }
    }
    assert!(accepted > 40_000, "only {accepted}");
}

/// Half of the pendulums have equal rods, where plain formulas lose digits.
#[test]
fn modes_are_accurate_to_the_last_places() {
    modes_to_the_last_places::<f32>();
    modes_to_the_last_places::<f64>();
}

#[test]
fn linear_motion_is_the_limit_of_the_exact_motion() {
    let mut rng = Rng::with_seed(3);
    for _ in 0..20 {
        let parameters = parameters(&mut rng);
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
            for (i, scale) in [1e-6, 1e-6, 1e-6 * fast, 1e-6 * fast]
                .into_iter()
                .enumerate()
            {
                let error = (linear[i] - exact[i]).abs() / scale;
                assert!(
                    error < LINEAR,
                    "component {i} at {t} s: {error:e} for {parameters:?}"
                );
            }
        }
    }
}

/// A push of 1e-10 rad along a mode's shape grows as e^(wt).
#[test]
fn upright_pendulum_falls_at_the_rates_of_the_modes() {
    let parameters @ Parameters { m1, m2, l1, l2, g } = Parameters {
        m1: 1.3,
        m2: 0.4,
        l1: 0.7,
        l2: 1.1,
        g: 9.81,
    };

    let modes = Modes::new(&parameters).expect("valid parameters");
    let upright = exact::twofloat::consts::PI;
    for Mode { frequency, shape } in [modes.fast, modes.slow] {
        // The push is so small that the motion remains linear.
        let push = 1e-10;
        let [w1, w2] = [push * frequency, push * shape * frequency].map(TwoFloat::from);
        let constants = Parameters {
            m1: m1.into(),
            m2: m2.into(),
            l1: l1.into(),
            l2: l2.into(),
            g: g.into(),
        };

        let mut exact =
            Reference::exact(constants, [upright + push, upright + push * shape, w1, w2]);
        exact.advance_to(1.0);
        let [a1, a2, ..] = exact.exact_state();

        let growth = [
            f64::from(a1 - upright) / push,
            f64::from(a2 - upright) / (push * shape),
        ];
        let expected = frequency.exp();
        for growth in growth {
            let error = (growth / expected - 1.0).abs();
            assert!(error < INVERTED_GROWTH, "{growth} instead of {expected}");
        }
    }
}
