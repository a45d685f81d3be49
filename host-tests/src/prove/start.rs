//! A pendulum and its start, enclosed.

use double_pendulum::{Bounds, Motion, Parameters, Pendulum};

use super::enclosure::{Enclosure, Fineness};
use super::equations::Constants;
use super::fixed::Fixed;
use super::number::Number;

/// A number as it was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// Of `f64`, exactly.
    Binary(f64),
    /// A numerator over a denominator.
    Fraction(i128, u64),
}

impl Given {
    /// By 2^`halvings`.
    pub fn fixed(self, halvings: u32) -> Fixed {
        match self {
            Self::Binary(number) => Fixed::of(number / 2_f64.powi(halvings as i32)),
            Self::Fraction(numerator, denominator) => Fixed::fraction(numerator, denominator, halvings),
        }
    }

    /// The `f64` next to it, or next to that.
    pub fn about(self) -> f64 {
        match self {
            Self::Binary(number) => number,
            Self::Fraction(numerator, denominator) => numerator as f64 / denominator as f64,
        }
    }
}

/// How often the larger of these is to be halved to be below 128, up to 63 times.
fn halvings(numbers: &[Given]) -> u32 {
    let fits = |by: &u32| numbers.iter().all(|number| number.about().abs() < 128.0 * 2_f64.powi(*by as i32));
    (0..63).find(fits).unwrap_or(63)
}

/// A pendulum and how it starts. SI units, or degrees.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// m1 and m2.
    pub masses: [Given; 2],
    /// l1 and l2.
    pub lengths: [Given; 2],
    /// g.
    pub gravity: Given,
    /// a1 and a2, and whether in degrees.
    pub angles: ([Given; 2], bool),
    /// w1 and w2, and whether in degrees per second.
    pub velocities: ([Given; 2], bool),
}

impl Start {
    /// Every number as it is in `f64`.
    pub fn of(&Parameters { m1, m2, l1, l2, g }: &Parameters<f64>, &Motion { a1, a2, w1, w2 }: &Motion<f64>) -> Self {
        let [masses, lengths, angles, velocities] =
            [[m1, m2], [l1, l2], [a1, a2], [w1, w2]].map(|x| x.map(Given::Binary));
        Self { masses, lengths, gravity: Given::Binary(g), angles: (angles, false), velocities: (velocities, false) }
    }

    /// How often masses are to be halved for their sum to be below 2.
    pub fn halvings(&self) -> u32 {
        halvings(&self.masses) + 7
    }

    /// All of it in `f64`, rounded twice at most.
    fn about(&self) -> (Parameters<f64>, Motion<f64>) {
        let [[m1, m2], [l1, l2]] = [self.masses, self.lengths].map(|x| x.map(Given::about));
        let [[a1, a2], [w1, w2]] = [self.angles, self.velocities]
            .map(|(x, degrees)| x.map(|x| if degrees { x.about().to_radians() } else { x.about() }));
        (Parameters { m1, m2, l1, l2, g: self.gravity.about() }, Motion { a1, a2, w1, w2 })
    }

    /// The fastest rate in the motion, 1/s: the fast normal frequency or the greatest angular velocity.
    fn fastest_rate(&self) -> f64 {
        let (parameters, motion) = self.about();
        let Ok(pendulum) = Pendulum::<f64>::new(&parameters) else { return 1.0 };
        let Bounds { w1, w2, .. } = pendulum.bounds(&pendulum.to_state(&motion));
        pendulum.modes().map_or(0.0, |modes| modes.fast.frequency).max(w1).max(w2)
    }

    /// The set that the motion starts in, with `rate` frames to a second.
    ///
    /// The unit of time is a frame by a power of two in which nothing turns by more than [`UNIT`], and 2^e is near the root of (m1 + m2)/m1: so
    /// the equations' numbers are neither large nor small, for masses and lengths within a factor of 1000 and 30 of each other.
    pub fn enclose(&self, rate: u16, fineness: Fineness) -> Enclosure {
        let unit = (UNIT * f64::from(rate) / self.fastest_rate()).log2().floor().clamp(-15.0, 15.0) as i32;
        let by_unit = |x: Fixed| {
            let (longer, shorter) = (unit.max(0) as u32, unit.min(0).unsigned_abs());
            x.over(u32::from(rate) << shorter) << longer
        };
        let [[m1, m2], [l1, l2]] = [self.masses, self.lengths].map(|pair| pair.map(|x| x.fixed(halvings(&pair))));
        let total = (m1 + m2).inverse();
        let (rods, upper, lower) = (l1 * l2.inverse(), m1 * total, m2 * total);
        let coupling = lower * l2 * l1.inverse();
        let [by_gravity, by_lengths] = [halvings(&[self.gravity]), halvings(&self.lengths)];
        let gravity = self.gravity.fixed(by_gravity);
        let [gravity1, gravity2] =
            [l1, l2].map(|l| (by_unit(by_unit(gravity) * l.inverse()) >> by_lengths) << by_gravity);

        let radians = |x: Fixed, degrees: bool| if degrees { x.over(180) * pi() } else { x };
        let [a1, a2] = self.angles.0.map(|angle| radians(angle.fixed(0), self.angles.1));
        let by = halvings(&self.velocities.0);
        let [w1, w2] = self.velocities.0.map(|w| by_unit(radians(w.fixed(by), self.velocities.1)) << by);
        let ([sin1, cos1], [s, c]) = (sin_cos(a1), sin_cos(a1 - a2));

        let e = (-0.5 * upper.ball().middle.log2()).round().clamp(0.0, 15.0) as u32;
        let start = [sin1, cos1, s, c, (w1 + coupling * c * w2) << e, w2 + rods * c * w1];
        let [upper, lower, coupling, gravity1] = [upper, lower, coupling, gravity1].map(|x| x << e);
        Enclosure::new(Constants { upper, lower, rods, coupling, gravity: [gravity1, gravity2] }, unit, start, fineness)
    }
}

/// The most that anything may turn by in a unit of time, rad.
const UNIT: f64 = 4.0;

/// pi: 3.14159 26535 89793 2384 and 62643 38327 95028 8419 behind that, and less than 1e-38 more.
pub fn pi() -> Fixed {
    const PLACES: u64 = 10_000_000_000_000_000_000;
    let [first, last] = [31_415_926_535_897_932_384, 6_264_338_327_950_288_419].map(|x| Fixed::fraction(x, PLACES, 0));
    (first + last * Fixed::fraction(1, PLACES, 0)).wider(1e-38)
}

/// The sine and the cosine.
///
/// Theorem (Leibniz): what an alternating series with falling terms lacks is less than the last term added. Terms fall from the fifth on,
/// |x| being below 4 when whole turns are taken away.
pub fn sin_cos(angle: Fixed) -> [Fixed; 2] {
    let turn = pi() + pi();
    let x = angle - turn * Fixed::of((angle.ball().middle / turn.ball().middle).round());
    let square = x * x;
    [(x, 1), (Fixed::ONE, 0)].map(|(first, power)| {
        let (mut sum, mut term) = (first, first);
        for power in (power..64_u32).step_by(2) {
            term = Fixed::ZERO - (term * square).over((power + 1) * (power + 2));
            sum = sum + term;
        }
        sum.wider(term.ball().size())
    })
}
