//! Fixed point: its accuracy, its refusals, and its independence of the units.

use std::f64::consts::PI;

use double_pendulum::{Error, ExtrapolationF64, Fixed32, Fixed64, Form, Method};
use double_pendulum::{Motion, Parameter, Parameters, Pendulum, State};
use exact::random::{self, log_uniform, symmetric};
use exact::trials::{MOMENTS, Trial, largest_difference};
use firmware::config::GRAVITY;

/// The error of the angles by 32-bit fixed point in the regular scene for 10 s, rad, with steps so
/// fine that the method's error is smaller (measured 2e-9; compensated `f32` has 3e-8). It is also
/// the error of a start's momenta as they are reported, kg m^2/s.
const FIXED_32_FLOOR: f64 = 5e-9;

/// The smallest error, rad, at which the order is measured in 32-bit fixed point. The errors by
/// roundings scatter from step size to step size, and are smaller than this in most of the tried
/// motions.
const FIXED_32_ORDER_MEASURABLE: f64 = 5e-6;

/// The ratio in the same steps, in 5 s of the chaotic scene. The error of `f64` counts as at least
/// half of [`FIXED_64_FLOOR`].
const FIXED_64_AGAINST_DOUBLE: f64 = 2.0;

/// The error of an angle by 64-bit fixed point, rad, that is due to its roundings alone. In the
/// chaotic scene roundings of 2^-61, as often as weights of order 12 enlarge them, grow 2000-fold
/// in 5 s.
const FIXED_64_FLOOR: f64 = 1e-12;

/// The difference, rad, after three steps that are at least half as long as the longest accepted
/// ones.
const FIXED_64_AND_DOUBLE: f64 = 1e-9;

const TRIALS: u32 = 3000;

/// The documented accuracy, and cases that no other test covers: the largest error of an angle,
/// rad, must be at most the last number of each row.
#[test]
fn fixed_point_is_as_accurate_as_documented() -> Result<(), Error> {
    // A short, light rod 2 that rotates fast. Each of a quarter of a million stages per second adds
    // a small rounding error.
    let parameters = Parameters {
        m1: 1.0,
        m2: 0.0087,
        l1: 1.0,
        l2: 0.0825,
        g: 9.81,
    };

    let whirling = Trial {
        parameters,
        ..Trial::at_rest(1.0, 1.94, 1.94, 8.0)
    };
    // A similar pendulum, so fast that gravity is weak in comparison and has few digits.
    let parameters = Parameters {
        m1: 1.0,
        m2: 0.0510598,
        l1: 1.0,
        l2: 0.116394,
        g: GRAVITY,
    };

    let motion = Motion {
        a1: -2.7479,
        a2: 2.3154,
        w1: -11.11,
        w2: 55.97,
    };

    let quick = Trial {
        parameters,
        start: Pendulum::new(&parameters)?.to_state(&motion),
        seconds: 13.9,
    };

    let light = Trial::at_rest(128.0, 0.5, 0.5, 2.0);
    let page = Trial::at_rest(
        1.0,
        120_f64.to_radians(),
        120_f64.to_radians(),
        1024.0 / 60.0,
    );

    for (trial, method, steps, most) in [
        // The truncation error is 1.2e-8 (measured: the same).
        (Trial::regular(10.0), Method::Rk4Fixed32, 256.0, 2e-8),
        // The truncation error is 2.9e-6 (measured: 2.5e-6).
        (Trial::chaotic(5.0), Method::Rk4Fixed32, 240.0, 3e-6),
        (
            Trial::regular(10.0),
            Method::Rk4Fixed32,
            1024.0,
            FIXED_32_FLOOR,
        ),
        (
            Trial::regular(10.0),
            Method::Rk4Fixed32,
            4096.0,
            FIXED_32_FLOOR,
        ),
        // All rods and masses are different, so that some bits are unused (measured: 2.3e-8).
        (Trial::unlike(10.0), Method::Rk4Fixed32, 1024.0, 5e-8),
        // The error is twice that of compensated `f32`.
        (light, Method::Rk4Fixed32, 4096.0, 4e-7),
        // With 32 steps per frame the goal is a hundredth of half a pixel on a display of 64 pixels
        // (measured: 8.6e-5 for rod 2, as in `f64`).
        (quick, Method::Rk4Fixed32, 32.0 * 60.0, 1.5e-4),
        // The error is that of `f64` (measured: 3e-13).
        (
            Trial::regular(12.0),
            Method::Extrapolation12Fixed64,
            12.0,
            1e-12,
        ),
        // The goal after 17 s (measured: 2.2e-5). The error is due to rounding errors that have
        // grown by 3e10.
        (page, Method::Extrapolation12Fixed64, 60.0, 4e-5),
        // Three times the measured error of 1.9e-8. With biased rounding the error would be 3e-7.
        (whirling, Method::Extrapolation10Fixed64, 7680.0, 6e-8),
    ] {
        let error = trial.error(method, 1.0 / steps)?;
        println!("{method}, {steps} steps a second: {error:e} rad");
        assert!(
            error <= most,
            "{method}, {steps} steps a second: {error:e} rad for {trial:?}"
        );
    }

    let refused = light.states(Method::Rk4Fixed32, 1.0 / 512.0);
    assert!(
        matches!(
            refused,
            Err(Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            })
        ),
        "{refused:?}"
    );

    let trial = Trial::unlike(10.0);
    let start = Pendulum::new(&trial.parameters)?
        .run::<Fixed32>(&trial.start, 1.0 / 1024.0)?
        .state();
    for (reported, given) in [(start.p1, trial.start.p1), (start.p2, trial.start.p2)] {
        assert!(
            (reported - given).abs() <= FIXED_32_FLOOR,
            "{reported} for {given} kg m^2/s"
        );
    }

    Ok(())
}

