//! The orders of all methods with steps, and of extrapolation of any equation.

use double_pendulum::{Error, Extrapolation, Method, Parameter, Parameters, State};
use exact::trials::{Trial, exact_methods, largest_difference};

/// The error of the measured order of extrapolation of z'' = -z, in orders. The steps must be
/// coarse, so that high orders are above the roundings of a hundred steps, which they enlarge. The
/// next power of the step then contributes (measured 5.98, 7.91, 12.34, 15.25 for the orders 6, 8,
/// 12 and 16). The next order is 2 off.
const ORDER_EXTRAPOLATED: f64 = 0.8;

/// The relative error of a method's measured order. The first value is for every method: the next
/// order contributes at the steps used, and order 16 has the roundings (measured 3.73, 8.08, 10.04,
/// 11.75 and 15.0). The second value is for RK4 in `f64` in finer steps (measured 3.93 to 3.995).
const ORDER_OF_METHODS: [f64; 2] = [0.1, 0.025];

fn order(
    method: Method,
    trial: &Trial,
    exact: &[State<f64>],
    [coarse, fine]: [u32; 2],
) -> Result<f64, Error> {
    let error = |steps: u32| {
        Ok(largest_difference(
            &trial.states(method, 1.0 / f64::from(steps))?,
            exact,
        ))
    };

    Ok((error(coarse)? / error(fine)?).ln() / (f64::from(fine) / f64::from(coarse)).ln())
}

/// Returns two numbers of steps per second whose errors are above the rounding errors, and which no
/// method refuses.
fn steps(method: Method) -> [u32; 2] {
    match method.order() {
        4 if method.is_fixed_point() => [32, 64],
        4 => [16, 32],
        16 => [5, 7],
        _ => [5, 10],
    }
}

/// The motions are regular, so that errors grow no faster than the time. Single precision
/// represents their numbers exactly.
#[test]
fn every_method_has_its_order() -> Result<(), Error> {
    let trial = Trial::regular(16.0).held_by(Method::Rk4F32);
    let exact = trial.exact()?;
    let [coarse, fine] = ORDER_OF_METHODS;
    for method in exact_methods() {
        let order = order(method, &trial, &exact, steps(method))?;
        println!("{method}: {order:.2}");
        assert!(
            (order / f64::from(method.order()) - 1.0).abs() <= coarse,
            "{method}: order {order}"
        );
    }

    // RK4 in `f64` with equal and different masses and lengths. The steps are so fine that the next
    // order is small, and so coarse that rounding errors are small.
    let parameters = Parameters {
        m1: 3.0,
        m2: 0.5,
        l1: 1.0,
        l2: 0.4,
        g: 1.62,
    };

    let weak = Trial {
        parameters,
        start: State {
            a1: -0.4,
            a2: 0.6,
            p1: 0.2,
            p2: 0.1,
        },
        seconds: 20.0,
    };

    for (trial, steps) in [
        (Trial::regular(20.0), 128),
        (Trial::unlike(20.0), 1024),
        (weak, 256),
    ] {
        let exact = trial.exact()?;
        for steps in [steps, 2 * steps] {
            let order = order(Method::Rk4F64, &trial, &exact, [steps, 2 * steps])?;
            println!("{trial:?}: {order:.3}");
            assert!(
                (order / 4.0 - 1.0).abs() <= fine,
                "order {order} for {trial:?}"
            );
        }
    }

    Ok(())
}

/// The oscillation z'' = -z in the finest steps whose error is well above the rounding errors.
#[test]
fn extrapolation_of_any_equation_has_the_requested_order() -> Result<(), Error> {
    for (order, steps) in [(6, 196), (8, 49), (12, 12), (16, 5)] {
        let method = Extrapolation::new(order)?;
        let error = |steps: u32| {
            let dt = 20.0 / f64::from(steps);
            let [x, v] = (0..steps).fold([0.0, 1.0], |z, _| {
                method.step(|&[x, v]: &[f64; 2]| [v, -x], &z, dt)
            });
            (x - 20.0_f64.sin()).abs().max((v - 20.0_f64.cos()).abs())
        };

        let measured = (error(2 * steps) / error(3 * steps)).ln() / 1.5_f64.ln();
        println!("order {order}: {measured:.2}");
        let apart = (measured - f64::from(order)).abs();
        assert!(
            apart <= ORDER_EXTRAPOLATED,
            "order {measured} instead of {order}"
        );
    }

    for order in [0, 1, 7, 18, u32::MAX] {
        assert!(matches!(
            Extrapolation::<f64>::new(order),
            Err(Error::OutOfRange {
                parameter: Parameter::Order,
                ..
            })
        ));
    }

    Ok(())
}
