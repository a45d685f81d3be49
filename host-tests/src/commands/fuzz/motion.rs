//! The kernel on any bit patterns: parameters are refused or good for every method, steps are finite or refused.

use double_pendulum::form::{DirectionForm, ExtrapolatedForm, Form, Plain, Stepper};
use double_pendulum::{EqualRods, Error, Modes, Parameters, Pendulum, Real, State, Units};

use super::Outcome;
use super::input::Input;

/// Steps are made this often at most, so that an execution stays short.
const MOST_STEPS: u8 = 12;

pub fn refusal(error: &Error) -> Outcome {
    let kind = match error {
        Error::NotFinite { .. } => 1,
        Error::NotPositive { .. } => 2,
        Error::Negative { .. } => 3,
        Error::TooLarge { .. } => 4,
        Error::TooSmall { .. } => 5,
        Error::UnequalRods { .. } => 6,
        Error::OutOfRange { .. } => 7,
        Error::Diverged { .. } => 8,
        _ => 9,
    };
    assert!(!error.to_string().is_empty());
    0x100 * kind + error.parameter() as u32
}

fn rounded<R: Real>([m1, m2, l1, l2, g]: [f64; 5]) -> Parameters<R> {
    Parameters { m1, m2, l1, l2, g }.cast()
}

/// Every constructor on five numbers, a step and a state.
pub fn parameters(input: &[u8]) -> Outcome {
    let mut input = Input(input);
    let (numbers, [dt], state, single) = (input.numbers(), input.numbers(), input.numbers(), input.byte() & 1 != 0);
    let outcome = if single { constructed::<f32>(numbers, dt, state) } else { constructed::<f64>(numbers, dt, state) };
    outcome + if single { 0x8000 } else { 0 }
}

fn constructed<R: Real>(numbers: [f64; 5], dt: f64, state: [f64; 4]) -> Outcome {
    let parameters = rounded::<R>(numbers);
    let _ = (Units::of(&parameters), EqualRods::<R>::new(parameters.mass_ratio()));
    let modes = Modes::new(&parameters);
    if let Ok(modes) = modes {
        let frequencies = [modes.fast.frequency, modes.slow.frequency];
        assert!(frequencies.iter().all(|w| w.is_finite() && *w > R::ZERO), "{frequencies:?} of {parameters:?}");
    }
    let pendulum = match Pendulum::new(parameters) {
        Ok(pendulum) => pendulum,
        Err(error) => return refusal(&error),
    };
    // Hanging still is a motion of every pendulum, and it stays one.
    let still = State::at_rest(R::ZERO, R::ZERO);
    assert_eq!(pendulum.derivatives(&still.into()), [R::ZERO; 4], "{parameters:?}");
    let state = State::from(state).cast::<R>();
    let _ = (
        pendulum.bounds(&state),
        pendulum.energy(&state),
        pendulum.to_motion(&state),
        pendulum.positions(state.angles()),
    );
    let _ = (pendulum.cannot_turn_over(&state), pendulum.least_energy(), pendulum.turnover_energy());
    match pendulum.check_step(dt) {
        Ok(()) => 0x10 + u32::from(modes.is_ok()),
        Err(error) => 0x4000 + refusal(&error),
    }
}

/// Every stepper on five numbers, a step and a state: twelve steps at most, each finite or refused.
pub fn steppers(input: &[u8]) -> Outcome {
    let mut input = Input(input);
    let (numbers, [dt], state) = (input.numbers(), input.numbers(), input.numbers());
    let (kind, steps) = (input.byte() % 7, input.byte() % MOST_STEPS + 1);
    let stepped = match kind {
        0 => plain::<f32>(numbers, dt, state, steps),
        1 => plain::<f64>(numbers, dt, state, steps),
        2 => equal::<f32>(numbers, dt, state, steps),
        3 => form::<f32, DirectionForm<f32>>(numbers, dt, state, steps),
        4 => form::<f64, DirectionForm<f64>>(numbers, dt, state, steps),
        5 => form::<f32, DirectionForm<f32, Plain>>(numbers, dt, state, steps),
        _ => form::<f64, ExtrapolatedForm<12>>(numbers, dt, state, steps),
    };
    u32::from(kind) * 0x10000 + stepped.map_or_else(|error| refusal(&error), |()| 0x10)
}

fn plain<R: Real>(numbers: [f64; 5], dt: f64, state: [f64; 4], steps: u8) -> Result<(), Error> {
    let pendulum = Pendulum::new(rounded::<R>(numbers))?;
    let mut state = State::from(state).cast();
    pendulum.check_step(dt)?;
    state.check()?;
    for _ in 0..steps {
        state = pendulum.step(&state, R::from_f64(dt)).finite()?;
        assert_eq!(state.check(), Ok(()));
    }
    Ok(())
}

fn equal<R: Real>(numbers: [f64; 5], dt: f64, state: [f64; 4], steps: u8) -> Result<(), Error> {
    let parameters = rounded::<R>(numbers);
    let (units, rods) = (Units::of(&parameters)?, EqualRods::<R>::new(parameters.mass_ratio())?);
    let mut state = State::from(state).cast();
    state.check()?;
    state = units.from_si(&state).finite()?;
    for _ in 0..steps {
        state = rods.step(&state, R::from_f64(dt) / units.time).finite()?;
    }
    units.to_si(&state).finite().map(drop)
}

fn form<R: Real, F: Form<R>>(numbers: [f64; 5], dt: f64, state: [f64; 4], steps: u8) -> Result<(), Error> {
    let mut stepper = Stepper::<R, F>::new(&rounded(numbers), &State::from(state).cast(), dt)?;
    for _ in 0..steps {
        stepper.try_advance(1)?;
        assert_eq!(stepper.state().check(), Ok(()));
        let numbers = stepper.directions();
        assert!(numbers.as_flattened().iter().all(|number| number.is_finite()), "{numbers:?}");
    }
    Ok(())
}

/// Good ones, for every stepper.
pub fn seeds() -> Vec<Vec<u8>> {
    let numbers = [1.0, 2.0, 1.0, 1.0, 9.8, 1.0 / 256.0, 2.0, -1.0, 0.5, -0.25];
    let bytes: Vec<u8> = numbers.iter().flat_map(|number: &f64| number.to_le_bytes()).collect();
    (0..7).map(|kind| bytes.iter().copied().chain([kind, 4]).collect()).collect()
}
