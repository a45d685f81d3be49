//! The fast forms: the same method, its order, its accuracy, and what is carried besides.

use std::f64::consts::{PI, TAU};

use double_pendulum::form::{
    AngleForm, AngleState, Compensated, DirectionForm, DirectionForm8, DirectionState, Divided, Fixed64Form, Form,
    Plain, Winding,
};
use double_pendulum::{Error, Parameter, Parameters, Pendulum, Real, State};
use fastrand::Rng;
use host_tests::oracle::trials::{self, Trial, largest_difference};
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

/// The states that [`Pendulum::step`] comes to.
fn textbook(trial: &Trial, dt: f64) -> Vec<State<f64>> {
    let pendulum = Pendulum::new(trial.parameters).expect("valid parameters");
    let mut state = trial.start;
    let mut next = || {
        (0..(trial.seconds / dt / 16.0) as u32).for_each(|_| state = pendulum.step(&state, dt));
        state
    };
    (0..16).map(|_| next()).collect()
}

#[test]
fn the_angle_form_is_the_classical_method() -> Result<(), Error> {
    for (trial, dt) in [(regular(100.0), 1.0 / 256.0), (unlike(100.0), 1.0 / 256.0), (chaotic(3.0), 1.0 / 64.0)] {
        let difference = largest_difference(&trial.states::<f64, AngleForm<f64>>(dt)?, &textbook(&trial, dt));
        assert!(difference <= tolerances::SAME_METHOD, "{difference:e} for {trial:?}");
    }
    Ok(())
}

/// With 0.3 rad to the step every step turns too far for the short polynomials.
#[test]
fn the_angle_form_is_the_classical_method_where_the_guard_acts() -> Result<(), Error> {
    let (trial, dt) = (chaotic(2.0), 1.0 / 16.0);
    let difference = largest_difference(&trial.states::<f64, AngleForm<f64>>(dt)?, &textbook(&trial, dt));
    assert!(difference <= tolerances::SAME_METHOD, "{difference:e}");
    Ok(())
}

#[test]
fn the_order_is_4() -> Result<(), Error> {
    for (trial, steps) in [(regular(20.0), 128.0), (unlike(20.0), 1024.0)] {
        let errors = |error: fn(&Trial, f64) -> Result<f64, Error>| -> Result<f64, Error> {
            Ok((error(&trial, 1.0 / steps)? / error(&trial, 0.5 / steps)?).log2())
        };
        for order in [
            errors(Trial::error::<f64, AngleForm<f64>>)?,
            errors(Trial::error::<f64, DirectionForm<f64>>)?,
            errors(Trial::error::<f64, DirectionForm<f64, Plain, Divided>>)?,
        ] {
            assert!(tolerances::ORDER.contains(&order), "order {order} for {trial:?}");
        }
    }
    Ok(())
}

#[test]
fn the_order_of_order_8_is_8() -> Result<(), Error> {
    for (trial, steps) in trials::slow() {
        let dt = 1.0 / f64::from(steps);
        let order = |error: fn(&Trial, f64) -> Result<f64, Error>| -> Result<f64, Error> {
            Ok((error(&trial, dt)? / error(&trial, 0.5 * dt)?).log2())
        };
        for order in
            [order(Trial::error::<f64, DirectionForm8<f64>>)?, order(Trial::error::<f64, DirectionForm8<f64, Plain>>)?]
        {
            assert!(tolerances::ORDER_8.contains(&order), "order {order} for {trial:?}");
        }
    }
    Ok(())
}

#[test]
fn steps_of_order_8_keep_their_promise() -> Result<(), Error> {
    for (steps, budget) in tolerances::PICTURE_OF_ORDER_8 {
        let error = regular(10.0).error::<f64, DirectionForm8<f64>>(1.0 / f64::from(steps))?;
        println!("{steps} steps a second: {error:.2e} rad");
        assert!(error < budget, "{error:e} rad with {steps} steps a second");
    }
    Ok(())
}

#[test]
fn the_picture_forms_method_is_as_good_as_the_angle_forms() -> Result<(), Error> {
    for (trial, dt) in [(regular(10.0), 1.0 / 256.0), (chaotic(5.0), 1.0 / 512.0), (unlike(10.0), 1.0 / 512.0)] {
        let ratio = trial.error::<f64, DirectionForm<f64>>(dt)? / trial.error::<f64, AngleForm<f64>>(dt)?;
        assert!(ratio <= tolerances::PICTURE_AGAINST_ANGLE, "{ratio} for {trial:?}");
    }
    Ok(())
}

