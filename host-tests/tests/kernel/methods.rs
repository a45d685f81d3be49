//! The order of each method: of all in the table that make steps, of the plain step, and of extrapolation of any equation.

use double_pendulum::{Error, Extrapolation, Integrator, Method, Motion, Parameter, Parameters, Pendulum};
use firmware::job::{JobError, Request};
use host_tests::oracle::tolerances;
use reference::taylor;

/// How long the motion is followed, s: rods of 1 m, equal bobs, let go at 0.5 rad.
const SECONDS: u32 = 2;

/// Two numbers of steps a second between which an order shows: above what roundings leave, and where no step is refused.
fn steps(method: Method) -> [u32; 2] {
    match method.order() {
        4 if method.is_fixed_point() => [32, 64],
        4 => [16, 32],
        16 => [5, 7],
        _ => [5, 10],
    }
}

/// How far an angle is off in the end, rad.
fn error(method: Method, steps_per_second: u32) -> Result<f64, JobError> {
    let (parameters, angles) = (Parameters::equal_rods(1.0, 1.0, 9.8125), [0.5; 2]);
    let (dt, stride) = (1.0 / f64::from(steps_per_second), SECONDS * steps_per_second);
    let request = Request { method, parameters, angles, velocities: [0.0; 2], dt, stride, samples: 1 };
    let mut end = [0.0; 4];
    request.readings(|reading| {
        end = reading.state;
        Ok::<_, JobError>(())
    })?;
    let exact = taylor::states(&parameters, &Motion::at_rest(0.5, 0.5), &[SECONDS.into()])[0];
    Ok((end[0] - exact.a1).abs().max((end[1] - exact.a2).abs()))
}

#[test]
fn every_method_is_of_its_order() -> Result<(), JobError> {
    // the sines of micromath are wrong by more than a step is
    let makes_steps =
        |method: &&Method| method.integrator() != Integrator::ClosedForm && **method != Method::Rk4F32Micromath;
    for &method in Method::ALL.iter().filter(makes_steps) {
        let [coarse, fine] = steps(method);
        let [coarse_error, fine_error] = [error(method, coarse)?, error(method, fine)?];
        let order = (coarse_error / fine_error).ln() / (f64::from(fine) / f64::from(coarse)).ln();
        println!("{method}: {order:.2} ({coarse_error:.1e}, {fine_error:.1e})");
        let apart = (order / f64::from(method.order()) - 1.0).abs();
        assert!(apart <= tolerances::ORDER_OF_METHODS, "{method}: order {order}");
    }
    Ok(())
}

/// The largest error of an angle in 20 s of a regular motion, in which errors grow no faster than the time; looked at every
/// second.
fn error_of_plain_steps(parameters: &Parameters<f64>, start: &Motion<f64>, steps_per_second: u32) -> f64 {
    let pendulum = Pendulum::new(parameters).expect("valid parameters");
    let exact = taylor::states(parameters, start, &std::array::from_fn::<f64, 20, _>(|second| second as f64 + 1.0));
    let mut state = pendulum.to_state(start);
    let off = exact.iter().map(|exact| {
        for _ in 0..steps_per_second {
            state = pendulum.step(&state, 1.0 / f64::from(steps_per_second));
        }
        (state.a1 - exact.a1).abs().max((state.a2 - exact.a2).abs())
    });
    off.fold(0.0, f64::max)
}

/// Masses and lengths alike and unlike; steps so fine that the next order is small, and so coarse that rounding is.
#[test]
fn the_plain_step_is_of_order_4() {
    let half = 30_f64.to_radians();
    for (parameters, start, steps) in [
        (Parameters::equal_rods(1.0, 1.0, 9.8), Motion::at_rest(half, half), 128),
        (
            Parameters { m1: 0.7, m2: 1.3, l1: 0.6, l2: 1.1, g: 9.81 },
            Motion { a1: 0.3, a2: -0.2, w1: 0.4, w2: -0.5 },
            1024,
        ),
        (
            Parameters { m1: 3.0, m2: 0.5, l1: 1.0, l2: 0.4, g: 1.62 },
            Motion { a1: -0.4, a2: 0.6, w1: 0.0, w2: 1.0 },
            256,
        ),
    ] {
        let errors = [1, 2, 4].map(|finer| error_of_plain_steps(&parameters, &start, finer * steps));
        for order in errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()) {
            assert!(tolerances::ORDER.contains(&order), "order {order} for {parameters:?}");
        }
    }
}

/// A swing z'' = -z followed for 20 s.
fn error_of_a_swing(order: u32, steps: u32) -> Result<f64, Error> {
    let method = Extrapolation::new(order)?;
    let dt = 20.0 / f64::from(steps);
    let [x, v] = (0..steps).fold([0.0, 1.0], |z, _| method.step(|&[x, v]: &[f64; 2]| [v, -x], &z, dt));
    Ok((x - 20.0_f64.sin()).abs().max((v - 20.0_f64.cos()).abs()))
}

/// At the finest steps whose error is clearly above the roundings.
#[test]
fn the_order_is_the_one_asked_for() -> Result<(), Error> {
    for order in [6, 8, 12, 16] {
        let mut steps = 4;
        while error_of_a_swing(order, 3 * steps)? > tolerances::ORDER_MEASURABLE {
            steps += 1 + steps / 8;
        }
        let [coarse, fine] = [error_of_a_swing(order, 2 * steps)?, error_of_a_swing(order, 3 * steps)?];
        let measured = (coarse / fine).ln() / 1.5_f64.ln();
        println!("order {order}: {measured:.2}, {steps} steps {coarse:.1e} {fine:.1e}");
        assert!(
            (measured - f64::from(order)).abs() <= tolerances::ORDER_EXTRAPOLATED,
            "order {measured} instead of {order}"
        );
    }
    Ok(())
}

#[test]
fn orders_that_there_are_not_are_refused() {
    for order in [0, 1, 7, 18, u32::MAX] {
        assert!(matches!(Extrapolation::<f64>::new(order), Err(Error::OutOfRange { parameter: Parameter::Order, .. })));
    }
}
