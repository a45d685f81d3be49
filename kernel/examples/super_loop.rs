//! A pendulum in a super-loop: one frame's worth of steps each time round, and a checkpoint from which the motion goes on,
//! to the bit, after a reset.

use double_pendulum::form::{DirectionForm, Stepper};
use double_pendulum::{Parameters, State};

type Motion = Stepper<f32, DirectionForm<f32>>;

/// Frames a second, and steps to a frame.
const RATE: u32 = 60;
const STEPS: u32 = 4;
const DT: f64 = 1.0 / (RATE * STEPS) as f64;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let pendulum = Parameters::equal_rods(1.0, 1.0, 9.81);
    let start = State::at_rest(2.0, 2.0);

    let mut motion = Motion::new(&pendulum, &start, DT)?;
    let mut backup = motion.save(); // 15 words; on a chip: in RAM that survives a reset, or in flash
    for frame in 1..=10 * RATE {
        motion.try_advance(STEPS)?; // refuses to leave the finite numbers, and keeps the last good motion
        let [[sin1, cos1], [sin2, cos2]] = motion.directions();
        let elbow = [sin1, -cos1];
        let _tip = [elbow[0] + sin2, elbow[1] - cos2]; // draw it here
        if frame == 5 * RATE {
            backup = motion.save();
        }
    }

    // The reset: the same program starts anew and finds the words.
    let mut resumed = Motion::new(&pendulum, &start, DT)?;
    resumed.restore(backup.as_ref())?;
    resumed.try_advance(5 * RATE * STEPS)?;
    assert_eq!(resumed, motion);
    println!("after 10 s, interrupted or not: {:?}", resumed.state());
    Ok(())
}
