//! The fast forms: their accuracy, their directions and their count of turns.

use std::f64::consts::TAU;

use double_pendulum::parts::Turns;
use double_pendulum::{
    DirectionF32, Error, Method, Motion, Numbers, Parameter, Parameters, Pendulum, Run, State,
};
use exact::trials::{self, Trial, exact_methods, largest_difference};
use exact::{random, tolerances};
use fastrand::Rng;

/// The largest relative excess of a step over dt, in epsilons of the method's numbers, or of `f32`
/// in fixed point. The unit of time may be rounded by half of the rounding of gravity.
const LONGER: f64 = 17.0;

/// The difference of the directions, across them, from the sines and cosines of the angles of the
/// same motion, in epsilons of the method's numbers, or of `f32` in fixed point: roundings of the
/// sines and of the lengths. The turn of a rod in the excess of all steps ([`LONGER`]) is allowed
/// in addition.
const DIRECTIONS: f64 = 8.0;

/// The difference of the lengths of directions from 1, by each of the
/// [`exact_methods`](exact::trials::exact_methods), in 70 steps of 1/64 s of the chaotic
/// scene and of [`Trial::unlike`](exact::trials::Trial::unlike): the remainder after
/// restoring them to first order (measured 3e-6).
const LENGTHS: f64 = 1e-5;

/// The smallest ratio of the errors of the plain and the compensated direction form in `f32` in the
/// regular scene in 10 s, in steps of 1/256 and 1/1024 s (measured: 30 to 70).
const COMPENSATION_GAIN: f64 = 10.0;

/// The error of the angles, rad, after a second of 1024 steps forward and as many back in 32 bits.
/// The first value is for compensated `f32` and fixed point (measured 8e-8), the second for plain
/// `f32`, whose roundings are dropped (measured 1.8e-6).
const RETURN_OF_32_BITS: [f64; 2] = [1e-7, 4e-6];

/// The exact motion is computed by order 16 in `f64`. Its error is 1e-12 rad here, and it takes a
/// thousandth of the reference's time.
fn typical_error(seconds: f64, dt: f64) -> Result<f64, Error> {
    const STARTS: u32 = 32;
    let mut squares = 0.0;
    for i in 0..STARTS {
        let on = f64::from(i) * 6e-5;
        let trial = Trial::at_rest(1.0, 0.5 + on, 0.5 - 0.5 * on, seconds);
        let exact = trial
            .held_by(Method::Rk4F32Direction)
            .states(Method::Extrapolation16F64, 1.0 / 16.0)?;
        squares += largest_difference(&trial.states(Method::Rk4F32Direction, dt)?, &exact).powi(2);
    }

    Ok((squares / f64::from(STARTS)).sqrt())
}

/// The errors are the truncation error and the rounding errors of the evaluations, 6e-8 each. A
/// single error may be three times smaller or larger than the typical one over 32 neighbouring
/// starts.
#[test]
fn compensated_single_precision_keeps_its_budgets() -> Result<(), Error> {
    for (seconds, steps, goal, typical) in [
        // The truncation error is 1.1e-8 (measured: 4.0e-8, typically 4.3e-8). Plain sums have a
        // far larger error.
        (10.0, 256.0, 5e-8, 5e-8),
        // The truncation error is 1.0e-7 (measured: 2.5e-7, typically 4.0e-7).
        (100.0, 256.0, 2.5e-7, 4.5e-7),
        // The error is (256/240)^4 times that with 256 steps. Measured over 192 starts: 1.32 times
        // 4.2e-8; 1.20 to 1.42 times over 32 of them. A step that is 1/240 s rounded to `f32` would
        // be 3e-7 s too long in 10 s, and the error 30 times as large. This start has 6.9e-8.
        (10.0, 240.0, 8e-8, 6.5e-8),
    ] {
        let error = Trial::regular(seconds).error(Method::Rk4F32Direction, 1.0 / steps)?;
        let typically = typical_error(seconds, 1.0 / steps)?;
        println!("{seconds} s, {steps} steps a second: {error:.2e}, typically {typically:.2e}");
        assert!(
            error <= goal && typically <= typical,
            "{seconds} s, {steps} steps a second: {error:e} {typically:e}"
        );
    }

    Ok(())
}

