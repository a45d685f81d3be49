//! Pendulums of all magnitudes: each is refused by a typed error, or every answer is right.
//!
//! The million of `cargo test -p host-tests --test kernel range:: -- --ignored` takes two minutes.

use double_pendulum::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, Error, ExtrapolationF64,
    Fixed32, Fixed64, Form, HamiltonF32, HamiltonF64, Modes, Motion, Parameter, Parameters,
    Pendulum, State, periodic_mass_ratio,
};
use exact::random::{log_uniform, symmetric};
use fastrand::Rng;

fn magnitude(rng: &mut Rng) -> f64 {
    match rng.u8(..8) {
        0 => log_uniform(rng, 1e-300, 1e300),
        1 => log_uniform(rng, 1e-12, 1e12),
        2 | 3 => log_uniform(rng, 0.1, 10.0),
        _ => log_uniform(rng, 1e-9, 1e9),
    }
}

fn of_either_sign(rng: &mut Rng) -> f64 {
    match rng.u8(..4) {
        0 => 0.0,
        1 => 3.0 * symmetric(rng),
        2 => log_uniform(rng, 1e-12, 1e3).copysign(symmetric(rng)),
        _ => log_uniform(rng, 1e-300, 1e300).copysign(symmetric(rng)),
    }
}

fn parameters(rng: &mut Rng) -> Parameters<f64> {
    let [m1, m2, l1, l2] = [(); 4].map(|()| magnitude(rng));
    let g = if rng.u8(..4) == 0 {
        0.0
    } else {
        magnitude(rng)
    };
    Parameters { m1, m2, l1, l2, g }
}

/// The relative error of a bound in `f32`: its numbers are rounded once before and once after.
const SINGLE: f64 = 2e-6;

const STILL: f64 = 1e-140;

fn bounds_are_right(parameters: &Parameters<f64>, motion: &Motion<f64>) -> Result<(), Error> {
    let pendulum = Pendulum::new(parameters)?;
    let state = pendulum.to_state(motion);
    state.check()?;
    let bounds = pendulum.bounds(&state);
    let case = || format!("{parameters:?} {motion:?}: {bounds:?}");
    if !bounds.elbow.is_finite() {
        return Ok(());
    }

    // The conversion to momenta and back loses digits with the ratio of the inertias.
    let lost = 1e-13 * (1.0 + parameters.m2 / parameters.m1);
    let bending = (motion.w1 - motion.w2).abs();
    for (reached, bound) in [
        (motion.w1.abs(), bounds.w1),
        (motion.w2.abs(), bounds.w2),
        (bending, bounds.elbow),
    ] {
        let allowed = bound * (1.0 + SINGLE) + lost * bounds.elbow + STILL;
        assert!(reached <= allowed, "{reached:e} {bound:e}: {}", case());
    }

    let Ok(single) = Pendulum::<f32>::new(&parameters.cast()) else {
        return Ok(());
    };
    let rounded = state.cast::<f32>();
    let exact = Pendulum::new(&parameters.cast::<f32>().cast::<f64>())?;
    let expected = exact.bounds(&rounded.cast()).elbow;
    let is_near = |value: f32, expected: f64| {
        let nearest = expected as f32;
        !nearest.is_normal() || (f64::from(value) / expected - 1.0).abs() < SINGLE
    };
    assert!(
        is_near(single.bounds(&rounded).elbow, expected),
        "{}",
        case()
    );
    let step = exact.admissible_step(&rounded.cast())?;
    assert!(
        is_near(single.admissible_step(&rounded)?, step),
        "{}",
        case()
    );
    let certified = single.cannot_turn_over(&rounded);
    let margin = 1.0 + 1e-6 * (1.0 + parameters.m2 / parameters.m1).sqrt();
    let energy = exact.energy_above_rest(&rounded.cast());
    assert!(
        !certified || energy < margin * exact.turnover_energy(),
        "{}",
        case()
    );
    Ok(())
}

fn run<F: Form>(pendulum: &Pendulum<f64>, start: &State<f64>, dt: f64) -> Result<(), Error> {
    let is_resolved = dt <= pendulum.admissible_step(start)?;
    let mut run = pendulum.run::<F>(start, dt)?;
    let directions = |rods: [[F::Real; 2]; 2]| {
        rods.map(|rod| {
            let [sin, cos]: [f64; 2] = rod.map(Into::into);
            sin.hypot(cos)
        })
    };
    for length in directions(run.directions()) {
        assert!((length - 1.0).abs() < 1e-3, "{length} at the start");
    }
    run.advance(40)?;
    for length in directions(run.directions()) {
        assert!(
            (length - 1.0).abs() < 1e-2 || !is_resolved,
            "{length} after 40 steps of {dt:e} s by {}: {:?} {start:?}",
            std::any::type_name::<F>(),
            pendulum.parameters()
        );
    }
    Ok(())
}

fn is_typed(error: Error) -> bool {
    matches!(
        error,
        Error::NotFinite { .. }
            | Error::NotPositive { .. }
            | Error::TooSmall { .. }
            | Error::TooLarge { .. }
            | Error::OutOfRange { .. }
            | Error::Diverged { .. }
    )
}

