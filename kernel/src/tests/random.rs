//! Random pendulums for the property tests: fixed seeds, so that every run sees the same ones.

use double_pendulum::{Parameters, State};
use fastrand::Rng;

/// A number between `low` and `high`, evenly spread in its logarithm.
pub fn log_uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.f64())
}

/// A number between -1 and 1.
pub fn symmetric(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

/// Masses within a factor of 100 of each other, lengths within a factor of 10, 1 to 20 m/s^2, rounded to `f32`.
pub fn parameters(rng: &mut Rng) -> Parameters<f64> {
    let rounded = |x: f64| f64::from(x as f32);
    Parameters {
        m1: rounded(log_uniform(rng, 0.1, 10.0)),
        m2: rounded(log_uniform(rng, 0.1, 10.0)),
        l1: rounded(log_uniform(rng, 0.3, 3.0)),
        l2: rounded(log_uniform(rng, 0.3, 3.0)),
        g: rounded(log_uniform(rng, 1.0, 20.0)),
    }
}

/// Any angles within one turn either way, and momenta of the order of those gravity can give; rounded to `f32`.
pub fn state(rng: &mut Rng, &Parameters { m1, m2, l1, l2, g }: &Parameters<f64>) -> State<f64> {
    let energy = g * ((m1 + m2) * l1 + m2 * l2);
    let turn = core::f64::consts::TAU;
    [
        turn * symmetric(rng),
        turn * symmetric(rng),
        l1 * (2.0 * (m1 + m2) * energy).sqrt() * symmetric(rng),
        l2 * (2.0 * m2 * energy).sqrt() * symmetric(rng),
    ]
    .map(|x| f64::from(x as f32))
    .into()
}
