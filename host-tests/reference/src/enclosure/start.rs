//! A pendulum and its start, enclosed.

use double_pendulum::{Bounds, Motion, Parameters, Pendulum};

use super::equations::Constants;
use super::fixed::Fixed;
use super::set::{Enclosure, Fineness};

/// A number as it was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// Of `f64`, exactly.
    Binary(f64),
    /// A numerator over a denominator.
    Fraction(i64, u64),
}

impl Given {
    /// Times 2^`exponent`.
    fn fixed(self, exponent: i32) -> Fixed {
        match self {
            Self::Binary(number) => Fixed::of(number * f64::from(exponent).exp2()),
            Self::Fraction(numerator, denominator) => Fixed::fraction(numerator, denominator, exponent),
        }
    }
}

/// A pendulum and how it starts: m1, m2; l1, l2; g; a1, a2; w1, w2. SI units, or degrees.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// All of it, each number rounded.
    pub about: (Parameters<f64>, Motion<f64>),
    /// All of it.
    pub given: [Given; 9],
    /// Whether the angles and the velocities are in degrees.
    pub degrees: [bool; 2],
}

impl Start {
    /// Every number as it is in `f64`.
    pub fn of(parameters: &Parameters<f64>, motion: &Motion<f64>) -> Self {
        let (&Parameters { m1, m2, l1, l2, g }, &Motion { a1, a2, w1, w2 }) = (parameters, motion);
        let given = [m1, m2, l1, l2, g, a1, a2, w1, w2].map(Given::Binary);
        Self { about: (*parameters, *motion), given, degrees: [false; 2] }
    }

    /// The set that the motion starts in, with `rate` frames to a second.
    ///
    /// The unit of time is so short that nothing turns by more than 4 rad, and 2^e is near the root of (m1 + m2)/m1: so the equations'
    /// numbers are neither large nor small, for masses and lengths within a factor of 1000 and 30 of each other.
    pub fn enclose(&self, rate: u16, fineness: Fineness) -> Enclosure {
        let (parameters, motion) = self.about;
        let fastest = Pendulum::new(&parameters).map_or(1.0, |pendulum| {
            let Bounds { w1, w2, .. } = pendulum.bounds(&pendulum.to_state(&motion));
            pendulum.modes().map_or(0.0, |modes| modes.fast.frequency).max(w1).max(w2)
        });
        let unit = (fastest / UNIT).log2().ceil() as i32;
        let e = (0.5 * (1.0 + parameters.m2 / parameters.m1).log2()).clamp(0.0, 7.0).round() as i32;
        let [m1, m2, l1, l2, g, a1, a2, w1, w2] = self.given;
        let [by, by1, by2] = [parameters.m1.max(parameters.m2), parameters.l1, parameters.l2].map(|x| x.log2() as i32);

        let total = (m1.fixed(-by) + m2.fixed(-by)).inverse();
        let [upper, lower] = [m1, m2].map(|m| m.fixed(e - by) * total);
        let [over_l1, over_l2] = [l1.fixed(-by1), l2.fixed(-by2)].map(Fixed::inverse);
        let (rods, coupling) = (l1.fixed(-by2) * over_l2, lower * l2.fixed(-by1) * over_l1);
        let gravity = [g.fixed(e - 2 * unit - by1) * over_l1, g.fixed(-2 * unit - by2) * over_l2];

        let radians = |x: Fixed, degrees: bool| if degrees { x.over(180) * pi() } else { x };
        let [a1, a2] = [a1, a2].map(|a| radians(a.fixed(0), self.degrees[0]));
        let [w1, w2] = [w1, w2].map(|w| radians(w.fixed(-unit), self.degrees[1]));
        let ([sin1, cos1], [s, c]) = (sin_cos(a1), sin_cos(a1 - a2));
        let start = [sin1, cos1, s, c, (upper + lower) * w1 + coupling * c * w2, w2 + rods * c * w1];
        Enclosure::new(Constants { upper, lower, rods, coupling, gravity }, (unit, rate), start, fineness)
    }
}

/// The most that anything may turn by in a unit of time, rad.
const UNIT: f64 = 4.0;

/// pi: 3.14159 26535 89793 238 and 46264 33832 79502 884 behind that, and less than 1e-36 more.
fn pi() -> Fixed {
    const PLACES: u64 = 1_000_000_000_000_000_000;
    let [first, last] = [3_141_592_653_589_793_238, 462_643_383_279_502_884].map(|x| Fixed::fraction(x, PLACES, 0));
    (first + last * Fixed::fraction(1, PLACES, 0)).wider(1e-36)
}

/// The sine and the cosine.
///
/// Theorem (Leibniz): what an alternating series with falling terms lacks is less than the last term added. Terms fall from the fifth on,
/// |x| being below 4 when whole turns are taken away.
pub fn sin_cos(angle: Fixed) -> [Fixed; 2] {
    let turn = pi() + pi();
    let x = angle - turn * Fixed::of((angle.about() / turn.about()).round());
    let square = x * x;
    [(x, 1), (Fixed::ONE, 0)].map(|(first, power)| {
        let (mut sum, mut term) = (first, first);
        for power in (power..64_u32).step_by(2) {
            term = Fixed::ZERO - (term * square).over((power + 1) * (power + 2));
            sum = sum + term;
        }
        sum.wider(term.size())
    })
}