/// Where both errors are small, that of the roundings counts, 1e-12 rad.
#[test]
fn chaotic_motion_is_as_accurate_as_in_f64() -> Result<(), Error> {
    let trial = Trial::chaotic(5.0);
    let exact = trial.exact()?;
    for steps in [32.0, 48.0, 64.0, 80.0, 128.0, 256.0, 512.0] {
        let error = |method| {
            Ok(largest_difference(
                &trial.states(method, 1.0 / steps)?,
                &exact,
            ))
        };

        let [double, fixed] = [
            error(Method::Extrapolation12F64)?,
            error(Method::Extrapolation12Fixed64)?,
        ];
        let budget = FIXED_64_AGAINST_DOUBLE * double.max(0.5 * FIXED_64_FLOOR);
        assert!(
            fixed <= budget,
            "{fixed:e} against {double:e} rad with {steps} steps a second"
        );
    }

    Ok(())
}

/// The steps are so fine that only rounding errors remain. The errors are geometric means over four
/// neighbouring starts.
#[test]
fn fixed32_rounds_no_worse_than_compensated_f32() -> Result<(), Error> {
    let parameters = |l1, l2| Parameters {
        m1: 0.75,
        m2: 1.25,
        l1,
        l2,
        g: 9.8125,
    };

    let rods = |l1, l2| Trial {
        parameters: parameters(l1, l2),
        ..Trial::at_rest(1.0, 0.3, -0.2, 5.0)
    };
    let moving = Trial {
        start: State {
            a1: 0.5,
            a2: -0.5,
            p1: 2.0,
            p2: 1.0,
        },
        ..Trial::regular(5.0)
    };

    let ratios = [1.0, 0.0078125, 0.1, 0.125, 8.0, 10.0, 32.0]
        .map(|ratio| Trial::at_rest(ratio, 0.5, 0.5, 5.0));
    let unlike = [rods(0.625, 1.125), rods(0.125, 1.125), rods(1.125, 0.125)];

    for trial in ratios.into_iter().chain([moving]).chain(unlike) {
        let typical = |method| {
            let near = (0..4).map(|i| trial.start.a1 + 1e-3 * f64::from(i));
            let near = near.map(|a1| Trial {
                start: State { a1, ..trial.start },
                ..trial
            });
            near.map(|trial| Ok(trial.error(method, 1.0 / 4096.0)?.ln() / 4.0))
                .sum::<Result<f64, Error>>()
        };

        let [fixed, single] = [
            typical(Method::Rk4Fixed32)?.exp(),
            typical(Method::Rk4F32Direction)?.exp(),
        ];
        assert!(
            fixed <= single,
            "{fixed:e} against {single:e} rad for {trial:?}"
        );
    }

    Ok(())
}