fn try_pendulums(seed: u64, count: u32) {
    let mut rng = Rng::with_seed(seed);
    let mut accepted = 0;
    for _ in 0..count {
        let parameters = parameters(&mut rng);
        let [a1, a2, w1, w2] = [(); 4].map(|()| of_either_sign(&mut rng));
        let motion = Motion { a1, a2, w1, w2 };
        let _refused = periodic_mass_ratio(3, 2, [parameters.l1, parameters.l2]).map(is_in_range);
        let _refused = Modes::<f32>::new(&parameters.cast());
        let Ok(pendulum) = Pendulum::new(&parameters) else {
            continue;
        };
        accepted += 1;
        assert!(bounds_are_right(&parameters, &motion).map_or_else(is_typed, |()| true));

        let start = pendulum.to_state(&motion);
        let share = log_uniform(&mut rng, 1e-3, 10.0);
        let resolved = pendulum.admissible_step(&start).unwrap_or(1e-3);
        let dt = share * if resolved.is_normal() { resolved } else { 1e-3 };
        for result in [
            run::<HamiltonF32>(&pendulum, &start, dt),
            run::<HamiltonF64>(&pendulum, &start, dt),
            run::<DirectionF32>(&pendulum, &start, dt),
            run::<DirectionF32Plain>(&pendulum, &start, dt),
            run::<Fixed32>(&pendulum, &start, dt),
            run::<Fixed64<10>>(&pendulum, &start, dt),
            run::<ExtrapolationF64<4>>(&pendulum, &start, dt),
            run::<ClosedFormF32>(&pendulum, &start, dt),
            run::<ClosedFormF64>(&pendulum, &start, dt),
        ] {
            assert!(result.map_or_else(is_typed, |()| true));
        }
    }
    assert!(accepted > count / 5, "only {accepted} of {count}");
}

fn is_in_range(mass_ratio: f64) -> bool {
    mass_ratio.is_normal() && mass_ratio > 0.0
}

#[test]
fn pendulums_of_all_magnitudes_are_refused_or_right() {
    try_pendulums(1, 3_000);
}

#[test]
#[ignore = "minutes"]
fn a_million_pendulums_of_all_magnitudes_are_refused_or_right() {
    try_pendulums(2, 1_000_000);
}

/// A motion does not depend on the units of mass, length and time: pendulums with masses of 1e-9,
/// 1 and 1e9 kg and rods of 1e-9 to 1e9 m move alike, if gravity makes them as fast.
#[test]
fn motion_is_that_of_a_similar_pendulum() -> Result<(), Error> {
    fn angles<F: Form>(mass: f64, length: f64) -> Result<[f64; 2], Error> {
        let pendulum = Pendulum::new(&Parameters {
            m1: mass,
            m2: mass,
            l1: length,
            l2: length,
            g: (9.81 * length).min(1e9),
        })?;
        let slower = (9.81 * length / pendulum.parameters().g).sqrt();
        let start = pendulum.to_state(&Motion {
            a1: 0.5,
            a2: -1.0,
            w1: 1.0 / slower,
            w2: -2.0 / slower,
        });
        let mut run = pendulum.run::<F>(&start, slower / 256.0)?;
        run.advance(512)?;
        let State { a1, a2, .. } = run.state();
        Ok([a1, a2])
    }
    fn are_alike<F: Form>(allowed: f64) -> Result<(), Error> {
        let expected = angles::<F>(1.0, 1.0)?;
        for mass in [1e-9, 1e-4, 1e9] {
            for length in [1e-9, 1e-4, 1e9] {
                let found = angles::<F>(mass, length)?;
                for (found, expected) in found.into_iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(off < allowed, "{mass} kg, {length} m: {off:e} rad");
                }
            }
        }
        Ok(())
    }

    // The rounding of 512 steps.
    are_alike::<HamiltonF32>(1e-4)?;
    are_alike::<DirectionF32>(1e-6)?;
    are_alike::<DirectionF32Plain>(1e-5)?;
    are_alike::<Fixed32>(1e-6)?;
    are_alike::<HamiltonF64>(1e-12)?;
    are_alike::<ExtrapolationF64<4>>(1e-12)?;
    are_alike::<Fixed64<10>>(1e-12)
}

#[test]
fn magnitudes_out_of_range_are_refused_by_name() {
    let with = |m2, l1| {
        Pendulum::<f32>::new(&Parameters {
            m1: 1.0,
            m2,
            l1,
            l2: 1.0,
            g: 9.81,
        })
        .map(drop)
    };
    let too_small = |parameter, value: f32| {
        Err(Error::TooSmall {
            parameter,
            value: value.into(),
            limit: 1e-9,
        })
    };
    assert_eq!(with(1e-24, 1.0), too_small(Parameter::M2, 1e-24));
    assert_eq!(with(1.0, 1e-22), too_small(Parameter::L1, 1e-22));
    assert_eq!(with(1e-9, 1e9), Ok(()));
    let rods = periodic_mass_ratio(3, 2, [5.37e-24_f32; 2]).map(drop);
    assert_eq!(rods, too_small(Parameter::L1, 5.37e-24));
}
