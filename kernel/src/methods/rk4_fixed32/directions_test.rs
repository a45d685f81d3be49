use core::f64::consts::PI;

use super::{Fixed32, Units};
use crate::error::Error;
use crate::methods::Advance;
use crate::numbers::fixed::scaled;
use crate::pendulum::{Parameters, Pendulum, State};
use fastrand::Rng;

/// Returns the largest errors of rod 1 and of rod 2, in units of 2^-30.
fn largest_errors(rng: &mut Rng, low: f64, high: f64) -> Result<[f64; 2], Error> {
    let mut largest: [f64; 2] = [0.0; 2];
    for _ in 0..200 {
        let parameters = Parameters {
            m1: 1.0,
            m2: libm::pow(10.0, 2.0 * rng.f64() - 1.0),
            l1: low * libm::pow(high / low, rng.f64()),
            l2: 1.0,
            g: 9.81,
        };

        // No start at rest has more energy than upright rods.
        let upright = State::at_rest(PI, PI);
        let energy = Pendulum::new(&parameters)?.energy_above_rest(&upright);
        let units = Units::new(&parameters, energy, 1e-4)?;
        for _ in 0..2000 {
            let [a1, a2] = [rng.f64(), rng.f64()].map(|share| PI * (2.0 * share - 1.0));
            let mut motion = Fixed32::with_units(units, &State::at_rest(a1, a2));
            motion.advance(rng.u32(..8));

            let exact = motion.directions::<f64>();
            for (rod, direction) in motion.q30().into_iter().enumerate() {
                for (rounded, exact) in direction.into_iter().zip(exact[rod]) {
                    let error = f64::from(rounded) - scaled(exact, 30);
                    largest[rod] = largest[rod].max(error.abs());
                }
            }
        }
    }
    Ok(largest)
}

/// The errors are largest for l1/l2 slightly above 1/2.
#[test]
fn integer_directions_are_within_their_documented_bounds() -> Result<(), Error> {
    let mut rng = Rng::with_seed(6);
    for (low, high, bound, reached) in [
        (1.0, 1.0, 10.0, 8.0),
        (0.501, 0.502, 25.0, 20.0),
        (0.25, 4.0, 25.0, 12.0),
    ] {
        let [rod1, rod2] = largest_errors(&mut rng, low, high)?;
        assert!(
            rod1 <= 1.0,
            "l1/l2 from {low}: rod 1 is off by {rod1}, more than 1 unit"
        );
        assert!(
            reached < rod2 && rod2 <= bound,
            "l1/l2 from {low}: rod 2 is off by {rod2}, not between {reached} and {bound}"
        );
    }
    Ok(())
}