/// If halved steps show an order above 3.7 in `f64`, they must show at least 3.5 in 32 bits, above
/// the rounding errors.
#[test]
fn fixed32_is_of_order_four_at_any_speed() -> Result<(), Error> {
    const MOTIONS: u32 = 200;
    let mut rng = fastrand::Rng::with_seed(3);
    let mut measured = 0;
    for _ in 0..MOTIONS {
        let [m2, l2] =
            [(0.01, 300.0), (0.1, 10.0)].map(|(low, high)| log_uniform(&mut rng, low, high));
        let parameters = Parameters {
            m1: 1.0,
            m2,
            l1: 1.0,
            l2,
            g: GRAVITY,
        };

        let speed = log_uniform(&mut rng, 1.0, 60.0);
        let [a1, a2, w1, w2] = [PI, PI, speed, speed].map(|most| most * symmetric(&mut rng));
        let pendulum = Pendulum::new(&parameters)?;
        let start = pendulum.to_state(&Motion { a1, a2, w1, w2 });
        let dt = 0.98 * longest_step::<Fixed32>(&pendulum, &start);
        let trial = Trial {
            parameters,
            start,
            seconds: 512.0 * dt,
        };

        // This is far more accurate than the measured errors, at a tenth of the cost of the
        // reference.
        let exact = trial.states(Method::Extrapolation16F64, 0.5 * dt)?;
        let errors = |states: &dyn Fn(f64) -> Result<Vec<State<f64>>, Error>| {
            let error = |halvings| {
                Ok(largest_difference(
                    &states(dt * 0.5_f64.powi(halvings))?,
                    &exact,
                ))
            };
            (0..6).map(error).collect::<Result<Vec<f64>, Error>>()
        };

        let fixed = errors(&|dt| trial.states(Method::Rk4Fixed32, dt))?;
        let double = errors(&|dt| trial.states_in_f64(dt, MOMENTS))?;
        let floor = FIXED_32_ORDER_MEASURABLE.max(16.0 * fixed[4].max(fixed[5]));
        let order = |[coarse, fine]: [f64; 2]| (coarse / fine).log2();
        for i in 0..3 {
            let [fixed, double] = [&fixed, &double].map(|errors| [errors[i], errors[i + 1]]);
            if fixed[0] < 0.1 && fixed[1] > floor && order(double) > 3.7 {
                measured += 1;
                assert!(
                    order(fixed) >= 3.5,
                    "{fixed:?} rad, {double:?} in f64: {trial:?}"
                );
            }
        }
    }

    // Measured: 67. If the unit of time is wrong, 51 are above the floor, and two of these are
    // below order 2.
    assert!(measured >= 60, "{measured} orders");
    Ok(())
}

fn longest_step<F: Form>(pendulum: &Pendulum<f64>, start: &State<f64>) -> f64 {
    match pendulum.run::<F>(start, 1e3).map(drop) {
        Err(Error::TooLarge { limit, .. }) => limit,
        other => panic!("{other:?}"),
    }
}

