//! A pendulum in a super-loop: one frame's worth of steps each time round.

use double_pendulum::methods::{DirectionForm, Stepper};
use double_pendulum::{Error, Parameters, State};

/// Frames a second, and steps to a frame.
const RATE: u32 = 60;
const STEPS: u32 = 4;
const DT: f64 = 1.0 / (RATE * STEPS) as f64;

fn main() -> Result<(), Error> {
    let pendulum = Parameters::equal_rods(1.0, 1.0, 9.81);
    let mut motion = Stepper::<f32, DirectionForm<f32>>::new(&pendulum, &State::at_rest(2.0, 2.0), DT)?;
    for _frame in 0..10 * RATE {
        motion.try_advance(STEPS)?; // refuses to leave the finite numbers, and keeps the last good motion
        let [[sin1, cos1], [sin2, cos2]] = motion.directions();
        let elbow = [sin1, -cos1];
        let _tip = [elbow[0] + sin2, elbow[1] - cos2]; // draw it here
    }
    println!("after 10 s: {:?}", motion.state());
    Ok(())
}
