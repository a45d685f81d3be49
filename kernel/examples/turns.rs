//! Angles with all their turns, by a method that carries directions: a pendulum let go nearly
//! upright.

use double_pendulum::{Error, ExtrapolationF64, Parameters, Pendulum, State};

fn main() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters {
        m1: 1.0,
        m2: 2.75,
        l1: 1.0,
        l2: 1.0,
        g: 9.81,
    })?;
    let start = State::at_rest(3.0, 3.0);
    let mut run = pendulum
        .run::<ExtrapolationF64<12>>(&start, 1.0 / 256.0)?
        .counting_turns();
    let mut most: f64 = 0.0;
    for _ in 0..10 {
        run.advance(256)?;
        let [a1, a2] = run.angles();
        println!(
            "{} s: {a1:.3} and {a2:.3} rad, {:.9} J",
            run.time(),
            run.energy()
        );
        most = most.max(a1.abs()).max(a2.abs());
    }

    assert!(most > core::f64::consts::TAU, "a rod has turned over");
    assert!((run.energy() - pendulum.energy(&start)).abs() < 1e-9);
    Ok(())
}
