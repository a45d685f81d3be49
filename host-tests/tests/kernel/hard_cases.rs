//! The hard cases: each form in each arithmetic, on motions that break a careless one.

use std::f64::consts::TAU;

use double_pendulum::methods::{DirectionForm, Form, Plain, UnwrappedStepper};
use double_pendulum::{Error, Modes, Motion, Parameters, Pendulum, Real, State};
use host_tests::oracle::hard_cases::{HALVINGS, HARD_CASES, HardCase};
use host_tests::oracle::reference::Reference;
use host_tests::oracle::tolerances;
use host_tests::oracle::trials::Trial;

/// Halving the step never makes the typical error much worse, and in the end the error is within its budget.
fn refining_pays<R: Real>(case: &HardCase, starts: usize) -> Result<(), Error> {
    let exact = |trial: Trial| Ok((trial, trial.exact::<R>()?));
    let starts = case.starts().take(starts).map(exact).collect::<Result<Vec<_>, Error>>()?;
    let errors = HardCase::typical_errors::<R, DirectionForm<R>>(&starts)?;
    let HardCase { name, floor, method, growth, reason, .. } = case;
    let about = format!("{name} ({reason}): {errors:?}");
    for pair in errors.windows(2) {
        // beyond a tenth of a radian an error says nothing but that the motion is lost
        assert!(pair[0] > 0.1 || pair[1] <= growth * pair[0].max(method * R::EPSILON.to_f64()), "{about}");
    }
    let budget = if R::EPSILON.to_f64() > f64::EPSILON { floor } else { method };
    assert!(errors.last().is_some_and(|last| last <= budget), "{about}");
    Ok(())
}

macro_rules! hard_cases {
    ($($test:ident: $index:literal;)*) => {$(
        #[test]
        fn $test() -> Result<(), Error> {
            let case = &HARD_CASES[$index];
            refining_pays::<f32>(case, usize::MAX)?;
            refining_pays::<f64>(case, 1) // the method's own error is no accident: one start says all
        }
    )*};
}

hard_cases! {
    regular: 0;
    chaotic: 1;
    near_upright: 2;
    heavy_elbow: 3;
    far_heavier_elbow: 4;
    light_elbow: 5;
    rods_100_to_1: 6;
    rods_1_to_100: 7;
    no_gravity: 8;
    whirling: 9;
    far_angles: 10;
}

/// All forms, compensated and plain: `$test` for each.
macro_rules! every_form {
    ($test:ident, $real:ty) => {
        $test::<$real, DirectionForm<$real>>()?;
        $test::<$real, DirectionForm<$real, Plain>>()?;
    };
}

/// Rods of 1 m and bobs of 1 kg, as `R` holds them.
fn even<R: Real>(gravity: f64) -> Parameters<R> {
    Parameters::equal_rods(R::ONE, R::ONE, R::from_f64(gravity))
}

/// When rod 1 is a radian from where it started, s; looked at every 1/64 s.
fn fall(mut angle: impl FnMut() -> f64) -> f64 {
    let start = angle();
    let looks = (1..=16 * 64).find(|_| (angle() - start).abs() > 1.0);
    looks.map_or(f64::INFINITY, |looks| f64::from(looks) / 64.0)
}

/// Straight up, to the last digit that `R` has: it falls when the exact motion from there does, whatever the step.
fn upright_falls<R: Real, F: Form<R>>() -> Result<(), Error> {
    let start = State::at_rest(R::PI, R::PI);
    let exact_start = Motion::at_rest(R::PI.to_f64(), R::PI.to_f64());
    let mut reference = Reference::new(&even(9.81_f64 as f32 as f64), &exact_start);
    let mut time = 0.0;
    let exact = fall(|| {
        reference.advance_to(time);
        time += 1.0 / 64.0;
        reference.motion().a1
    });
    assert!(exact.is_finite());
    for halvings in HALVINGS.skip(2) {
        let form = F::new(&even(9.81_f64 as f32 as f64), 0.5_f64.powi(halvings))?;
        let mut carried = form.start(&start)?;
        let mut steps = 0;
        let falls = fall(|| {
            form.advance(&mut carried, steps);
            steps = 1 << (halvings - 6);
            let [[sine, cosine], _] = form.directions(&carried);
            sine.to_f64().atan2(cosine.to_f64()).rem_euclid(TAU)
        });
        assert!((falls - exact).abs() <= tolerances::FALL, "2^-{halvings} s: after {falls} s instead of {exact} s");
    }
    Ok(())
}

