//! A motion saved, restored and gone on with is the motion that was never interrupted, to the bit.

use double_pendulum::form::{
    AngleForm, Compensated, DirectionForm, DirectionForm8, Divided, Form, Plain, RestoreError, Stepper,
    UnwrappedStepper,
};
use double_pendulum::{Error, Parameters, Real, State};

const DT: f64 = 1.0 / 240.0;
const STEPS: u32 = 500;

fn parameters<R: Real>() -> Parameters<R> {
    Parameters { m1: 1.0, m2: 2.0, l1: 1.0, l2: 0.75, g: 9.81 }.cast()
}

/// Chaotic: it turns over, and every bit matters.
fn stepper<R: Real, F: Form<R>>() -> Result<Stepper<R, F>, Error> {
    Stepper::new(&parameters(), &State::at_rest(3.0, 2.5).cast(), DT)
}

fn words<R: Real, F: Form<R>>(stepper: &Stepper<R, F>) -> Vec<u64> {
    stepper.save().as_ref().to_vec()
}

/// Split after no step, after one, where lengths are restored and just beside, and anywhere else.
fn a_split_changes_nothing<R: Real, F: Form<R>>() -> Result<(), Box<dyn core::error::Error>> {
    let mut whole = stepper::<R, F>()?;
    whole.advance(STEPS);
    for split in [0, 1, 31, 32, 33, 64, 250, STEPS] {
        let mut first = stepper::<R, F>()?;
        first.advance(split);
        let saved = words(&first);
        let mut second = stepper::<R, F>()?;
        second.restore(&saved)?;
        assert_eq!(second, first);
        second.advance(STEPS - split);
        assert_eq!(words(&second), words(&whole), "split after {split} steps");
        assert_eq!((second, second.state()), (whole, whole.state()));
    }
    Ok(())
}

/// Every change of one word, a word more or less, and what another step, pendulum or form has saved.
fn what_was_not_saved_here_is_refused<R: Real, F: Form<R>>(
    others: &[Vec<u64>],
) -> Result<(), Box<dyn core::error::Error>> {
    let mut motion = stepper::<R, F>()?;
    motion.advance(100);
    let (before, saved) = (motion, words(&motion));
    for place in 0..saved.len() {
        for change in [1, 1 << 22, 1 << 31, 1 << 32, 1 << 63, u64::MAX] {
            let mut damaged = saved.clone();
            damaged[place] ^= change;
            assert_eq!(motion.restore(&damaged), Err(RestoreError::NotSavedHere), "word {place}, {change:x}");
        }
    }
    let expected = saved.len();
    for wrong in [&saved[..0], &saved[1..], &[&saved[..], &[0]].concat()[..]] {
        let refused = RestoreError::WrongLength { words: wrong.len(), expected };
        assert_eq!(motion.restore(wrong), Err(refused));
    }
    let mut longer = Stepper::<R, F>::new(&parameters(), &State::at_rest(3.0, 2.5).cast(), 2.0 * DT)?;
    longer.advance(100);
    let heavier = Parameters { m2: R::from_f64(2.5), ..parameters() };
    let mut heavier = Stepper::<R, F>::new(&heavier, &State::at_rest(3.0, 2.5).cast(), DT)?;
    heavier.advance(100);
    for other in others.iter().chain([&words(&longer), &words(&heavier)]) {
        assert!(*other == saved || motion.restore(other).is_err());
    }
    assert_eq!(motion, before, "it stays as it was");
    Ok(())
}

/// `$call` for every form, sum and precision.
macro_rules! for_every_form {
    ($call:ident $arguments:tt) => {
        $call::<f32, AngleForm<f32>> $arguments?;
        $call::<f32, AngleForm<f32, Plain>> $arguments?;
        $call::<f64, AngleForm<f64>> $arguments?;
        $call::<f64, AngleForm<f64, Plain>> $arguments?;
        $call::<f32, DirectionForm<f32>> $arguments?;
        $call::<f32, DirectionForm<f32, Plain>> $arguments?;
        $call::<f32, DirectionForm<f32, Compensated<f32>, Divided>> $arguments?;
        $call::<f64, DirectionForm<f64>> $arguments?;
        $call::<f64, DirectionForm<f64, Plain, Divided>> $arguments?;
        $call::<f64, DirectionForm8<f64>> $arguments?;
        $call::<f64, DirectionForm8<f64, Plain>> $arguments?;
    };
}

#[test]
fn every_form_goes_on_to_the_bit() -> Result<(), Box<dyn core::error::Error>> {
    for_every_form!(a_split_changes_nothing());
    Ok(())
}

#[test]
fn every_form_refuses_what_it_has_not_saved() -> Result<(), Box<dyn core::error::Error>> {
    let mut others = Vec::new();
    fn other<R: Real, F: Form<R>>(others: &mut Vec<Vec<u64>>) -> Result<(), Error> {
        let mut motion = stepper::<R, F>()?;
        motion.advance(100);
        others.push(words(&motion));
        Ok(())
    }
    for_every_form!(other(&mut others));
    for_every_form!(what_was_not_saved_here_is_refused(&others));
    Ok(())
}

#[test]
fn turns_are_saved_beside_the_motion() -> Result<(), Box<dyn core::error::Error>> {
    type Unwrapped = UnwrappedStepper<f32, DirectionForm<f32>>;
    let start = || Unwrapped::new(&parameters(), &State { p1: 40.0, ..State::at_rest(3.0, 2.5) }, DT);
    let mut whole = start()?;
    whole.advance(STEPS);
    let (saved, turns) = whole.save();
    assert_ne!(turns, [0, 0], "it turns over");
    let mut resumed = start()?;
    resumed.restore(saved.as_ref(), turns)?;
    for motion in [&mut whole, &mut resumed] {
        motion.advance(STEPS);
    }
    assert_eq!((resumed, resumed.state()), (whole, whole.state()));
    Ok(())
}

/// The form with it: nothing needs to be prepared anew.
#[cfg(feature = "serde")]
#[test]
fn serde_keeps_every_bit() -> Result<(), Box<dyn core::error::Error>> {
    fn round_trip<R: Real, F: Form<R>>() -> Result<(), Box<dyn core::error::Error>>
    where
        Stepper<R, F>: serde::Serialize + serde::de::DeserializeOwned,
    {
        let mut motion = stepper::<R, F>()?;
        motion.advance(100);
        let mut buffer = [0; 512];
        let mut same: Stepper<R, F> = postcard::from_bytes(postcard::to_slice(&motion, &mut buffer)?)?;
        motion.advance(100);
        same.advance(100);
        assert_eq!(words(&same), words(&motion));
        Ok(())
    }
    for_every_form!(round_trip());
    Ok(())
}
