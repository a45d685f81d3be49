//! Tests of each form: the average rates of change in a short run must be those of Hamilton's
//! equations, by RK4 in `f64` in ten times finer steps.

use double_pendulum::parts::DirectionF64;
use double_pendulum::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, Error, ExtrapolationF64,
    Fixed32, Fixed64, Form, HamiltonF32, HamiltonF64, Motion, Parameters, Pendulum, State,
};

use super::{EQUATIONS, assert_near};
use crate::methods::{Advance, FormOperations};

/// So few that an error in one equation has not spread to the others yet.
const STEPS: u32 = 8;
const DT: f64 = 1.0 / 256.0;
const FINER: u32 = 10;

/// No term is small, and almost no ratio is 1.
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

/// Relative to the largest rate that the energy allows. It covers the truncation error in steps of
/// 1/256 s and rounding to 24 bits. Measured: 1.1e-8, and 5e-9 for fixed point with 30 bits.
const RK4: f64 = 3e-8;
/// It covers the truncation error of the finer RK4, and the rounding to 53 and 61 bits. Measured:
/// 4e-14.
const ORDER_12: f64 = 2e-13;

/// The message names the worst of the four equations.
#[track_caller]
fn is_that_of_hamiltons_equations<F: Form>(tolerance: f64) {
    let form = core::any::type_name::<F>();
    for (parameters, motion) in MOTIONS {
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

/// The allowance is the neglected terms of the fourth order.
#[test]
fn closed_form_stands_at_its_start_before_its_first_step() {
    const FOURTH_ORDER: f64 = 1e-8;
    let (parameters, _) = MOTIONS[0];
    let pendulum = Pendulum::new(&parameters).expect("valid parameters");
    let [start, other] =
        [[0.01, -0.02], [-0.02, 0.01]].map(|[a1, a2]| pendulum.to_state(&Motion::at_rest(a1, a2)));

    let first = ClosedFormF64::new(&parameters, &start, DT).expect("a valid motion");
    let second = first.started(&other).expect("a valid motion");
    for (form, state) in [(first, start), (second, other)] {
        for ([sin, cos], angle) in form.directions::<f64>().into_iter().zip(state.angles()) {
            assert_near("sine", sin, libm::sin(angle), 1.0, FOURTH_ORDER, &state);
            assert_near("cosine", cos, libm::cos(angle), 1.0, FOURTH_ORDER, &state);
        }
    }
}

/// The amplitudes of rod 2 add up to more than the 0.6 rad of the series, those of rod 1 to less.
#[test]
fn closed_form_is_exact_if_only_rod_2_swings_wide() {
    let parameters = Parameters::equal_rods(1.0, 1.0, 9.8125);
    let start = State::at_rest(0.5, 0.5);
    let form = ClosedFormF64::new(&parameters, &start, DT).expect("a valid motion");
    for [sin, cos] in form.directions::<f64>() {
        assert_near("sine", sin, libm::sin(0.5), 1.0, 1e-14, &start);
        assert_near("cosine", cos, libm::cos(0.5), 1.0, 1e-14, &start);
    }
}

#[track_caller]
fn starts_anew<F: Form>() {
    let (parameters, motion) = MOTIONS[0];
    let pendulum = Pendulum::new(&parameters).expect("valid parameters");
    let start = pendulum.to_state(&motion);
    let new = F::new(&parameters, &start, DT).expect("a motion that it accepts");
    let mut moved = new;
    moved.advance(5);
    assert_ne!(moved, new);
    assert_eq!(moved.started(&start), Ok(new));
}

#[test]
fn every_form_starts_anew() {
    starts_anew::<DirectionF32>();
    starts_anew::<DirectionF32Plain>();
    starts_anew::<DirectionF64>();
    starts_anew::<HamiltonF32>();
    starts_anew::<HamiltonF64>();
    starts_anew::<Fixed32>();
    starts_anew::<ExtrapolationF64<12>>();
    starts_anew::<Fixed64<12>>();
    starts_anew::<ClosedFormF32>();
    starts_anew::<ClosedFormF64>();
}

/// Measured: 6e-15.
const ENERGY: f64 = 1e-13;
/// The sides of an `f64` keep 20 bits of its fraction.
const SIDES: f64 = 2e-6;

/// Relative to the larger momentum. Measured: 0.
const MOMENTA: f64 = 1e-15;
/// The same for momenta that are rounded to `f32`. Measured: 1.4e-7.
const MOMENTA_IN_F32: f64 = 3e-7;

/// The closed form computes energy and momenta from the state, so that only its sides are tested.
#[track_caller]
fn energy_momenta_and_sides_are_right<F: Form>(momenta: f64) {
    let form = core::any::type_name::<F>();
    for (parameters, motion) in MOTIONS {
        let pendulum = Pendulum::new(&parameters).expect("valid parameters");
        let start = pendulum.to_state(&motion);
        let mut motion = F::new(&parameters, &start, DT).expect("a motion that it accepts");
        for _ in 0..STEPS {
            motion.advance_one();
            let energy = pendulum.energy_above_rest(&motion.state());
            assert_near(
                format_args!("{form}: energy"),
                motion.energy_above_rest(&pendulum),
                energy,
                energy,
                ENERGY,
                &parameters,
            );

            let State { p1, p2, .. } = motion.state();
            let largest = f64::max(p1.abs(), p2.abs());
            for (momentum, expected) in motion.momenta::<f64>().into_iter().zip([p1, p2]) {
                assert_near(
                    format_args!("{form}: momentum"),
                    momentum,
                    expected,
                    largest,
                    momenta,
                    &parameters,
                );
            }

            for (sides, direction) in motion.sides().into_iter().zip(motion.directions::<f64>()) {
                // The unit of the sides is arbitrary, so scale them to length 1.
                let [sin, cos]: [f64; 2] = sides.map(|side| F::side_value(side).into());
                let length = libm::hypot(sin, cos);
                for (side, expected) in [sin, cos].into_iter().zip(direction) {
                    assert_near(
                        format_args!("{form}: side"),
                        side / length,
                        expected,
                        1.0,
                        SIDES,
                        &parameters,
                    );
                }
            }
        }
    }
}

/// `HamiltonF32` computes its energy from directions that are rounded to `f32`.
#[test]
fn energy_and_momenta_are_those_of_the_state_and_sides_are_the_directions() {
    energy_momenta_and_sides_are_right::<DirectionF32>(MOMENTA_IN_F32);
    energy_momenta_and_sides_are_right::<DirectionF32Plain>(MOMENTA_IN_F32);
    energy_momenta_and_sides_are_right::<DirectionF64>(MOMENTA);
    energy_momenta_and_sides_are_right::<HamiltonF64>(MOMENTA);
    energy_momenta_and_sides_are_right::<Fixed32>(MOMENTA);
    energy_momenta_and_sides_are_right::<ExtrapolationF64<12>>(MOMENTA);
    energy_momenta_and_sides_are_right::<Fixed64<12>>(MOMENTA);
    energy_momenta_and_sides_are_right::<ClosedFormF32>(MOMENTA);
    energy_momenta_and_sides_are_right::<ClosedFormF64>(MOMENTA);
}

#[track_caller]
fn reports_a_motion_that_overflows<F: Form>() {
    let (parameters, _) = MOTIONS[0];
    let pendulum = Pendulum::new(&parameters).expect("valid parameters");
    let start = pendulum.to_state(&Motion {
        a1: 1.0,
        a2: 2.0,
        w1: 1e3,
        w2: -1e3,
    });
    let mut motion = F::new(&parameters, &start, 1.0).expect("a motion that it accepts");
    assert_eq!(motion.check(), Ok(()));
    motion.advance(1000);
    let check = motion.check();
    let form = core::any::type_name::<F>();
    assert!(
        matches!(check, Err(Error::Diverged { .. })),
        "{form}: {check:?}"
    );
}

#[test]
fn every_form_in_floating_point_reports_an_overflow() {
    reports_a_motion_that_overflows::<DirectionF32>();
    reports_a_motion_that_overflows::<DirectionF32Plain>();
    reports_a_motion_that_overflows::<DirectionF64>();
    reports_a_motion_that_overflows::<HamiltonF32>();
    reports_a_motion_that_overflows::<HamiltonF64>();
    reports_a_motion_that_overflows::<ExtrapolationF64<12>>();
}