#[test]
fn compensated_single_precision_keeps_its_budget() -> Result<(), Error> {
    for (i, seconds) in [10.0, 100.0].into_iter().enumerate() {
        let angle = regular(seconds).error::<f32, AngleForm<f32>>(1.0 / 256.0)?;
        let direction = regular(seconds).error::<f32, DirectionForm<f32>>(1.0 / 256.0)?;
        println!("{seconds} s: angle form {angle:.2e}, direction form {direction:.2e}");
        assert!(angle <= tolerances::ANGLE_FORM[i], "angle form, {seconds} s: {angle:e}");
        assert!(direction <= tolerances::DIRECTION_FORM[i], "direction form, {seconds} s: {direction:e}");
    }
    Ok(())
}

/// Root mean square of the errors over neighbouring starts in steps of `dt`: angle form and direction form,
/// compensated `f32`. The truth is order 8 in `f64`, which keeps 1e-11 rad here (`steps_of_order_8_keep_their_promise`) and costs a thousandth of the
/// reference's time.
fn typical_errors(seconds: f64, dt: f64) -> Result<[f64; 2], Error> {
    const STARTS: u32 = 32;
    let mut squares = [0.0; 2];
    for i in 0..STARTS {
        let on = f64::from(i) * 6e-5;
        let trial = Trial::at_rest(1.0, 0.5 + on, 0.5 - 0.5 * on, seconds);
        let (parameters, start) = trial.rounded::<f32>();
        let rounded = Trial { parameters: parameters.cast(), start: start.cast(), seconds };
        let exact = rounded.states::<f64, DirectionForm8<f64>>(1.0 / 64.0)?;
        let states = [trial.states::<f32, AngleForm<f32>>(dt)?, trial.states::<f32, DirectionForm<f32>>(dt)?];
        for (sum, states) in squares.iter_mut().zip(&states) {
            *sum += largest_difference(states, &exact).powi(2);
        }
    }
    Ok(squares.map(|sum| (sum / f64::from(STARTS)).sqrt()))
}

#[test]
fn typical_errors_of_compensated_single_precision() -> Result<(), Error> {
    for (i, seconds) in [10.0, 100.0].into_iter().enumerate() {
        let [angle, direction] = typical_errors(seconds, 1.0 / 256.0)?;
        println!("{seconds} s: angle form {angle:.2e}, direction form {direction:.2e}");
        assert!(angle <= tolerances::TYPICAL_ANGLE_FORM[i], "angle form, {seconds} s: {angle:e}");
        assert!(direction <= tolerances::TYPICAL_DIRECTION_FORM[i], "direction form, {seconds} s: {direction:e}");
    }
    Ok(())
}

/// What `f32` makes of 1/240 s would be 3e-7 s of time in 10 s, and 1e-6 rad.
#[test]
fn a_step_that_f32_cannot_hold_is_taken_exactly() -> Result<(), Error> {
    let [angle, direction] = typical_errors(10.0, 1.0 / 240.0)?;
    println!("240 steps a second: angle form {angle:.2e}, direction form {direction:.2e}");
    let [angle, direction] = [angle, direction].map(|error| error / tolerances::LONGER_STEP);
    assert!(angle <= tolerances::TYPICAL_ANGLE_FORM[0], "angle form: {angle:e}");
    assert!(direction <= tolerances::TYPICAL_DIRECTION_FORM[0], "direction form: {direction:e}");
    Ok(())
}

