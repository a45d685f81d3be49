//! The kernel's motion against the reference, and the order of its method.

use double_pendulum::{Motion, Parameters, Pendulum, rk4};
use host_tests::oracle::tolerances;
use reference::taylor::Reference;

/// Regular motions, in which an error grows no faster than the time: masses and lengths alike and unlike.
fn regular() -> [(Parameters<f64>, Motion<f64>); 3] {
    let half = 30_f64.to_radians();
    [
        (Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.8 }, Motion::at_rest(half, half)),
        (Parameters { m1: 0.7, m2: 1.3, l1: 0.6, l2: 1.1, g: 9.81 }, Motion { a1: 0.3, a2: -0.2, w1: 0.4, w2: -0.5 }),
        (Parameters { m1: 3.0, m2: 0.5, l1: 1.0, l2: 0.4, g: 1.62 }, Motion { a1: -0.4, a2: 0.6, w1: 0.0, w2: 1.0 }),
    ]
}

/// The largest difference of the angles in 20 s, looked at every second.
fn error(parameters: &Parameters<f64>, start: &Motion<f64>, steps_per_second: u32) -> f64 {
    let pendulum = Pendulum::new(parameters).expect("valid parameters");
    let mut reference = Reference::new(parameters, start);
    let mut state = pendulum.to_state(start);
    let mut largest = 0.0_f64;
    for second in 1..=20 {
        for _ in 0..steps_per_second {
            state = pendulum.step(&state, 1.0 / f64::from(steps_per_second));
        }
        reference.advance_to(f64::from(second));
        let exact = reference.motion();
        largest = largest.max((state.a1 - exact.a1).abs()).max((state.a2 - exact.a2).abs());
    }
    largest
}

#[test]
fn order_is_4() {
    // fine enough that the next order is small, coarse enough that rounding is
    for ((parameters, start), steps) in regular().into_iter().zip([128, 1024, 256]) {
        let errors = [steps, 2 * steps, 4 * steps].map(|steps| error(&parameters, &start, steps));
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        for order in orders {
            assert!(tolerances::ORDER.contains(&order), "order {order} for {parameters:?}");
        }
    }
}

/// The method itself, on an equation whose solution is known: z' = z from 1.
#[test]
fn order_is_4_for_the_exponential() {
    let error = |steps: u32| {
        let end = (0..steps).fold([1.0], |z, _| rk4::step(|&z: &[f64; 1]| z, &z, 1.0 / f64::from(steps)));
        (end[0] - std::f64::consts::E).abs()
    };
    let order = (error(64) / error(128)).log2();
    assert!(tolerances::ORDER.contains(&order), "order {order}");
}