#[test]
fn inputs_out_of_range_are_refused_by_name() -> Result<(), Error> {
    let good = Parameters::equal_rods(1.0, 1.0, 9.81);
    let start = State::at_rest(2.0, 2.0);
    fn refusal<F: Form>(
        parameters: &Parameters<f64>,
        start: &State<f64>,
        dt: f64,
    ) -> Option<Error> {
        Pendulum::new(parameters).ok()?.run::<F>(start, dt).err()
    }

    for refuse in [refusal::<Fixed32>, refusal::<Fixed64<12>>] {
        assert_eq!(refuse(&good, &start, 1.0 / 64.0), None);
        for dt in [0.5, -0.5, 1e300] {
            let refused = refuse(&good, &start, dt);
            assert!(
                matches!(
                    refused,
                    Some(Error::TooLarge {
                        parameter: Parameter::Dt,
                        ..
                    })
                ),
                "{refused:?}"
            );
        }

        for (parameters, parameter, value) in [
            (Parameters { m2: 1e5, ..good }, Parameter::M2, 1e5),
            (Parameters { m2: 1e-5, ..good }, Parameter::M2, 1e-5),
            (Parameters { l2: 1e5, ..good }, Parameter::L2, 1e5),
        ] {
            assert_eq!(
                refuse(&parameters, &start, 1e-9),
                Some(Error::OutOfRange { parameter, value })
            );
        }

        let refused = refuse(&good, &State { p1: 1e300, ..start }, 1e-3);
        assert!(refused.is_some(), "an energy beyond all bounds");
        let Some(Error::TooLarge { limit, .. }) = refuse(&good, &start, 1.0) else {
            panic!("a step of 1 s")
        };
        assert_eq!(
            refuse(&good, &start, 0.999 * limit),
            None,
            "the limit it names is accepted"
        );

        let heavy = Parameters {
            m1: 1024.0,
            m2: 1024.0,
            ..good
        };

        let heavy = refuse(&heavy, &start, 1.0);
        assert_eq!(
            heavy,
            refuse(&good, &start, 1.0),
            "only the ratio of the masses counts"
        );
    }

    let light = |places| Parameters {
        m2: 0.5_f64.powi(places),
        ..good
    };
    let refused = refusal::<Fixed64<12>>(&light(13), &start, 1e-4);
    assert!(
        matches!(refused, Some(Error::OutOfRange { .. })),
        "{refused:?}"
    );
    assert_eq!(
        refusal::<Fixed64<12>>(&light(12), &start, 1e-4),
        None,
        "the lightest bob 2"
    );

    Ok(())
}

/// The stages overshoot in many ways. A part of the motions diverges, so that the test is near the
/// limit. All others agree after three steps with the same method in `f64`, whose range is not
/// limited.
#[test]
fn fixed64_motion_is_accurate_or_reported_as_diverged() -> Result<(), Error> {
    fn compared<const ORDER: u32>(rng: &mut fastrand::Rng) -> Result<Option<f64>, Error> {
        let parameters = random::parameters(rng);
        let start = random::state(rng, &parameters);
        let pendulum = Pendulum::new(&parameters)?;
        let dt = longest_step::<Fixed64<ORDER>>(&pendulum, &start) * (0.5 + 0.5 * rng.f64());
        let mut fixed = pendulum.run::<Fixed64<ORDER>>(&start, dt)?.counting_turns();
        let mut double = pendulum
            .run::<ExtrapolationF64<ORDER>>(&start, dt)?
            .counting_turns();
        let is_right = fixed.advance(3).is_ok();
        let is_right_in_f64 = double.advance(3);
        if is_right {
            is_right_in_f64?;
        }
        Ok(is_right.then(|| largest_difference(&[fixed.state()], &[double.state()])))
    }

    let mut rng = fastrand::Rng::with_seed(14);
    let mut diverged = 0;
    for _ in 0..TRIALS {
        for difference in [
            compared::<4>(&mut rng)?,
            compared::<10>(&mut rng)?,
            compared::<16>(&mut rng)?,
        ] {
            match difference {
                Some(difference) => assert!(difference <= FIXED_64_AND_DOUBLE, "{difference:e}"),
                None => diverged += 1,
            }
        }
    }

    println!("{diverged} of {} diverged", 3 * TRIALS);
    assert!(
        (TRIALS / 30..3 * TRIALS / 2).contains(&diverged),
        "{diverged} diverged: the search must be near the limit"
    );
    Ok(())
}

#[test]
fn motion_of_less_energy_runs_in_the_same_units() -> Result<(), Error> {
    fn states<F: Form>(
        parameters: &Parameters<f64>,
        highest: &State<f64>,
        low: &State<f64>,
        dt: f64,
    ) -> Result<[State<f64>; 2], Error> {
        let highest = F::new(parameters, highest, dt)?;
        let motions = [highest.started(low)?, F::new(parameters, low, dt)?];
        Ok(motions.map(|mut motion| {
            motion.advance(256);
            motion.state()
        }))
    }

    let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
    let dt = 1.0 / 256.0;
    let low = State {
        a1: 1.0,
        a2: 0.5,
        p1: 0.3,
        p2: -0.2,
    };

    let highest = State::at_rest(PI, PI);
    let [lower, own] = states::<Fixed64<10>>(&parameters, &highest, &low, dt)?;
    let error = largest_difference(&[lower], &[own]);
    assert!(error <= FIXED_64_FLOOR, "{error:e} rad");
    Ok(())
}
