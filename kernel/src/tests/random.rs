//! Random pendulums for the property tests. The seeds are fixed, so that every run uses the same
//! pendulums.

use double_pendulum::{Parameters, Pendulum, Real, State};
use fastrand::Rng;

/// Returns a random number from `low` to below `high`, uniform in its logarithm. Both must be
/// positive, and `high` the larger one; this is not checked.
pub fn log_uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.f64())
}

/// Returns a random number from -1 to below 1, uniformly distributed.
pub fn symmetric(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

/// Returns random parameters, rounded to `f32`, each uniform in its logarithm: masses from 0.1 to
/// 10 kg, lengths from 0.3 to 3 m, and gravity from 1 to 20 m/s^2.
pub fn parameters(rng: &mut Rng) -> Parameters<f64> {
    let [m1, m2, l1, l2, g] = [
        (0.1, 10.0),
        (0.1, 10.0),
        (0.3, 3.0),
        (0.3, 3.0),
        (1.0, 20.0),
    ]
    .map(|(low, high)| f64::from(log_uniform(rng, low, high) as f32));
    Parameters { m1, m2, l1, l2, g }
}

/// Returns a random state, rounded to `f32`: angles from -2 pi to 2 pi rad, and momenta, kg m^2/s,
/// up to the bounds of the energy E = g ((m1 + m2) l1 + m2 l2): |p1| <= l1 sqrt(2 (m1 + m2) E) and
/// |p2| <= l2 sqrt(2 m2 E). All are uniformly distributed. The parameters must be valid, which is
/// not checked. Without gravity the momenta are 0.
pub fn state(rng: &mut Rng, &Parameters { m1, m2, l1, l2, g }: &Parameters<f64>) -> State<f64> {
    // The energy of turning over is about this.
    let energy = g * ((m1 + m2) * l1 + m2 * l2);
    let [p1, p2] = [
        l1 * (2.0 * (m1 + m2) * energy).sqrt(),
        l2 * (2.0 * m2 * energy).sqrt(),
    ];
    let turn = core::f64::consts::TAU;
    [turn, turn, p1, p2]
        .map(|most| f64::from((most * symmetric(rng)) as f32))
        .into()
}

/// Returns `count` pendulums of random [`parameters`], each with a random [`state`]. Equal seeds
/// give equal pendulums. The numbers are the same in either precision.
pub fn pendulums<R: Real>(seed: u64, count: u32) -> impl Iterator<Item = (Pendulum<R>, State<R>)> {
    let mut rng = Rng::with_seed(seed);
    (0..count).map(move |_| {
        let parameters = parameters(&mut rng);
        let state = state(&mut rng, &parameters).cast();
        (
            Pendulum::new(&parameters.cast()).expect("random parameters are valid"),
            state,
        )
    })
}
