//! Extrapolation: the orders it names.

use double_pendulum::{Error, Extrapolation, Parameter};
use host_tests::oracle::tolerances;

/// A swing z'' = -z followed for 20 s.
fn error(order: u32, steps: u32) -> Result<f64, Error> {
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
        while error(order, 3 * steps)? > tolerances::ORDER_MEASURABLE {
            steps += 1 + steps / 8;
        }
        let [coarse, fine] = [error(order, 2 * steps)?, error(order, 3 * steps)?];
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