#[test]
fn compensation_reduces_the_error_by_its_gain() -> Result<(), Error> {
    for dt in [1.0 / 256.0, 1.0 / 1024.0] {
        let error = |method| Trial::regular(10.0).error(method, dt);
        let gain = error(Method::Rk4F32DirectionPlain)? / error(Method::Rk4F32Direction)?;
        assert!(gain >= COMPENSATION_GAIN, "{gain}");
    }

    Ok(())
}

#[test]
fn backward_steps_return_to_the_start_and_single_steps_are_bit_identical() -> Result<(), Error> {
    let parameters = Parameters {
        l2: 0.4,
        ..Parameters::equal_rods(3.0, 1.0, 9.81)
    };
    let start = State {
        a1: 0.5,
        a2: 1.0,
        p1: 0.1,
        p2: 0.2,
    };

    let [carried, plain] = RETURN_OF_32_BITS;
    for &method in Method::ALL {
        let mut forth = trials::run(method, &parameters, &start, 1.0 / 1024.0)?;
        forth.advance(1024)?;
        let mut each = trials::run(method, &parameters, &start, 1.0 / 1024.0)?;
        (0..1024).try_for_each(|_| each.advance(1))?;
        assert_eq!(
            (forth.state(), forth.directions()),
            (each.state(), each.directions()),
            "{method}"
        );

        let mut back = trials::run(method, &parameters, &forth.state(), -1.0 / 1024.0)?;
        back.advance(1024)?;
        let budget = match method.numbers() {
            Numbers::F32 => plain,
            Numbers::CompensatedF32 | Numbers::Fixed32 => carried,
            Numbers::F64 | Numbers::CompensatedF64 | Numbers::Fixed64 => tolerances::RETURN,
        };

        let difference = largest_difference(&[back.state()], &[start]);
        assert!(difference <= budget, "{method}: {difference:e}");
    }

    Ok(())
}

/// The directions may be ahead of the state by the error of a rounded step. The closed form is
/// excluded, because its directions are the first terms of a series.
#[test]
fn directions_are_those_of_the_angles() -> Result<(), Error> {
    /// The largest rate of a rod in these motions, rad/s.
    const FASTEST: f64 = 10.0;
    let both = |method| [Trial::chaotic(1.0), Trial::unlike(1.0)].map(|trial| (method, trial));
    for (method, trial) in exact_methods().flat_map(both) {
        let mut motion = trials::run(method, &trial.parameters, &trial.start, 1.0 / 64.0)?;
        let is_double = matches!(method.numbers(), Numbers::F64 | Numbers::CompensatedF64);
        let epsilon = if is_double {
            f64::EPSILON
        } else {
            f32::EPSILON.into()
        };

        for sample in 1..=10 {
            motion.advance(7)?;
            // The directions are ahead of the state, because the steps are longer than dt.
            let ahead = LONGER * epsilon * f64::from(sample * 7) / 64.0;
            let budget = DIRECTIONS * epsilon + FASTEST * ahead;
            for ([sine, cosine], angle) in
                motion.directions().into_iter().zip(motion.state().angles())
            {
                let (s, c) = angle.sin_cos();
                let [along, across] = [sine * s + cosine * c, sine * c - cosine * s];
                assert!(across.abs() <= budget, "{method}: {across:e} at {angle}");
                assert!(
                    (along - 1.0).abs() <= LENGTHS,
                    "{method}: {along} long at {angle}"
                );
            }
        }
    }

    Ok(())
}

#[test]
fn turns_follow_the_angular_velocity() -> Result<(), Error> {
    let Trial {
        parameters, start, ..
    } = Trial::at_rest(2.75, 3.0, 3.0, 1.0);
    let pendulum = Pendulum::new(&parameters)?;
    let dt = 1.0 / 2048.0;
    let velocities = |state: &State<f64>| {
        let Motion { w1, w2, .. } = pendulum.to_motion(state);
        [w1, w2]
    };
    for method in exact_methods() {
        let mut motion = trials::run(method, &parameters, &start, dt)?;
        let mut angles = start.angles();
        let mut before = velocities(&start);
        let mut most = 0.0_f64;
        for _ in 0..10 * 2048 {
            motion.advance(1)?;
            let now = velocities(&motion.state());
            for (i, reported) in motion.angles().into_iter().enumerate() {
                angles[i] += 0.5 * dt * (before[i] + now[i]);
                assert!(
                    (reported - angles[i]).abs() < 0.1,
                    "{method}: {reported}, {angles:?}"
                );
                most = most.max(reported.abs());
            }
            before = now;
        }

        assert!(
            most > 2.0 * TAU,
            "{method}: it never turned over twice: {most}"
        );
    }

    Ok(())
}

