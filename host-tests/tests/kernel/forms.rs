//! The fast forms: the same method, its order, its accuracy, and what is carried besides.

use std::f64::consts::{PI, TAU};

use double_pendulum::methods::{
    Compensated, DirectionForm, DirectionState, ExtrapolatedForm, Fixed64Form, Form, Plain, UnwrappedStepper, Winding,
};
use double_pendulum::{Error, Motion, Parameter, Parameters, Pendulum, Real, State};
use fastrand::Rng;
use host_tests::oracle::trials::{Trial, largest_difference};
use host_tests::oracle::{random, tolerances};

/// 0.5 rad, at rest: no chaos.
fn regular(seconds: f64) -> Trial {
    Trial::at_rest(1.0, 0.5, 0.5, seconds)
}

/// 2 rad, at rest: chaotic, it turns over.
fn chaotic(seconds: f64) -> Trial {
    Trial::at_rest(1.0, 2.0, 2.0, seconds)
}

/// Masses and lengths all different, in motion.
fn unlike(seconds: f64) -> Trial {
    let parameters = Parameters { m1: 0.7, m2: 1.3, l1: 0.6, l2: 1.1, g: 9.81 };
    Trial { parameters, start: State { a1: 0.3, a2: -0.2, p1: 0.1, p2: -0.1 }, seconds }
}

#[test]
fn the_order_is_4() -> Result<(), Error> {
    for (trial, steps) in [(regular(20.0), 128.0), (unlike(20.0), 1024.0)] {
        let errors = |error: fn(&Trial, f64) -> Result<f64, Error>| -> Result<f64, Error> {
            Ok((error(&trial, 1.0 / steps)? / error(&trial, 0.5 / steps)?).log2())
        };
        let order = errors(Trial::error::<f64, DirectionForm<f64>>)?;
        assert!(tolerances::ORDER.contains(&order), "order {order} for {trial:?}");
    }
    Ok(())
}

#[test]
fn compensated_single_precision_keeps_its_budget() -> Result<(), Error> {
    for (i, seconds) in [10.0, 100.0].into_iter().enumerate() {
        let direction = regular(seconds).error::<f32, DirectionForm<f32>>(1.0 / 256.0)?;
        println!("{seconds} s: {direction:.2e}");
        assert!(direction <= tolerances::DIRECTION_FORM[i], "direction form, {seconds} s: {direction:e}");
    }
    Ok(())
}

/// Root mean square of the errors over neighbouring starts in steps of `dt`, compensated `f32`. The truth is order 16 in
/// `f64`, which keeps 1e-12 rad here and costs a thousandth of the reference's time.
fn typical_error(seconds: f64, dt: f64) -> Result<f64, Error> {
    const STARTS: u32 = 32;
    let mut squares = 0.0;
    for i in 0..STARTS {
        let on = f64::from(i) * 6e-5;
        let trial = Trial::at_rest(1.0, 0.5 + on, 0.5 - 0.5 * on, seconds);
        let (parameters, start) = trial.rounded::<f32>();
        let rounded = Trial { parameters: parameters.cast(), start: start.cast(), seconds };
        let exact = rounded.states::<f64, ExtrapolatedForm<16>>(1.0 / 16.0)?;
        squares += largest_difference(&trial.states::<f32, DirectionForm<f32>>(dt)?, &exact).powi(2);
    }
    Ok((squares / f64::from(STARTS)).sqrt())
}

#[test]
fn typical_errors_of_compensated_single_precision() -> Result<(), Error> {
    for (i, seconds) in [10.0, 100.0].into_iter().enumerate() {
        let error = typical_error(seconds, 1.0 / 256.0)?;
        println!("{seconds} s: {error:.2e}");
        assert!(error <= tolerances::TYPICAL_DIRECTION_FORM[i], "{seconds} s: {error:e}");
    }
    Ok(())
}

/// What `f32` makes of 1/240 s would be 3e-7 s of time in 10 s, and 1e-6 rad.
#[test]
fn a_step_that_f32_cannot_hold_is_taken_exactly() -> Result<(), Error> {
    let error = typical_error(10.0, 1.0 / 240.0)?;
    println!("240 steps a second: {error:.2e}");
    assert!(error <= tolerances::TYPICAL_DIRECTION_FORM[0] * tolerances::LONGER_STEP, "{error:e}");
    Ok(())
}

