//! Which form, and which step? First by bounds that hold for every motion of an energy, then by trying the step.

use double_pendulum::methods::{DirectionForm, ExtrapolatedForm, Form, Stepper};
use double_pendulum::{Error, Parameters, Pendulum, Real, State};

/// For how long the motion is wanted, s.
const SECONDS: u32 = 10;

fn main() -> Result<(), Error> {
    let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
    let start = State::at_rest(0.5, 0.5);
    let pendulum = Pendulum::new(parameters)?;

    // Beyond this step RK4 is of no use, whatever the motion: refuse it.
    let coarse = 1.0_f64;
    assert!(matches!(pendulum.check_step(coarse), Err(Error::TooLarge { .. })));
    // Up to this one it resolves every motion of the energy. Take a whole number of steps a second that is as fine.
    let admissible: f64 = pendulum.admissible_step(&start)?;
    let rate = (1.0 / admissible).ceil() as u32;
    println!("admissible: {admissible:.5} s, so {rate} steps a second");
    // No rod can turn over: its angles need no unwrapping.
    assert!(pendulum.cannot_turn_over(&start));

    // The truth to hold the others against: order 16 in f64, twice as fine as it needs to be.
    let exact = end::<f64, ExtrapolatedForm<16>>(&parameters, &start, 16)?;
    let error = |state: State<f64>| (state.a1 - exact.a1).abs().max((state.a2 - exact.a2).abs());
    let direction = error(end::<f32, DirectionForm<f32>>(&parameters, &start, rate)?);
    let finer = error(end::<f32, DirectionForm<f32>>(&parameters, &start, 2 * rate)?);
    let order12 = error(end::<f64, ExtrapolatedForm<12>>(&parameters, &start, 7)?);
    println!("direction form, f32, {rate} steps a second: {direction:.1e} rad");
    println!("direction form, f32, {} steps a second: {finer:.1e} rad", 2 * rate);
    println!("order 12, f64, 7 steps a second: {order12:.1e} rad");
    assert!(direction < 1e-4 && finer < direction && order12 < 1e-9);
    Ok(())
}

/// The state at the end in the form `F`, its numbers rounded to `R`.
fn end<R: Real, F: Form<R>>(parameters: &Parameters<f64>, start: &State<f64>, rate: u32) -> Result<State<f64>, Error> {
    let mut motion = Stepper::<R, F>::new(&parameters.cast(), &start.cast(), 1.0 / f64::from(rate))?;
    motion.try_advance(SECONDS * rate)?;
    Ok(motion.state())
}
