//! Motions that are known without a computation: upright, straight, at rest, tiny, and at the edge
//! of stability.

use std::f64::consts::{PI, TAU};

use double_pendulum::{
    Equations, Error, Integrator, Method, Modes, Motion, Numbers, Parameters, Pendulum, State,
    radians,
};
use exact::taylor::Reference;
use exact::tolerances;
use exact::trials::{exact_methods, run};

use super::hard_cases::HALVINGS;

/// The tolerance, s: one sampling interval, 1/64 s, and RK4's error of the growth rate in steps of
/// 2^-6 s.
const FALL: f64 = 1.5 / 64.0;

/// Relative. The fall begins at a whole step, and the angular velocity is rounded.
const STAYS: f64 = 0.05;

/// The largest angle, rad, of a swing from 1e-5 rad in steps 101 to 200: below the first in steps 2
/// % below the limit of stability, above the second in steps 2 % above it (measured: to 6e-12 at
/// most, to 7e-4 at least).
const STABILITY_EDGE: [f64; 2] = [1e-6, 1e-4];

/// 64-bit fixed point rounds each of 10,000 steps (measured 2.6e-13).
const REST_OF_FIXED_64: f64 = 1e-12;

/// Straight rods that turn for 20 s. In f32 the error comes from some 5000 steps of plain sums,
/// each rounded. In f64 it is the direction form's own error, 6e-11 rad a second at 2 rad/s.
const STRAIGHT: tolerances::PerPrecision = tolerances::PerPrecision {
    single: 1e-3,
    double: 2e-9,
};

/// Relative to the amplitude: the roundings of 2560 plain sums. RK4's own error is 1e-9.
const TINY: tolerances::PerPrecision = tolerances::PerPrecision {
    single: 1e-3,
    double: 1e-8,
};

fn even(gravity: f64) -> Parameters<f64> {
    Parameters::equal_rods(1.0, 1.0, gravity)
}

/// Returns the first time when rod 1 is a radian away from its start, s.
fn fall(mut angle: impl FnMut() -> f64) -> f64 {
    let start = angle();
    let looks = (1..=16 * 64).find(|_| (angle() - start).abs() > 1.0);
    looks.map_or(f64::INFINITY, |looks| f64::from(looks) / 64.0)
}

/// A sum of angles loses small increments by rounding, which the next test covers. In fixed point a
/// sine has too few digits.
#[test]
fn upright_pendulum_falls_with_the_exact_motion_in_direction_form() -> Result<(), Error> {
    let is_meant =
        |method: &&Method| method.equations() == Equations::Directions && !method.is_fixed_point();
    for &method in Method::ALL.iter().filter(is_meant) {
        let single = f64::from(std::f32::consts::PI);
        let up = if method.is_single() {
            single
        } else {
            PI.next_up()
        };
        let parameters = even(9.81_f64 as f32 as f64);
        let mut reference = Reference::new(&parameters, &Motion::at_rest(up, up));
        let mut time = 0.0;
        let exact = fall(|| {
            reference.advance_to(time);
            time += 1.0 / 64.0;
            reference.motion().a1
        });

        assert!(exact.is_finite());
        for halvings in HALVINGS.skip(2) {
            let mut motion = run(
                method,
                &parameters,
                &State::at_rest(up, up),
                0.5_f64.powi(halvings),
            )?;

            let mut steps = 0;
            let falls = fall(|| {
                motion.advance(steps).expect("a finite motion");
                steps = 1 << (halvings - 6);
                motion.angles()[0].rem_euclid(TAU)
            });

            let error = (falls - exact).abs();
            assert!(
                error <= FALL,
                "{method}, 2^-{halvings} s: after {falls} s instead of {exact} s"
            );
        }
    }

    Ok(())
}

