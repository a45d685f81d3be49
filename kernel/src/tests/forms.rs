//! Each form's short run against Hamilton's equations, stepped by the classical RK4 in `f64` ten times as finely: its rates of
//! change on average.

use double_pendulum::methods::{DirectionForm, ExtrapolatedForm, Fixed32Form, Fixed64Form, Form, Stepper};
use double_pendulum::{Motion, Parameters, Pendulum, Real};

use super::{EQUATIONS, assert_near};

/// So short that what one equation has wrong is not yet in the others.
const STEPS: u32 = 8;
const DT: f64 = 1.0 / 256.0;
/// Steps of the other side to one of these.
const FINER: u32 = 10;

/// Unlike masses, rods and rates, and a heavy bob 2 on equal rods: no term is small, and hardly a ratio 1.
const MOTIONS: [(Parameters<f64>, Motion<f64>); 2] = [
    (
        Parameters { m1: 0.75, m2: 1.25, l1: 0.625, l2: 1.125, g: 9.8125 },
        Motion { a1: 0.875, a2: -0.5, w1: 1.0, w2: -2.0 },
    ),
    (Parameters { m1: 1.0, m2: 3.0, l1: 1.0, l2: 1.0, g: 9.8125 }, Motion { a1: -0.5, a2: 1.0, w1: 2.0, w2: 1.0 }),
];

/// Rates relative to the greatest that the energy allows: what RK4 misses in steps of 1/256 s and roundings of 24 bits
/// (measured 1.1e-8; of fixed point with 30 bits 5e-9).
const RK4: f64 = 3e-8;
/// What the other side misses where the form does not, and roundings of 53 and 61 bits (measured 4e-14).
const ORDER_12: f64 = 2e-13;

fn is_that_of_hamiltons_equations<R: Real, F: Form<R>>(form: &str, tolerance: f64) {
    for (parameters, motion) in MOTIONS {
        // the motion of the very numbers that `R` holds
        let pendulum = Pendulum::new(parameters.cast::<R>().cast::<f64>()).expect("valid parameters");
        let start = pendulum.to_state(&motion).cast::<R>();
        let mut exact = start.cast();
        for _ in 0..STEPS * FINER {
            exact = pendulum.step(&exact, DT / f64::from(FINER));
        }
        let mut stepper = Stepper::<R, F>::new(&parameters.cast(), &start, DT).expect("a motion that it accepts");
        stepper.advance(STEPS);

        let bounds = pendulum.bounds(&start.cast());
        let range = pendulum.energy_above_rest(&start.cast()) - pendulum.least_energy();
        let scales = [bounds.w1, bounds.w2, range, range];
        let [rates, exact] = [stepper.state(), exact].map(|end| {
            let [end, start]: [[f64; 4]; 2] = [end.into(), start.cast().into()];
            core::array::from_fn::<f64, 4, _>(|i| (end[i] - start[i]) / (f64::from(STEPS) * DT))
        });
        let error = |&i: &usize| ((rates[i] - exact[i]) / scales[i]).abs();
        let worst = (0..4).max_by(|i, j| error(i).total_cmp(&error(j))).expect("four");
        assert_near(
            format_args!("{form}: {} on average, beside Pendulum::step,", EQUATIONS[worst]),
            rates[worst],
            exact[worst],
            scales[worst],
            tolerance,
            &parameters,
        );
    }
}

#[test]
fn direction_form_f32() {
    is_that_of_hamiltons_equations::<f32, DirectionForm<f32>>("DirectionForm<f32>", RK4);
}

#[test]
fn direction_form_f64() {
    is_that_of_hamiltons_equations::<f64, DirectionForm<f64>>("DirectionForm<f64>", RK4);
}

#[test]
fn extrapolated_form() {
    is_that_of_hamiltons_equations::<f64, ExtrapolatedForm<12>>("ExtrapolatedForm<12>", ORDER_12);
}

#[test]
fn fixed_32() {
    is_that_of_hamiltons_equations::<f64, Fixed32Form>("Fixed32Form", RK4);
}

#[test]
fn fixed_64() {
    is_that_of_hamiltons_equations::<f64, Fixed64Form<12>>("Fixed64Form<12>", ORDER_12);
}