#[test]
fn compensation_pays() -> Result<(), Error> {
    for dt in [1.0 / 256.0, 1.0 / 1024.0] {
        let trial = regular(10.0);
        let gain = trial.error::<f32, DirectionForm<f32, Plain>>(dt)? / trial.error::<f32, DirectionForm<f32>>(dt)?;
        assert!(gain >= tolerances::COMPENSATION_GAIN, "{gain}");
    }
    Ok(())
}

#[test]
fn backwards_is_forwards_undone() -> Result<(), Error> {
    fn there_and_back<F: Form<f64>>() -> Result<(), Error> {
        let (parameters, start) = unlike(1.0).rounded();
        let [forth, back] = [F::new(&parameters, 1.0 / 1024.0)?, F::new(&parameters, -1.0 / 1024.0)?];
        let mut carried = forth.start(&start)?;
        forth.advance(&mut carried, 1024);
        let mut carried = back.start(&forth.state(&carried))?;
        back.advance(&mut carried, 1024);
        let difference = largest_difference(&[back.state(&carried)], &[start]);
        assert!(difference <= tolerances::RETURN, "{difference:e}");
        Ok(())
    }
    there_and_back::<DirectionForm<f64>>()?;
    there_and_back::<ExtrapolatedForm<12>>()
}

#[test]
fn how_steps_are_dealt_out_changes_nothing() -> Result<(), Error> {
    fn same<R: Real, F: Form<R>>() -> Result<(), Error> {
        let (parameters, start) = chaotic(1.0).rounded::<R>();
        let form = F::new(&parameters, 1.0 / 256.0)?;
        let mut all = form.start(&start)?;
        let mut each = all;
        form.advance(&mut all, 1000);
        (0..1000).for_each(|_| form.advance(&mut each, 1));
        assert_eq!(bits::<R, F>(&all), bits::<R, F>(&each));
        Ok(())
    }
    same::<f32, DirectionForm<f32>>()?;
    same::<f64, DirectionForm<f64, Plain>>()?;
    same::<f64, ExtrapolatedForm<12>>()
}

fn bits<R: Real, F: Form<R>>(carried: &F::Carried) -> Vec<u64> {
    let mut words = Vec::new();
    F::bits(carried, |word| words.push(word));
    words
}

#[test]
fn directions_are_those_of_the_angles() -> Result<(), Error> {
    /// No rod turns faster in these motions, rad/s.
    const FASTEST: f64 = 10.0;
    fn agree<R: Real, F: Form<R>>(trial: &Trial) -> Result<(), Error> {
        let (parameters, start) = trial.rounded::<R>();
        let form = F::new(&parameters, 1.0 / 64.0)?;
        let mut carried = form.start(&start)?;
        for look in 1..=10 {
            form.advance(&mut carried, 7);
            // the directions are ahead of the state by as much as the steps are longer than dt
            let ahead = tolerances::LONGER * R::EPSILON.to_f64() * f64::from(look * 7) / 64.0;
            let budget = tolerances::DIRECTIONS * R::EPSILON.to_f64() + FASTEST * ahead;
            let State { a1, a2, .. } = form.state(&carried);
            for ([sine, cosine], angle) in form.directions(&carried).into_iter().zip([a1, a2]) {
                let [along, across] = [
                    sine.to_f64() * angle.sin() + cosine.to_f64() * angle.cos(),
                    sine.to_f64() * angle.cos() - cosine.to_f64() * angle.sin(),
                ];
                assert!(across.abs() <= budget, "{across:e} at {angle}");
                assert!((along - 1.0).abs() <= tolerances::LENGTHS, "{along} long at {angle}");
            }
        }
        Ok(())
    }
    for trial in [chaotic(1.0), unlike(1.0)] {
        agree::<f32, DirectionForm<f32>>(&trial)?;
        agree::<f64, DirectionForm<f64>>(&trial)?;
        agree::<f64, ExtrapolatedForm<12>>(&trial)?;
        agree::<f64, Fixed64Form<12>>(&trial)?;
    }
    Ok(())
}