#[test]
fn compensation_pays() -> Result<(), Error> {
    for dt in [1.0 / 256.0, 1.0 / 1024.0] {
        let trial = regular(10.0);
        let angle = trial.error::<f32, AngleForm<f32, Plain>>(dt)? / trial.error::<f32, AngleForm<f32>>(dt)?;
        let direction =
            trial.error::<f32, DirectionForm<f32, Plain>>(dt)? / trial.error::<f32, DirectionForm<f32>>(dt)?;
        assert!(angle >= tolerances::COMPENSATION_GAIN, "angle form: {angle}");
        assert!(direction >= tolerances::COMPENSATION_GAIN, "direction form: {direction}");
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
    there_and_back::<AngleForm<f64>>()?;
    there_and_back::<DirectionForm<f64>>()?;
    there_and_back::<DirectionForm8<f64>>()
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
    same::<f32, AngleForm<f32>>()?;
    same::<f32, DirectionForm<f32>>()?;
    same::<f64, AngleForm<f64, Plain>>()?;
    same::<f64, DirectionForm<f64, Plain, Divided>>()?;
    same::<f64, DirectionForm8<f64>>()
}

fn bits<R: Real, F: Form<R>>(carried: &F::Carried) -> Vec<u64> {
    let mut words = Vec::new();
    F::bits(carried, |word| words.push(word));
    words
}

#[test]
fn directions_are_those_of_the_angles() -> Result<(), Error> {
    fn agree<R: Real, F: Form<R>>(trial: &Trial) -> Result<(), Error> {
        let (parameters, start) = trial.rounded::<R>();
        let form = F::new(&parameters, 1.0 / 64.0)?;
        let mut carried = form.start(&start)?;
        for _ in 0..10 {
            form.advance(&mut carried, 7);
            let State { a1, a2, .. } = form.state(&carried);
            for ([sine, cosine], angle) in form.directions(&carried).into_iter().zip([a1, a2]) {
                let [along, across] = [
                    sine.to_f64() * angle.sin() + cosine.to_f64() * angle.cos(),
                    sine.to_f64() * angle.cos() - cosine.to_f64() * angle.sin(),
                ];
                assert!(across.abs() <= tolerances::DIRECTIONS * R::EPSILON.to_f64(), "{across:e} at {angle}");
                assert!((along - 1.0).abs() <= tolerances::LENGTHS, "{along} long at {angle}");
            }
        }
        Ok(())
    }
    for trial in [chaotic(1.0), unlike(1.0)] {
        agree::<f32, AngleForm<f32>>(&trial)?;
        agree::<f32, DirectionForm<f32>>(&trial)?;
        agree::<f64, AngleForm<f64>>(&trial)?;
        agree::<f64, DirectionForm<f64>>(&trial)?;
        agree::<f64, DirectionForm8<f64>>(&trial)?;
        agree::<f64, Fixed64Form<12>>(&trial)?;
    }
    Ok(())
}

#[test]
fn winding_counts_what_the_angle_form_counts() -> Result<(), Error> {
    let (parameters, start) = Trial::at_rest(2.75, 3.0, 3.0, 1.0).rounded::<f64>();
    let dt = 1.0 / 2048.0;
    let angle_form = AngleForm::<f64>::new(&parameters, dt)?;
    let direction_form = DirectionForm::<f64>::new(&parameters, dt)?;
    let (mut angles, mut direction) = (angle_form.start(&start)?, direction_form.start(&start)?);
    let mut windings = [Winding::new(start.a1), Winding::new(start.a2)];
    let mut most = 0.0_f64;
    for _ in 0..10 * 2048 {
        angle_form.advance(&mut angles, 1);
        direction_form.advance(&mut direction, 1);
        let directions = direction_form.directions(&direction);
        windings.iter_mut().zip(directions).for_each(|(winding, direction)| winding.observe(direction));
        let State { a1, a2, .. } = angle_form.state(&angles);
        for (winding, angle) in windings.iter().zip([a1, a2]) {
            assert!((winding.angle() - angle).abs() < 0.1, "{} turns, {angle} rad", winding.turns());
            most = most.max(angle.abs());
        }
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
        let expected = near.states::<f64, AngleForm<f64>>(1.0 / 256.0)?;
        let difference = largest_difference(&far.states::<f64, AngleForm<f64>>(1.0 / 256.0)?, &expected);
        assert!(difference <= tolerances::FAR_ANGLE[0], "{difference:e}");
        let difference = largest_difference(&far.states::<f64, DirectionForm<f64>>(1.0 / 256.0)?, &expected);
        assert!(difference <= tolerances::FAR_ANGLE[1], "{difference:e}");
    }
    Ok(())
}

#[test]
fn what_is_carried_is_small() {
    assert!(size_of::<AngleState<f32, Compensated<f32>>>() <= 128);
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
        let refused = AngleForm::<f32>::new(&good, dt);
        assert!(matches!(refused, Err(Error::OutOfRange { parameter: Parameter::Dt, .. })));
    }
    let refused = AngleForm::<f32>::new(&Parameters { m2: -1.0, ..good }, 0.01);
    assert!(matches!(refused, Err(Error::NotPositive { parameter: Parameter::M2, .. })));
    let refused = DirectionForm::<f32>::new(&Parameters { m1: 1e30, m2: 1e-30, ..good }, 0.01);
    assert!(matches!(refused, Err(Error::OutOfRange { .. })));

    let form = AngleForm::<f32>::new(&good, 0.01)?;
    let refused = form.start(&State::at_rest(f32::NAN, 0.0));
    assert!(matches!(refused, Err(Error::NotFinite { parameter: Parameter::A1, .. })));
    let refused = form.start(&State::at_rest(0.0, 1e7));
    assert!(matches!(refused, Err(Error::OutOfRange { parameter: Parameter::A2, .. })));
    let light = DirectionForm::<f32>::new(&Parameters { m2: 0.1, l2: 0.1, ..good }, 0.01)?;
    let refused = light.start(&State { p1: 3e38, ..State::at_rest(PI as f32, 0.0) });
    let value = f64::from(3e38_f32);
    assert!(
        matches!(refused, Err(Error::OutOfRange { parameter: Parameter::P1, value: named }) if (named / value - 1.0).abs() < 1e-6),
        "{refused:?}"
    );
    Ok(())
}