/// The momentum grows by the torque, but the angle stays constant until an increment reaches half a
/// unit of its last place, for (ulp/2)/(g error dt), where the error is that of pi.
#[test]
fn upright_pendulum_stays_for_the_predicted_time_in_plain_sums() -> Result<(), Error> {
    let single = f64::from(std::f32::consts::PI);
    for (method, up, ulp, error) in [
        (
            Method::Rk4F32,
            single,
            2.0 * f64::from(f32::EPSILON),
            single - PI,
        ),
        (
            Method::Rk4F64,
            PI.next_up(),
            2.0 * f64::EPSILON,
            2.0 * f64::EPSILON - 1.224_646_799_147_353_2e-16,
        ),
    ] {
        for steps_per_second in [64_u32, 256] {
            let dt = 1.0 / f64::from(steps_per_second);
            let stays = 0.5 * ulp / (9.81 * error * dt);
            let mut motion = run(method, &even(9.81), &State::at_rest(up, up), dt)?;
            let mut steps = 0_u32;
            while motion.state().a1 == up && steps < 100 * steps_per_second {
                motion.advance(1)?;
                steps += 1;
            }
            let stayed = f64::from(steps) * dt;
            assert!(
                (stayed / stays - 1.0).abs() <= STAYS,
                "{method}: {stayed} s instead of {stays} s"
            );
        }
    }

    Ok(())
}

/// a = a(0) + w t, with whole turns.
#[test]
fn straight_rods_turn_uniformly_without_gravity() -> Result<(), Error> {
    let parameters = Parameters {
        l2: 0.5,
        ..even(0.0)
    };
    let start = Pendulum::new(&parameters)?.to_state(&Motion {
        a1: 1.0,
        a2: 1.0,
        w1: 2.0,
        w2: 2.0,
    });

    for method in exact_methods() {
        let mut motion = run(method, &parameters, &start, 1.0 / 256.0)?;
        for seconds in 1..=20 {
            motion.advance(256)?;
            let State { a1, a2, p1, p2 } = motion.state();
            let [miss1, miss2] =
                [a1, a2].map(|angle| (angle - 1.0 - 2.0 * f64::from(seconds)).abs());
            let lost = ((p1 + p2) / (start.p1 + start.p2) - 1.0).abs();
            let worst = miss1.max(miss2).max(lost);
            assert!(
                worst <= STRAIGHT.by(method),
                "{method}: {worst:e} rad or relative after {seconds} s"
            );
        }
    }

    Ok(())
}

#[test]
fn pendulum_at_rest_stays_at_rest() -> Result<(), Error> {
    for &method in Method::ALL {
        for (gravity, a1, a2) in [(9.81, 0.0, 0.0), (0.0, 3.0, -2.0)] {
            if gravity == 0.0 && method.equations() == Equations::Linear {
                continue; // There are no normal modes.
            }
            let mut motion = run(method, &even(gravity), &State::at_rest(a1, a2), 1.0 / 64.0)?;
            let start = motion.state();
            motion.advance(10_000)?;
            let now = motion.state();
            let moved = (now.a1 - start.a1).abs().max((now.a2 - start.a2).abs());
            let [angle, momentum] = match method.numbers() {
                Numbers::Fixed64 => [REST_OF_FIXED_64; 2],
                _ if method.is_single() => [f32::EPSILON.into(), 0.0],
                _ => [f64::EPSILON, 0.0],
            };

            let pushed = now.p1.abs().max(now.p2.abs());
            assert!(
                moved <= angle && pushed <= momentum,
                "{method}: {now:?} from {start:?}"
            );
        }
    }

    Ok(())
}

/// An oscillation whose squares all underflow is the linear one. In subnormal numbers it must not
/// grow much.
#[test]
fn tiny_oscillations_are_linear_and_subnormal_ones_stay_small() -> Result<(), Error> {
    let parameters = even(9.81);
    let slow = Modes::new(&parameters)?.slow;
    for method in exact_methods().filter(|method| !method.is_fixed_point()) {
        // Far above the smallest normal number, and a few units of the smallest subnormal number.
        let [tiny, subnormal] = if method.is_single() {
            [-80, -146]
        } else {
            [-900, -1071]
        }
        .map(|n| 2_f64.powi(n));

        let mut motion = run(
            method,
            &parameters,
            &State::at_rest(tiny, tiny * slow.shape),
            1.0 / 256.0,
        )?;

        for step in 1..=10 * 64 {
            motion.advance(4)?;
            let expected = (slow.frequency * f64::from(step) / 64.0).cos();
            let miss = (motion.state().a1 / tiny - expected).abs();
            assert!(miss <= TINY.by(method), "{method}: {miss:e} at step {step}");
        }

        let mut motion = run(
            method,
            &parameters,
            &State::at_rest(subnormal, subnormal),
            1.0 / 256.0,
        )?;
        motion.advance(10_000)?;
        let State { a1, a2, .. } = motion.state();
        let most = 1000.0 * subnormal;
        assert!(
            a1.abs() <= most && a2.abs() <= most,
            "{method}: {a1:e}, {a2:e} from {subnormal:e}"
        );
    }

    Ok(())
}

