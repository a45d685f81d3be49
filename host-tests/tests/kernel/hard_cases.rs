//! The hard cases: each form in each arithmetic, on motions that break a careless one.

use std::f64::consts::TAU;

use double_pendulum::{
    DirectionF32, DirectionF32Plain, DirectionF64, DirectionF64Plain, Error, Fixed32, Fixed64, Form, HamiltonF32,
    HamiltonF64, Modes, Motion, Parameters, Pendulum, Real, Run, State,
};
use host_tests::oracle::hard_cases::{HALVINGS, HARD_CASES, HardCase};
use host_tests::oracle::tolerances;
use host_tests::oracle::trials::Trial;
use rayon::prelude::*;
use reference::taylor::Reference;

/// A motion and those like it, with their exact states.
type Starts = [(Trial, Vec<State<f64>>)];

/// Halving the step never makes the typical error worse by more than `growth` above `least`, and in the end it is within `last`;
/// where that is NaN all is refused.
fn refining_pays<F: Form>(case: &HardCase, starts: &Starts, growth: f64, least: f64, last: f64) -> Result<(), Error> {
    let errors = match HardCase::typical_errors::<F>(starts) {
        Err(Error::OutOfRange { .. }) => Vec::new(),
        errors => errors?,
    };
    let about = format!("{}, {} ({}): {errors:?}", case.name, std::any::type_name::<F>(), case.reason);
    assert_eq!(errors.is_empty(), last.is_nan(), "{about}");
    for pair in errors.windows(2) {
        // beyond a tenth of a radian an error says nothing but that the motion is lost
        assert!(pair[0] > 0.1 || pair[1] <= (growth * pair[0]).max(least), "{about}");
    }
    assert!(errors.last().is_none_or(|&error| error <= last), "{about}");
    Ok(())
}

/// Every kind of number on one case: its own floor each, and of the error of a method in `f64` one start says all.
fn is_taken(case: &HardCase) -> Result<(), Error> {
    let &HardCase { floor, method, fixed: [words, long_words], growth, .. } = case;
    let single = |trial: Trial| Ok((trial, trial.exact::<f32>()?));
    let single = case.starts().map(single).collect::<Result<Vec<_>, Error>>()?;
    refining_pays::<DirectionF32>(case, &single, growth, growth * method * f64::from(f32::EPSILON), floor)?;
    let double = |trial: Trial| Ok((trial, trial.exact::<f64>()?));
    let double = case.starts().take(8).map(double).collect::<Result<Vec<_>, Error>>()?;
    refining_pays::<DirectionF64>(case, &double[..1], growth, growth * method * f64::EPSILON, method)?;
    refining_pays::<Fixed32>(case, &double, 1.5, words, words)?;
    refining_pays::<Fixed64<12>>(case, &double[..1], 1.5, long_words, long_words)
}

#[test]
fn every_hard_case_is_taken() -> Result<(), Error> {
    HARD_CASES.par_iter().try_for_each(is_taken)
}

/// Tests of all forms in floating point, compensated and plain.
macro_rules! every_form {
    ($($test:ident: $holds:ident;)*) => {$(
        #[test]
        fn $test() -> Result<(), Error> {
            $holds::<DirectionF32>()?;
            $holds::<DirectionF32Plain>()?;
            $holds::<DirectionF64>()?;
            $holds::<DirectionF64Plain>()
        }
    )*};
}

every_form! {
    upright_falls_when_theory_says: upright_falls;
    straight_rods_turn_evenly_without_gravity: turns_straight;
    what_is_at_rest_stays: rest_stays;
    denormals_do_no_harm: tiny_swings;
    the_edge_of_stability_is_where_it_should_be: stability_edge;
}

/// Rods of 1 m and bobs of 1 kg.
fn even(gravity: f64) -> Parameters<f64> {
    Parameters::equal_rods(1.0, 1.0, gravity)
}