#[test]
fn upright_falls_when_theory_says() -> Result<(), Error> {
    every_form!(upright_falls, f32);
    every_form!(upright_falls, f64);
    Ok(())
}

/// As one writes the method down, the angle stands still until an increment reaches half a unit of its last place: the
/// momentum grows by the torque, so after (ulp/2)/(g error dt), the error being that of pi. Then it falls.
fn upright_stays_where_increments_are_lost<R: Real>(error: f64) -> Result<(), Error> {
    let pendulum = Pendulum::new(even::<R>(9.81))?;
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
fn turns_straight<R: Real, F: Form<R>>() -> Result<(), Error> {
    let parameters = Parameters { l2: R::HALF, ..even(0.0) };
    let start = Motion { a1: R::ONE, a2: R::ONE, w1: R::TWO, w2: R::TWO };
    let state = Pendulum::new(parameters)?.to_state(&start);
    let form = F::new(&parameters, 1.0 / 256.0)?;
    let mut carried = form.start(&state)?;
    for seconds in 1..=20 {
        form.advance(&mut carried, 256);
        let State { a1, a2, p1, p2 } = form.state(&carried);
        let turned = |angle: f64| ((angle - 1.0 - 2.0 * f64::from(seconds)) / TAU).rem_euclid(1.0) * TAU;
        let miss = [a1, a2].map(turned).map(|miss| miss.min(TAU - miss)).into_iter().fold(0.0, f64::max);
        assert!(miss <= tolerances::STRAIGHT.of::<R>(), "{miss:e} rad after {seconds} s");
        let lost = ((p1 + p2) / (state.p1 + state.p2).to_f64() - 1.0).abs();
        assert!(lost <= tolerances::STRAIGHT.of::<R>(), "angular momentum: {lost:e} after {seconds} s");
    }
    Ok(())
}

#[test]
fn straight_rods_turn_evenly_without_gravity() -> Result<(), Error> {
    every_form!(turns_straight, f32);
    every_form!(turns_straight, f64);
    Ok(())
}

/// Hanging, and without gravity anywhere: what is at rest stays there, to the bit.
fn rest_stays<R: Real, F: Form<R>>() -> Result<(), Error> {
    for (gravity, a1, a2) in [(9.81, 0.0, 0.0), (0.0, 3.0, -2.0)] {
        let form = F::new(&even(gravity), 1.0 / 64.0)?;
        let mut carried = form.start(&State::at_rest(R::from_f64(a1), R::from_f64(a2)))?;
        let start = form.state(&carried);
        form.advance(&mut carried, 10_000);
        let now = form.state(&carried);
        let moved = (now.a1 - start.a1).abs().max((now.a2 - start.a2).abs());
        assert!(moved <= R::EPSILON.to_f64() && now.p1 == 0.0 && now.p2 == 0.0, "{now:?} from {start:?}");
    }
    Ok(())
}

#[test]
fn what_is_at_rest_stays() -> Result<(), Error> {
    every_form!(rest_stays, f32);
    every_form!(rest_stays, f64);
    Ok(())
}

/// A swing so small that every square vanishes is the linear one; one of subnormal numbers stays as small as it was.
fn tiny_swings<R: Real, F: Form<R>>() -> Result<(), Error> {
    let parameters = even::<R>(9.81);
    let slow = Modes::new(&parameters)?.slow;
    // far above the least normal number, and at a few units of the least of all
    let (tiny, subnormal) = if R::EPSILON.to_f64() > f64::EPSILON {
        (2f64.powi(-80), 2f64.powi(-146))
    } else {
        (2f64.powi(-900), 2f64.powi(-1071))
    };
    let form = F::new(&parameters, 1.0 / 256.0)?;
    let mut carried = form.start(&State::at_rest(R::from_f64(tiny), R::from_f64(tiny) * slow.shape))?;
    for step in 1..=10 * 64 {
        form.advance(&mut carried, 4);
        let expected = (slow.frequency.to_f64() * f64::from(step) / 64.0).cos();
        let miss = (form.state(&carried).a1 / tiny - expected).abs();
        assert!(miss <= tolerances::TINY.of::<R>(), "{miss:e} at step {step}");
    }
    let mut carried = form.start(&State::at_rest(R::from_f64(subnormal), R::from_f64(subnormal)))?;
    form.advance(&mut carried, 10_000);
    let State { a1, a2, .. } = form.state(&carried);
    assert!(a1.abs() <= 1000.0 * subnormal && a2.abs() <= 1000.0 * subnormal, "{a1:e}, {a2:e} from {subnormal:e}");
    Ok(())
}

#[test]
fn denormals_do_no_harm() -> Result<(), Error> {
    every_form!(tiny_swings, f32);
    every_form!(tiny_swings, f64);
    Ok(())
}

/// The fast mode just below the step limit decays, just above it grows: by 15 % a step, until it is so wide that its
/// frequency is another, which may be at less than 0.001 rad.
fn stability_edge<R: Real, F: Form<R>>() -> Result<(), Error> {
    for parameters in [
        even::<R>(9.81),
        Parameters { m2: R::from_f64(1000.0), ..even(9.81) },
        Parameters { l2: R::from_f64(0.01), ..even(9.81) },
    ] {
        let modes = Modes::new(&parameters)?;
        let small = R::from_f64(1e-5);
        let start = if modes.fast.shape.abs() > R::ONE {
            State::at_rest(small / modes.fast.shape, small)
        } else {
            State::at_rest(small, small * modes.fast.shape)
        };
        let swing = |share: f64| -> Result<f64, Error> {
            let form = F::new(&parameters, modes.step_limit().to_f64() * share)?;
            let mut carried = form.start(&start)?;
            let mut late = 0.0_f64;
            for step in 0..200 {
                form.advance(&mut carried, 1);
                let State { a1, a2, .. } = form.state(&carried);
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
fn the_edge_of_stability_is_where_it_should_be() -> Result<(), Error> {
    every_form!(stability_edge, f32);
    every_form!(stability_edge, f64);
    Ok(())
}

/// A million steps of 2^-13 s: compensated sums do not care how many there are.
#[test]
fn a_million_steps() -> Result<(), Error> {
    let trial = Trial::at_rest(1.0, 0.5, 0.5, 1_000_000.0 / 8192.0);
    let (single, double) = (trial.exact::<f32>()?, trial.exact::<f64>()?);
    let error = |states: Vec<State<f64>>, exact| host_tests::oracle::trials::largest_difference(&states, exact);
    let dt = 1.0 / 8192.0;
    for (form, miss, budget) in [
        ("f32", error(trial.states::<f32, DirectionForm<f32>>(dt)?, &single), tolerances::MILLION_STEPS.single),
        ("f64", error(trial.states::<f64, DirectionForm<f64>>(dt)?, &double), tolerances::MILLION_STEPS.double),
    ] {
        println!("{form}: {miss:.1e} rad");
        assert!(miss <= budget, "{form}: {miss:e} rad");
    }
    Ok(())
}

#[test]
fn whirling_turns_are_counted() -> Result<(), Error> {
    let trial = HARD_CASES[9].trial;
    let (parameters, start) = trial.rounded::<f32>();
    let mut motion = UnwrappedStepper::<f32, DirectionForm<f32>>::new(&parameters, &start, 1.0 / 4096.0)?;
    let mut turned = 0.0;
    for exact in trial.exact::<f32>()? {
        motion.advance(4096 / 16);
        let state = motion.state();
        let miss = (state.a1 - exact.a1).abs().max((state.a2 - exact.a2).abs());
        assert!(miss < tolerances::WHIRLING, "{miss:e}: {state:?}, {exact:?}");
        turned = state.a1.abs().max(state.a2.abs());
    }
    assert!(turned > 5.0 * TAU, "{turned} rad");
    Ok(())
}
