//! Fixed point, for a Cortex-M0+: the loop takes and returns only integers, and needs no soft
//! float.

use double_pendulum::{Error, Fixed32, Parameters, Pendulum, State};

/// Pixels to a rod of 1 m.
const ROD: i32 = 15;

fn main() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    let mut run = pendulum.run::<Fixed32>(&State::at_rest(2.0, 2.0), 1.0 / 240.0)?;

    for _frame in 0..600 {
        run.advance(4)?;
        // The directions are in units of 2^-30.
        let [elbow, rod2] = run
            .directions_q30()
            .map(|[sin, cos]| [sin, cos].map(pixels));
        let tip = [elbow[0] + rod2[0], elbow[1] + rod2[1]]; // to the right and down: draw it here
        assert!(tip.iter().all(|part| part.abs() <= 2 * ROD));
    }
    println!("after {} s: {:?}", run.time(), run.state());
    Ok(())
}

fn pixels(part: i32) -> i32 {
    ((i64::from(part) * i64::from(ROD)) >> 30) as i32
}