fn run<F: Form>(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Run<F>, Error> {
    Pendulum::new(parameters)?.run(start, dt)
}

/// When rod 1 is a radian from where it started, s; looked at every 1/64 s.
fn fall(mut angle: impl FnMut() -> f64) -> f64 {
    let start = angle();
    let looks = (1..=16 * 64).find(|_| (angle() - start).abs() > 1.0);
    looks.map_or(f64::INFINITY, |looks| f64::from(looks) / 64.0)
}

/// Straight up, to the last digit that the form has: it falls when the exact motion from there does, whatever the step.
fn upright_falls<F: Form>() -> Result<(), Error> {
    let (up, parameters) = (F::Real::PI.to_f64(), even(9.81_f64 as f32 as f64));
    let mut reference = Reference::new(&parameters, &Motion::at_rest(up, up));
    let mut time = 0.0;
    let exact = fall(|| {
        reference.advance_to(time);
        time += 1.0 / 64.0;
        reference.motion().a1
    });
    assert!(exact.is_finite());
    for halvings in HALVINGS.skip(2) {
        let mut motion = run::<F>(&parameters, &State::at_rest(up, up), 0.5_f64.powi(halvings))?;
        let mut steps = 0;
        let falls = fall(|| {
            motion.advance(steps).expect("a finite motion");
            steps = 1 << (halvings - 6);
            motion.angles()[0].to_f64().rem_euclid(TAU)
        });
        assert!((falls - exact).abs() <= tolerances::FALL, "2^-{halvings} s: after {falls} s instead of {exact} s");
    }
    Ok(())
}

/// As one writes the method down, the angle stands still until an increment reaches half a unit of its last place: the
/// momentum grows by the torque, so after (ulp/2)/(g error dt), the error being that of pi. Then it falls.
fn upright_stays_where_increments_are_lost<R: Real>(error: f64) -> Result<(), Error> {
    let pendulum = Pendulum::new(&even(9.81).cast::<R>())?;
    let ulp = 2.0 * R::EPSILON.to_f64();
    for steps_per_second in [64_u32, 256] {
        let dt = 1.0 / f64::from(steps_per_second);
        let stays = 0.5 * ulp / (9.81 * error * dt);
        let mut state = State::at_rest(R::PI, R::PI);
        let mut steps = 0_u32;
        while state.a1 == R::PI && steps < 100 * steps_per_second {
            state = pendulum.step(&state, R::from_f64(dt));
            steps += 1;
        }
        let stayed = f64::from(steps) * dt;
        assert!((stayed / stays - 1.0).abs() <= tolerances::STAYS, "{stayed} s instead of {stays} s");
    }
    Ok(())
}

#[test]
fn upright_stays_as_long_as_theory_says_in_plain_sums() -> Result<(), Error> {
    upright_stays_where_increments_are_lost::<f32>(f64::from(std::f32::consts::PI) - std::f64::consts::PI)?;
    upright_stays_where_increments_are_lost::<f64>(1.224_646_799_147_353_2e-16)
}

/// Straight and turning as one, without gravity: a = a(0) + w t, to the roundings of the turning.
fn turns_straight<F: Form>() -> Result<(), Error> {
    let parameters = Parameters { l2: 0.5, ..even(0.0) };
    let state = Pendulum::new(&parameters)?.to_state(&Motion { a1: 1.0, a2: 1.0, w1: 2.0, w2: 2.0 });
    let mut motion = run::<F>(&parameters, &state, 1.0 / 256.0)?;
    for seconds in 1..=20 {
        motion.advance(256)?;
        let State { a1, a2, p1, p2 } = motion.state();
        let miss = [a1, a2].map(|angle| (angle - 1.0 - 2.0 * f64::from(seconds)).abs()).into_iter().fold(0.0, f64::max);
        assert!(miss <= tolerances::STRAIGHT.of::<F::Real>(), "{miss:e} rad after {seconds} s");
        let lost = ((p1 + p2) / (state.p1 + state.p2) - 1.0).abs();
        assert!(lost <= tolerances::STRAIGHT.of::<F::Real>(), "angular momentum: {lost:e} after {seconds} s");
    }
    Ok(())
}

/// Hanging, and without gravity anywhere: what is at rest stays there, to the bit.
fn rest_stays<F: Form>() -> Result<(), Error> {
    for (gravity, a1, a2) in [(9.81, 0.0, 0.0), (0.0, 3.0, -2.0)] {
        let mut motion = run::<F>(&even(gravity), &State::at_rest(a1, a2), 1.0 / 64.0)?;
        let start = motion.state();
        motion.advance(10_000)?;
        let now = motion.state();
        let moved = (now.a1 - start.a1).abs().max((now.a2 - start.a2).abs());
        assert!(moved <= F::Real::EPSILON.to_f64() && now.p1 == 0.0 && now.p2 == 0.0, "{now:?} from {start:?}");
    }
    Ok(())
}

/// A swing so small that every square vanishes is the linear one; one of subnormal numbers stays as small as it was.
fn tiny_swings<F: Form>() -> Result<(), Error> {
    let parameters = even(9.81);
    let slow = Modes::new(&parameters)?.slow;
    // far above the least normal number, and at a few units of the least of all
    let (tiny, subnormal) = if F::Real::EPSILON.to_f64() > f64::EPSILON {
        (2f64.powi(-80), 2f64.powi(-146))
    } else {
        (2f64.powi(-900), 2f64.powi(-1071))
    };
    let mut motion = run::<F>(&parameters, &State::at_rest(tiny, tiny * slow.shape), 1.0 / 256.0)?;
    for step in 1..=10 * 64 {
        motion.advance(4)?;
        let expected = (slow.frequency * f64::from(step) / 64.0).cos();
        let miss = (motion.state().a1 / tiny - expected).abs();
        assert!(miss <= tolerances::TINY.of::<F::Real>(), "{miss:e} at step {step}");
    }
    let mut motion = run::<F>(&parameters, &State::at_rest(subnormal, subnormal), 1.0 / 256.0)?;
    motion.advance(10_000)?;
    let State { a1, a2, .. } = motion.state();
    assert!(a1.abs() <= 1000.0 * subnormal && a2.abs() <= 1000.0 * subnormal, "{a1:e}, {a2:e} from {subnormal:e}");
    Ok(())
}

/// The fast mode just below the step limit decays, just above it grows: by 15 % a step, until it is so wide that its
/// frequency is another, which may be at less than 0.001 rad.
fn stability_edge<F: Form>() -> Result<(), Error> {
    const SMALL: f64 = 1e-5;
    for parameters in [even(9.81), Parameters { m2: 1000.0, ..even(9.81) }, Parameters { l2: 0.01, ..even(9.81) }] {
        let modes = Modes::new(&parameters)?;
        assert_eq!(modes.check_step(modes.step_limit()), Ok(()));
        assert!([1.01 * modes.step_limit(), 0.0, f64::NAN].iter().all(|dt| modes.check_step(*dt).is_err()));
        let shape = modes.fast.shape;
        let start =
            if shape.abs() > 1.0 { State::at_rest(SMALL / shape, SMALL) } else { State::at_rest(SMALL, SMALL * shape) };
        let swing = |share: f64| -> Result<f64, Error> {
            let mut motion = run::<F>(&parameters, &start, modes.step_limit() * share)?;
            let mut late = 0.0_f64;
            for step in 0..200 {
                motion.advance(1)?;
                let State { a1, a2, .. } = motion.state();
                if step >= 100 {
                    late = late.max(a1.abs()).max(a2.abs());
                }
            }
            Ok(late)
        };
        let [below, above] = [swing(0.98)?, swing(1.02)?];
        let [decayed, grown] = tolerances::STABILITY_EDGE;
        assert!(below < decayed, "{below:e} below the limit");
        assert!(above > grown, "{above:e} above the limit");
    }
    Ok(())
}

#[test]
fn the_edge_is_where_it_should_be_in_plain_sums() -> Result<(), Error> {
    stability_edge::<HamiltonF32>()?;
    stability_edge::<HamiltonF64>()
}

/// A million steps of 2^-13 s: compensated sums do not care how many there are.
#[test]
fn a_million_steps() -> Result<(), Error> {
    let trial = Trial::at_rest(1.0, 0.5, 0.5, 1_000_000.0 / 8192.0);
    let (single, double) = (trial.exact::<f32>()?, trial.exact::<f64>()?);
    let error = |states: Vec<State<f64>>, exact| host_tests::oracle::trials::largest_difference(&states, exact);
    let dt = 1.0 / 8192.0;
    for (form, miss, budget) in [
        ("f32", error(trial.states::<DirectionF32>(dt)?, &single), tolerances::MILLION_STEPS.single),
        ("f64", error(trial.states::<DirectionF64>(dt)?, &double), tolerances::MILLION_STEPS.double),
    ] {
        println!("{form}: {miss:.1e} rad");
        assert!(miss <= budget, "{form}: {miss:e} rad");
    }
    Ok(())
}