#[test]
fn turns_follow_an_angle_in_either_direction() {
    let mut rng = Rng::with_seed(7);
    let mut angle = 1.0_f64;
    let signs = |angle: f64| [[angle.sin(), angle.cos()].map(|part| -i32::from(part < 0.0)); 2];
    assert!(matches!(
        Turns::of([0.0, 1.4e10], signs(angle)),
        Err(Error::OutOfRange {
            parameter: Parameter::A2,
            ..
        })
    ));

    for start in (-100..=100).map(|i| 0.37 * f64::from(i)) {
        let [turns, _] = Turns::of([start; 2], signs(start)).expect("few turns");
        assert!(
            (turns.angle([start.sin(), start.cos()]) - start).abs() < 1e-9,
            "{start}"
        );
    }

    let mut turns = Turns::of([angle; 2], signs(angle)).expect("few turns");
    let mut farthest = 0.0_f64;
    for _ in 0..100_000 {
        angle += 1.5 * random::symmetric(&mut rng);
        Turns::observe(&mut turns, signs(angle));
        let unwrapped = Turns::unwrap(
            &turns,
            State::at_rest(angle.rem_euclid(TAU), angle - 7.0 * TAU),
        );
        let known = [
            turns[0].angle([angle.sin(), angle.cos()]),
            unwrapped.a1,
            unwrapped.a2,
        ];

        assert!(
            known.iter().all(|known| (known - angle).abs() < 1e-9),
            "{known:?} for {angle}"
        );
        farthest = farthest.max(angle.abs());
    }

    assert!(farthest > 10.0 * TAU, "{farthest}");
}

const _: () = assert!(size_of::<Run<DirectionF32>>() <= 256, "a run is small");

#[test]
fn bad_input_is_refused_by_name() -> Result<(), Error> {
    let good = Parameters {
        m1: 1.0,
        m2: 1.0,
        l1: 1.0,
        l2: 1.0,
        g: 9.81,
    };

    let still = State::at_rest(1.0, 1.0);
    for &method in Method::ALL {
        let refused = |parameters: &Parameters<f64>, start: &State<f64>, dt: f64| {
            trials::run(method, parameters, start, dt)
                .err()
                .unwrap_or_else(|| panic!("{method} takes it"))
        };

        for dt in [f64::NAN, f64::INFINITY] {
            assert!(matches!(
                refused(&good, &still, dt),
                Error::NotFinite {
                    parameter: Parameter::Dt,
                    ..
                }
            ));
        }

        for dt in [0.0, 1e-310] {
            assert!(matches!(
                refused(&good, &still, dt),
                Error::OutOfRange {
                    parameter: Parameter::Dt,
                    ..
                }
            ));
        }

        let nowhere = refused(&good, &State::at_rest(f64::NAN, 0.0), 0.01);
        assert!(
            matches!(
                nowhere,
                Error::NotFinite {
                    parameter: Parameter::A1,
                    ..
                }
            ),
            "{method}: {nowhere:?}"
        );

        let negative = refused(&Parameters { m2: -1.0, ..good }, &still, 0.01);
        assert!(matches!(
            negative,
            Error::NotPositive {
                parameter: Parameter::M2,
                ..
            }
        ));

        let extreme = refused(&Parameters { m1: 1e30, ..good }, &still, 0.01);
        assert!(
            matches!(
                extreme,
                Error::TooLarge {
                    parameter: Parameter::M1,
                    ..
                }
            ),
            "{method}: {extreme:?}"
        );
    }

    // A velocity whose energy is out of range in `f32`.
    let light = Pendulum::new(&Parameters {
        m2: 0.1,
        l2: 0.1,
        ..good
    })?;

    let light = light
        .run::<DirectionF32>(&State { p1: 3e38, ..still }, 0.01)
        .expect_err("refused");
    assert!(
        matches!(
            light,
            Error::OutOfRange {
                parameter: Parameter::P1,
                value: 2.9e38..3.1e38
            }
        ),
        "{light:?}"
    );

    Ok(())
}