/// The turns that a rod has made since its start follow from its angular velocity, step by step.
#[test]
fn turns_are_those_that_the_velocity_makes() -> Result<(), Error> {
    let (parameters, start) = Trial::at_rest(2.75, 3.0, 3.0, 1.0).rounded::<f64>();
    let (pendulum, dt) = (Pendulum::new(parameters)?, 1.0 / 2048.0);
    let mut motion = UnwrappedStepper::<f64, DirectionForm<f64>>::new(&parameters, &start, dt)?;
    let velocities = |state: &State<f64>| {
        let Motion { w1, w2, .. } = pendulum.to_motion(state);
        [w1, w2]
    };
    let (mut angles, mut before, mut most) = (start.angles(), velocities(&start), 0.0_f64);
    for _ in 0..10 * 2048 {
        motion.advance(1);
        let state = motion.state();
        let now = velocities(&state);
        for i in 0..2 {
            angles[i] += 0.5 * dt * (before[i] + now[i]);
            assert!((state.angles()[i] - angles[i]).abs() < 0.1, "{state:?}, {angles:?}");
            most = most.max(angles[i].abs());
        }
        before = now;
    }
    assert!(most > 2.0 * TAU, "it never turned over twice: {most}");
    Ok(())
}

/// Any angle, moved on by less than a quarter turn at a time, is known from its directions, and from itself but for its turns.
#[test]
fn winding_follows_an_angle_either_way() {
    let mut rng = Rng::with_seed(7);
    let mut angle = 1.0_f64;
    let mut winding = Winding::new(angle);
    let mut farthest = 0.0_f64;
    for _ in 0..100_000 {
        angle += 1.5 * random::symmetric(&mut rng);
        winding.observe([angle.sin(), angle.cos()]);
        let known = [winding.angle(), winding.unwrap(angle.rem_euclid(TAU)), winding.unwrap(angle - 7.0 * TAU)];
        assert!(known.iter().all(|known| (known - angle).abs() < 1e-9), "{known:?} for {angle}");
        farthest = farthest.max(angle.abs());
    }
    assert!(farthest > 10.0 * TAU, "{farthest}");
}

#[test]
fn a_start_angle_of_many_turns_is_the_same_motion() -> Result<(), Error> {
    let turns = 159.0 * TAU; // 999 rad
    let near = Trial::at_rest(1.0, 0.5, -0.25, 5.0);
    for turns in [turns, -turns] {
        let far = Trial { start: State { a1: 0.5 + turns, a2: -0.25 - turns, ..near.start }, ..near };
        let expected = near.states::<f64, DirectionForm<f64>>(1.0 / 256.0)?;
        let difference = largest_difference(&far.states::<f64, DirectionForm<f64>>(1.0 / 256.0)?, &expected);
        assert!(difference <= tolerances::FAR_ANGLE, "{difference:e}");
    }
    Ok(())
}

#[test]
fn what_is_carried_is_small() {
    assert!(size_of::<DirectionState<f32, Compensated<f32>>>() <= 128);
}

#[test]
fn bad_input_is_refused_by_name() -> Result<(), Error> {
    let good = Parameters { m1: 1.0_f32, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
    for dt in [f64::NAN, f64::INFINITY] {
        let refused = DirectionForm::<f32>::new(&good, dt);
        assert!(matches!(refused, Err(Error::NotFinite { parameter: Parameter::Dt, .. })));
    }
    for dt in [0.0, 1e-40] {
        let refused = DirectionForm::<f32>::new(&good, dt);
        assert!(matches!(refused, Err(Error::OutOfRange { parameter: Parameter::Dt, .. })));
    }
    let refused = DirectionForm::<f32>::new(&Parameters { m2: -1.0, ..good }, 0.01);
    assert!(matches!(refused, Err(Error::NotPositive { parameter: Parameter::M2, .. })));
    let refused = DirectionForm::<f32>::new(&Parameters { m1: 1e30, m2: 1e-30, ..good }, 0.01);
    assert!(matches!(refused, Err(Error::OutOfRange { .. })));

    let form = DirectionForm::<f32>::new(&good, 0.01)?;
    let refused = form.start(&State::at_rest(f32::NAN, 0.0));
    assert!(matches!(refused, Err(Error::NotFinite { parameter: Parameter::A1, .. })));
    let light = DirectionForm::<f32>::new(&Parameters { m2: 0.1, l2: 0.1, ..good }, 0.01)?;
    let refused = light.start(&State { p1: 3e38, ..State::at_rest(PI as f32, 0.0) });
    let value = f64::from(3e38_f32);
    assert!(
        matches!(refused, Err(Error::OutOfRange { parameter: Parameter::P1, value: named }) if (named / value - 1.0).abs() < 1e-6),
        "{refused:?}"
    );
    Ok(())
}