/// Beyond the limit of RK4 the amplitude grows by 15 % per step, until it changes the frequency,
/// which may be at less than 0.001 rad.
#[test]
fn fast_mode_decays_below_the_step_limit_and_grows_above() -> Result<(), Error> {
    const SMALL: f64 = 1e-5;
    let is_meant =
        |method: &Method| method.integrator() == Integrator::Rk4 && !method.is_fixed_point();
    for parameters in [
        even(9.81),
        Parameters {
            m2: 1000.0,
            ..even(9.81)
        },
        Parameters {
            l2: 0.01,
            ..even(9.81)
        },
    ] {
        let modes = Modes::new(&parameters)?;
        assert_eq!(modes.check_step(modes.step_limit()), Ok(()));
        assert!(
            [1.01 * modes.step_limit(), 0.0, f64::NAN]
                .iter()
                .all(|dt| modes.check_step(*dt).is_err())
        );

        let shape = modes.fast.shape;
        let start = if shape.abs() > 1.0 {
            State::at_rest(SMALL / shape, SMALL)
        } else {
            State::at_rest(SMALL, SMALL * shape)
        };

        let [decayed, grown] = STABILITY_EDGE;
        for method in exact_methods().filter(is_meant) {
            let mut motion = run(method, &parameters, &start, 0.98 * modes.step_limit())?;
            motion.advance(100)?;
            let below = (100..200).try_fold(0.0, |late, _| {
                motion.advance(1)?;
                Ok::<_, Error>(largest_angle(&motion.state()).max(late))
            })?;
            assert!(below < decayed, "{method}: {below:e} below the limit");

            let refused = run(method, &parameters, &start, 1.02 * modes.step_limit());
            assert!(
                matches!(refused, Err(Error::TooLarge { .. })),
                "{method}: {refused:?} above the limit"
            );
        }

        // Runs accept no step above the limit. `Pendulum::step` does.
        let pendulum = Pendulum::new(&parameters)?;
        let mut state = start;
        let mut above: f64 = 0.0;
        for steps in 1..=200 {
            state = pendulum.step(&state, 1.02 * modes.step_limit());
            if steps > 100 {
                above = largest_angle(&state).max(above);
            }
        }

        assert!(above > grown, "{above:e} above the limit");
    }

    Ok(())
}

fn largest_angle(state: &State<f64>) -> f64 {
    state.a1.abs().max(state.a2.abs())
}

/// The pendulum falls from the nearest `f32` to pi, the angle of `rk4-f32`.
#[test]
fn pendulum_that_stands_upright_never_falls() -> Result<(), Error> {
    let start = State::at_rest(radians(180.0), radians(-180.0));
    for &method in Method::ALL {
        if method.equations() == Equations::Linear
            || method.is_single() && method.equations() != Equations::Directions
        {
            continue;
        }
        let mut motion = run(method, &even(9.81), &start, 1.0 / 256.0)?;
        motion.advance(256 * 60)?;
        let State { a1, a2, p1, p2 } = motion.state();
        assert_eq!(
            ([a1.abs(), a2.abs()], [p1, p2]),
            ([PI; 2], [0.0; 2]),
            "{method}"
        );
    }

    let pendulum = Pendulum::new(&even(9.81))?;
    assert!(pendulum.rests(&start) && pendulum.rests(&State::default()));
    assert!(!pendulum.rests(&State::at_rest(PI.next_up(), PI)));
    Ok(())
}
