//! A pendulum with friction in both joints: the crate's equations with two more terms, and its
//! general stepper.

use double_pendulum::{Error, Parameters, Pendulum, State, rk4};

/// Torque per angular velocity in both joints, N m s.
const FRICTION: f64 = 1.0;

fn main() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    // Joint 2, the elbow, turns at w2 - w1.
    let damped = |z: &[f64; 4]| {
        let [w1, w2, torque1, torque2] = pendulum.derivatives(z);
        let elbow = FRICTION * (w2 - w1);
        [w1, w2, torque1 - FRICTION * w1 + elbow, torque2 - elbow]
    };

    let mut state = State::at_rest(2.0, 2.0);
    for _ in 0..20 * 256 {
        state = State::from(rk4::step(damped, &state.into(), 1.0 / 256.0)).finite()?;
    }

    let left = pendulum.energy_above_rest(&state);
    println!(
        "after 20 s {left:.3} J of 41.7 J are left, at {:.3} and {:.3} rad",
        state.a1, state.a2
    );
    assert!(left < 2.0, "{left} J: of 41.7 J almost all is lost");
    Ok(())
}
