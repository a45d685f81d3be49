//! Each form's short run against Hamilton's equations, stepped by the classical RK4 in `f64` ten times as finely: its rates of
//! change on average.

use double_pendulum::parts::DirectionF64;
use double_pendulum::{
    DirectionF32, ExtrapolationF64, Fixed32, Fixed64, Form, HamiltonF64, Motion, Parameters,
    Pendulum,
};

use super::{EQUATIONS, assert_near};

/// So short that what one equation has wrong is not yet in the others.
const STEPS: u32 = 8;
const DT: f64 = 1.0 / 256.0;
/// Steps of the other side to one of these.
const FINER: u32 = 10;

/// Unlike masses, rods and rates, and a heavy bob 2 on equal rods: no term is small, and hardly a ratio 1.
const MOTIONS: [(Parameters<f64>, Motion<f64>); 2] = [
    (
        Parameters {
            m1: 0.75,
            m2: 1.25,
            l1: 0.625,
            l2: 1.125,
            g: 9.8125,
        },
        Motion {
            a1: 0.875,
            a2: -0.5,
            w1: 1.0,
            w2: -2.0,
        },
    ),
    (
        Parameters {
            m1: 1.0,
            m2: 3.0,
            l1: 1.0,
            l2: 1.0,
            g: 9.8125,
        },
        Motion {
            a1: -0.5,
            a2: 1.0,
            w1: 2.0,
            w2: 1.0,
        },
    ),
];

/// Rates relative to the greatest that the energy allows: what RK4 misses in steps of 1/256 s and roundings of 24 bits
/// (measured 1.1e-8; of fixed point with 30 bits 5e-9).
pub const RK4: f64 = 3e-8;
/// What the other side misses where the form does not, and roundings of 53 and 61 bits (measured 4e-14).
const ORDER_12: f64 = 2e-13;

#[track_caller]
pub fn is_that_of_hamiltons_equations<F: Form>(tolerance: f64) {
    let form = core::any::type_name::<F>();
    for (parameters, motion) in MOTIONS {
        // the motion of the very numbers that it holds
        let pendulum =
            Pendulum::new(&parameters.cast::<F::Real>().cast::<f64>()).expect("valid parameters");
        let start = pendulum.to_state(&motion).cast::<F::Real>().cast();
        let mut exact = start;
        for _ in 0..STEPS * FINER {
            exact = pendulum.step(&exact, DT / f64::from(FINER));
        }
        let mut run = pendulum
            .run::<F>(&start, DT)
            .expect("a motion that it accepts");
        run.advance(STEPS).expect("finite");

        let bounds = pendulum.bounds(&start);
        let range = pendulum.energy_above_rest(&start) - pendulum.least_energy();
        let scales = [bounds.w1, bounds.w2, range, range];
        let [rates, exact] = [run.state(), exact].map(|end| {
            let [end, start]: [[f64; 4]; 2] = [end.into(), start.into()];
            core::array::from_fn::<f64, 4, _>(|i| (end[i] - start[i]) / (f64::from(STEPS) * DT))
        });
        let error = |&i: &usize| ((rates[i] - exact[i]) / scales[i]).abs();
        let worst = (0..4)
            .max_by(|i, j| error(i).total_cmp(&error(j)))
            .expect("four");
        assert_near(
            format_args!(
                "{form}: {} on average, compared with Pendulum::step (one of the two is wrong),",
                EQUATIONS[worst]
            ),
            rates[worst],
            exact[worst],
            scales[worst],
            tolerance,
            &parameters,
        );
    }
}

#[test]
fn every_form_is_that_of_hamiltons_equations() {
    is_that_of_hamiltons_equations::<DirectionF32>(RK4);
    is_that_of_hamiltons_equations::<DirectionF64>(RK4);
    is_that_of_hamiltons_equations::<HamiltonF64>(RK4);
    is_that_of_hamiltons_equations::<Fixed32>(RK4);
    is_that_of_hamiltons_equations::<ExtrapolationF64<12>>(ORDER_12);
    is_that_of_hamiltons_equations::<Fixed64<12>>(ORDER_12);
}
