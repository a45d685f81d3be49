//! Random pendulums with fixed seeds.

use double_pendulum::{Parameters, Pendulum, Real, State};
use fastrand::Rng;

pub fn log_uniform(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.f64())
}

pub fn symmetric(rng: &mut Rng) -> f64 {
    2.0 * rng.f64() - 1.0
}

/// Returns random parameters, rounded to `f32`.
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

/// Returns angles up to 2 pi, and momenta up to the bounds of the energy of turning over, as `f32`.
pub fn state(rng: &mut Rng, &Parameters { m1, m2, l1, l2, g }: &Parameters<f64>) -> State<f64> {
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

/// The numbers are the same in either precision.
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
