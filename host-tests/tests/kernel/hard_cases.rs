//! The hard cases: the methods of the table on motions that are difficult for their numbers.

use double_pendulum::{Equations, Error, Method, Numbers, Parameter, State};
use exact::hard_cases::{HardCase, hard_cases};
use exact::tolerances;
use exact::trials::{MOMENTS, Trial, exact_methods, largest_difference};
use rayon::prelude::*;

/// The error of an angle, rad, along a million compensated steps of 2^-13 s of the regular scene,
/// in `f32` and in the `f64` of
/// [`Trial::states_in_f64`](exact::trials::Trial::states_in_f64) (measured 2e-7 and 9e-14;
/// plain sums have an error of 2e-5 in `f32`).
const MILLION_STEPS: tolerances::PerPrecision = tolerances::PerPrecision {
    single: 5e-7,
    double: 3e-13,
};

/// The exponents k of the steps, 2^-k s.
pub const HALVINGS: std::ops::RangeInclusive<i32> = 4..=13;

/// The number of starts of a case. The logarithm of an error at its floor spreads by about 0.5, and
/// the mean over this number of starts by 0.1.
const STARTS: u32 = 24;

/// Measured: up to 610.
const PLAIN: f64 = 2000.0;

/// Returns three limits on a typical error: the largest growth for a halved step, as a factor, the
/// error that may grow by any factor, and the largest error in the finest steps.
fn budget(
    &HardCase {
        floor,
        method: own,
        fixed,
        growth,
        in_angles,
        ..
    }: &HardCase,
    method: Method,
) -> [f64; 3] {
    let plain = PLAIN
        * floor
        * if method.equations() == Equations::Directions {
            1.0
        } else {
            in_angles
        };
    // Errors in `f64` are smaller by the ratio of the epsilons, down to the method's own error.
    let double = own.max(plain * f64::EPSILON / f64::from(f32::EPSILON));
    match method.numbers() {
        Numbers::CompensatedF32 => [growth, growth * own * f64::from(f32::EPSILON), floor],
        Numbers::Fixed32 => [1.5, fixed[0], fixed[0]],
        Numbers::Fixed64 => [1.5, fixed[1], fixed[1]],
        Numbers::F32 => [2.0 * growth, plain, plain],
        Numbers::F64 | Numbers::CompensatedF64 => [growth, double, double],
    }
}

/// If `last` is NaN, all steps must be refused.
fn refining_pays(case: &HardCase, method: Method) -> Result<(), Error> {
    let [growth, least, last] = budget(case, method);
    // For a truncation error one start is enough.
    let starts = match method.numbers() {
        Numbers::CompensatedF32 => STARTS,
        Numbers::F32 | Numbers::Fixed32 => 8,
        _ => 1,
    };

    // For methods in 32 bits, order 16 in `f64` is accurate enough, at a tenth of the reference's
    // cost.
    let is_narrow = method.is_single() || method.numbers() == Numbers::Fixed32;
    let with_exact = |i| {
        let on = f64::from(i) * case.spread;
        let State { a1, a2, p1, p2 } = case.trial.start;
        let trial = Trial {
            start: State {
                a1: a1 + on,
                a2: a2 + 0.5 * on,
                p1,
                p2,
            },
            ..case.trial
        };

        let held = trial.held_by(method);
        Ok((
            trial,
            if is_narrow {
                held.states(Method::Extrapolation16F64, 1.0 / 512.0)?
            } else {
                held.exact()?
            },
        ))
    };

    let starts = (0..starts)
        .map(with_exact)
        .collect::<Result<Vec<_>, Error>>()?;
    let typical_error = |halvings| {
        let error = |(trial, exact): &(Trial, Vec<State<f64>>)| {
            let states = trial.states(method, 0.5_f64.powi(halvings))?;
            Ok(largest_difference(&states, exact)
                .max(f64::MIN_POSITIVE)
                .ln())
        };

        let logarithms = starts.iter().map(error).sum::<Result<f64, Error>>()?;
        Ok((logarithms / starts.len() as f64).exp())
    };

    let is_too_long = |error: &_| {
        matches!(
            error,
            Err(Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            })
        )
    };

    let errors = match HALVINGS
        .map(typical_error)
        .filter(|error| !is_too_long(error))
        .collect()
    {
        Err(Error::OutOfRange { .. }) => Vec::new(),
        errors => errors?,
    };
    let about = format!("{}, {method} ({}): {errors:?}", case.name, case.reason);
    assert_eq!(errors.is_empty(), last.is_nan(), "{about}");
    for pair in errors.windows(2) {
        // An error above a tenth of a radian shows only that the motion is wrong.
        assert!(
            pair[0] > 0.1 || pair[1] <= (growth * pair[0]).max(least),
            "{about}"
        );
    }

    assert!(errors.last().is_none_or(|&error| error <= last), "{about}");
    Ok(())
}

/// Errors above 0.1 rad, and small ones that stay below a floor, may grow when the step is halved.
#[test]
fn finer_steps_are_no_worse_in_every_hard_case() -> Result<(), Error> {
    let all = |case| exact_methods().map(move |method| (case, method));
    let all: Vec<_> = hard_cases().into_iter().flat_map(all).collect();
    all.into_par_iter()
        .try_for_each(|(case, method)| refining_pays(&case, method))
}

#[test]
fn compensated_sums_stay_accurate_for_a_million_steps() -> Result<(), Error> {
    let dt = 1.0 / 8192.0;
    let trial = Trial::regular(1e6 * dt);
    let single = trial.error(Method::Rk4F32Direction, dt)?;
    let double = largest_difference(&trial.states_in_f64(dt, MOMENTS)?, &trial.exact()?);
    println!("{single:.1e} rad, {double:.1e} rad");
    let tolerances::PerPrecision {
        single: most,
        double: least,
    } = MILLION_STEPS;
    assert!(
        single <= most && double <= least,
        "{single:e} rad, {double:e} rad"
    );
    Ok(())
}
