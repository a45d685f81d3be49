//! A loop of frames: each round advances the motion by one frame.

use double_pendulum::{DirectionF32, Error, Parameters, Pendulum, State};

const RATE: u32 = 60;
const STEPS: u32 = 4;

fn main() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    let mut run =
        pendulum.run::<DirectionF32>(&State::at_rest(2.0, 2.0), 1.0 / f64::from(RATE * STEPS))?;

    for _frame in 0..10 * RATE {
        run.advance(STEPS)?; // a motion that diverges is an error
        let [[sin1, cos1], [sin2, cos2]] = run.directions();
        let elbow = [sin1, -cos1];
        let _tip = [elbow[0] + sin2, elbow[1] - cos2]; // draw it here
    }
    println!("after {} s: {:?}", run.time(), run.state());
    Ok(())
}
