//! The reference: the exact motion, to about 30 digits, by an independent road.
//!
//! Lagrange's two second-order equations (not Hamilton's), written anew from the book, as power series in time of order
//! 36 (not Runge-Kutta), in double-double arithmetic of 106 bits (not f32 or f64). Of the kernel it uses the plain
//! structures of numbers only.
//!
//! It is inside what the [enclosure](crate::enclosure) proves of random motions, the hard cases and the scenes, to 1e-31 times the growth
//! of a small error (tests `known_answers` and `motions`).

pub mod series;

use double_pendulum::{Motion, Parameters, State};
use twofloat::TwoFloat;

use series::{ORDER, Series, Wave, divide, sin_cos};

/// A double pendulum in exact motion, to about 30 digits.
///
/// Costs about 0.3 ms for each step of its own, of which a rod of 1 m needs 20 to 50 a second.
#[derive(Clone, Debug)]
pub struct Reference {
    parameters: Parameters<TwoFloat>,
    time: TwoFloat,
    angles: [TwoFloat; 2],
    velocities: [TwoFloat; 2],
}

impl Reference {
    /// Starts at time 0 from `motion`; every f64 given is taken as exact.
    pub fn new(parameters: &Parameters<f64>, motion: &Motion<f64>) -> Self {
        let (&Parameters { m1, m2, l1, l2, g }, &Motion { a1, a2, w1, w2 }) = (parameters, motion);
        let [m1, m2, l1, l2, g] = [m1, m2, l1, l2, g].map(TwoFloat::from);
        Self::exact(Parameters { m1, m2, l1, l2, g }, [a1, a2].map(TwoFloat::from), [w1, w2].map(TwoFloat::from))
    }

    /// As [`Reference::new`] from numbers of full precision: angles in rad, velocities in rad/s.
    pub fn exact(parameters: Parameters<TwoFloat>, angles: [TwoFloat; 2], velocities: [TwoFloat; 2]) -> Self {
        Self { parameters, time: 0.0.into(), angles, velocities }
    }

    /// Moves to time `t`, s; goes forward only, an earlier time changes nothing.
    pub fn advance_to(&mut self, t: f64) {
        while self.time < TwoFloat::from(t) {
            let motion = self.series();
            let rest = TwoFloat::from(t) - self.time;
            let longest = TwoFloat::from(longest_step(&motion));
            let last = longest >= rest;
            let step = if last { rest } else { longest };
            let [a1, a2, w1, w2] = motion.map(|series| series.at(step));
            self.angles = [a1, a2];
            self.velocities = [w1, w2];
            self.time = if last { t.into() } else { self.time + step };
        }
    }

    /// Angles and velocities now.
    pub fn motion(&self) -> Motion<f64> {
        let ([a1, a2], [w1, w2]) = (self.angles, self.velocities);
        Motion { a1: a1.into(), a2: a2.into(), w1: w1.into(), w2: w2.into() }
    }

    /// Angles and canonical momenta now.
    pub fn state(&self) -> State<f64> {
        self.exact_state().map(f64::from).into()
    }

    /// (sin a1, cos a1, sin a2, cos a2) now, in full precision.
    pub fn directions(&self) -> [TwoFloat; 4] {
        let [(sin1, cos1), (sin2, cos2)] = self.angles.map(sin_cos);
        [sin1, cos1, sin2, cos2]
    }

    /// (a1, a2, p1, p2) now, in full precision: p_i = dL/dw_i.
    pub fn exact_state(&self) -> [TwoFloat; 4] {
        let Parameters { m1, m2, l1, l2, .. } = self.parameters;
        let ([a1, a2], [w1, w2]) = (self.angles, self.velocities);
        let (_, cos_d) = sin_cos(a1 - a2);
        let p1 = (m1 + m2) * l1 * l1 * w1 + m2 * l1 * l2 * w2 * cos_d;
        let p2 = m2 * l2 * l2 * w2 + m2 * l1 * l2 * w1 * cos_d;
        [a1, a2, p1, p2]
    }

    /// The power series of a1, a2, w1, w2 about now.
    fn series(&self) -> [Series; 4] {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        let total = m1 + m2;
        let [mut a1, mut a2] = self.angles.map(Series::new);
        let [mut w1, mut w2] = self.velocities.map(Series::new);
        let mut d = Series::new(self.angles[0] - self.angles[1]);
        let (mut wave1, mut wave2, mut wave_d) = (Wave::new(&a1), Wave::new(&a2), Wave::new(&d));
        let [mut square1, mut square2, mut f1, mut f2, mut den] = [(); 5].map(|()| Series::default());
        let [mut acceleration1, mut acceleration2] = [(); 2].map(|()| Series::default());

        for k in 0..ORDER {
            wave1.extend(&a1, k);
            wave2.extend(&a2, k);
            wave_d.extend(&d, k);
            let Wave { sin: sin_d, cos: cos_d } = &wave_d;

            // (m1 + m2) l1 w1' + m2 l2 w2' cos D = f1,  l1 w1' cos D + l2 w2' = f2
            square1[k] = w1.product(&w1, k);
            square2[k] = w2.product(&w2, k);
            f1[k] = -m2 * l2 * square2.product(sin_d, k) - total * g * wave1.sin[k];
            f2[k] = l1 * square1.product(sin_d, k) - g * wave2.sin[k];
            den[k] = m2 * sin_d.product(sin_d, k);
            if k == 0 {
                den[0] += m1;
            }
            acceleration1[k] = acceleration1.quotient(divide(f1[k] - m2 * f2.product(cos_d, k), l1), &den, k);
            acceleration2[k] = acceleration2.quotient(divide(total * f2[k] - f1.product(cos_d, k), l2), &den, k);

            let next = (k + 1) as f64;
            a1[k + 1] = w1[k] / next;
            a2[k + 1] = w2[k] / next;
            d[k + 1] = a1[k + 1] - a2[k + 1];
            w1[k + 1] = acceleration1[k] / next;
            w2[k + 1] = acceleration2[k] / next;
        }
        [a1, a2, w1, w2]
    }
}

/// The states at `times` (s, ascending) of the motion that starts as `start`.
pub fn states(parameters: &Parameters<f64>, start: &Motion<f64>, times: &[f64]) -> Vec<State<f64>> {
    let mut reference = Reference::new(parameters, start);
    times
        .iter()
        .map(|&t| {
            reference.advance_to(t);
            reference.state()
        })
        .collect()
}

/// The least term of a series kept, relative to the rates of the motion.
const RESOLUTION: f64 = 1e-33;

/// The step at which the last terms of each series fall below the resolution of its value (A. Jorba, M. Zou, "A
/// software package for the numerical integration of ODEs by means of high-order Taylor methods", 2005). Four terms
/// are looked at, because a motion with a symmetry in time has only every second or fourth.
fn longest_step(motion: &[Series; 4]) -> f64 {
    let [a1, a2, w1, w2] = motion;
    let magnitude = |x: TwoFloat| f64::from(x).abs();
    let rate = magnitude(w1[0]).max(magnitude(w2[0])).max(1.0);
    let limit = |series: &Series, scale: f64, k: usize| {
        let last = magnitude(series[k]).max(f64::MIN_POSITIVE);
        (RESOLUTION * scale / last).powf(1.0 / k as f64)
    };
    (ORDER - 3..=ORDER)
        .flat_map(|k| [limit(a1, 1.0, k), limit(a2, 1.0, k), limit(w1, rate, k), limit(w2, rate, k)])
        .fold(f64::INFINITY, f64::min)
}
