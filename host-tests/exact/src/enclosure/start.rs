//! The set of starts of a pendulum's motion.

use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;

use double_pendulum::{Bounds, Motion, Parameters, Pendulum, sin_cos as kernel_sin_cos};

use super::equations::Equations;
use super::fixed::Fixed;
use super::{Enclosure, Fineness};

/// The fast normal frequency, or the largest angular velocity that the energy allows.
pub fn fastest_rate(parameters: &Parameters<f64>, motion: &Motion<f64>) -> f64 {
    Pendulum::new(parameters).map_or(1.0, |pendulum| {
        let Bounds { w1, w2, .. } = pendulum.bounds(&pendulum.to_state(motion));
        pendulum
            .modes()
            .map_or(0.0, |modes| modes.fast.frequency)
            .max(w1)
            .max(w2)
    })
}

#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Rounded to `f64`.
    pub about: (Parameters<f64>, Motion<f64>),
    /// The exact numbers, if they were not given in `f64`: numerators and denominators of a1, a2;
    /// w1, w2; m1, m2; l1, l2; g.
    pub fractions: Option<[(i64, u64); 9]>,
    /// True if the angles (first) and the velocities (second) of the fractions are in degrees.
    pub degrees: [bool; 2],
}

impl Start {
    pub fn of(parameters: &Parameters<f64>, motion: &Motion<f64>) -> Self {
        Self {
            about: (*parameters, *motion),
            fractions: None,
            degrees: [false; 2],
        }
    }

    /// The quarter turns that the angles count as: those in rad whose `f64` has an exact direction
    /// in the kernel. No number is pi, so a user who types 3.141592653589793 means 180 degrees.
    pub fn quarters(&self) -> [Option<f64>; 2] {
        let (_, Motion { a1, a2, .. }) = self.about;
        let has_degrees = self.fractions.is_some() && self.degrees[0];
        [a1, a2].map(|angle| {
            let (sine, cosine) = kernel_sin_cos(angle);
            let is_exact = angle != 0.0 && sine * cosine == 0.0;
            (is_exact && !has_degrees).then(|| (angle / FRAC_PI_2).round())
        })
    }

    pub fn rests(&self) -> bool {
        let (_, Motion { a1, a2, w1, w2 }) = self.about;
        let is_vertical = |(numerator, denominator): (i64, u64)| {
            i128::from(numerator) % (180 * i128::from(denominator)) == 0
        };
        let are_vertical = match self.fractions {
            Some([a1, a2, ..]) if self.degrees[0] => is_vertical(a1) && is_vertical(a2),
            _ => [a1, a2].map(|angle| kernel_sin_cos(angle).0) == [0.0; 2],
        };
        are_vertical && [w1, w2] == [0.0; 2]
    }

    /// Returns the set that contains the start, for `rate` frames a second.
    ///
    /// The unit of time is so short that no rod turns by more than 4 rad in it, and 2^e is near the
    /// root of (m1 + m2)/m1. The numbers of the equations are then neither large nor small, for
    /// masses within a factor of 1000 and lengths within a factor of 30 of each other.
    pub fn enclose(&self, rate: u16) -> Enclosure {
        let (parameters @ Parameters { m1, m2, l1, l2, g }, motion @ Motion { a1, a2, w1, w2 }) =
            self.about;

        let unit = (fastest_rate(&parameters, &motion) / 4.0)
            .log2()
            .ceil()
            .max(-64.0) as i32;
        let e = (0.5 * (1.0 + m2 / m1).log2()).clamp(0.0, 7.0).round() as i32;
        let [by, by1, by2] = [m1.max(m2), l1, l2].map(|x| x.log2() as i32);

        let about = [a1, a2, w1, w2, m1, m2, l1, l2, g];
        let fractions = self.fractions.map(|mut fractions| {
            if self.degrees[0] {
                for angle in &mut fractions[..2] {
                    *angle = without_whole_circles(*angle);
                }
            }
            fractions
        });

        let [a1, a2, w1, w2, m1, m2, l1, l2, g] = from_fn(|i| {
            move |exponent: i32| match fractions {
                Some(fractions) => Fixed::fraction(fractions[i].0, fractions[i].1, exponent),
                None => Fixed::of(about[i] * f64::from(exponent).exp2()),
            }
        });

        let total = (m1(-by) + m2(-by)).inverse();
        let upper = m1(e - by) * total;
        let lower = m2(e - by) * total;
        let over_l1 = l1(-by1).inverse();
        let over_l2 = l2(-by2).inverse();
        let rods = l1(-by2) * over_l2;
        let coupling = lower * l2(-by1) * over_l1;
        let gravity = [
            g(e - 2 * unit - by1) * over_l1,
            g(-2 * unit - by2) * over_l2,
        ];

        let radians = |x: Fixed, degrees: bool| if degrees { x.over(180) * Fixed::PI } else { x };
        let [a1, a2] = if self.degrees[0] {
            [a1(0), a2(0)].map(|a| radians(a, true))
        } else {
            let [quarters1, quarters2] = self.quarters();
            let exact = |quarters: f64| Fixed::of(quarters.rem_euclid(4.0) / 2.0) * Fixed::PI;
            [
                quarters1.map_or_else(|| without_turns(a1, about[0]), exact),
                quarters2.map_or_else(|| without_turns(a2, about[1]), exact),
            ]
        };
        let [w1, w2] = [w1(-unit), w2(-unit)].map(|w| radians(w, self.degrees[1]));
        let [sin1, cos1] = sin_cos(a1);
        let [s, c] = sin_cos(a1 - a2);
        let start = [
            sin1,
            cos1,
            s,
            c,
            (upper + lower) * w1 + coupling * c * w2,
            w2 + rods * c * w1,
        ];
        Enclosure::new(
            Equations {
                upper,
                lower,
                rods,
                coupling,
                gravity,
            },
            (unit, rate),
            start,
            Fineness::default(),
        )
    }
}

fn without_whole_circles((numerator, denominator): (i64, u64)) -> (i64, u64) {
    let circle = 360 * i128::from(denominator);
    let rest = i128::from(numerator).rem_euclid(circle);
    let nearest = if 2 * rest > circle {
        rest - circle
    } else {
        rest
    };

    // The result is nearer to zero than the numerator, or has the opposite sign.
    (i64::try_from(nearest).unwrap_or(numerator), denominator)
}

const LARGEST_ANGLE: f64 = 64.0;

/// Returns an angle of about `about` rad without whole turns. `angle(n)` returns the angle times
/// 2^n.
///
/// A large angle is divided by 2^n so that it is in range. Its rounding then counts 2^n times.
fn without_turns(angle: impl Fn(i32) -> Fixed, about: f64) -> Fixed {
    if about.abs() <= LARGEST_ANGLE {
        return angle(0);
    }

    let places = (about.abs() / LARGEST_ANGLE).log2().ceil() as i32;
    let turns = (about / std::f64::consts::TAU).round();
    let share = Fixed::of(turns * f64::from(-places).exp2());
    let mut rest = angle(-places) - share * (Fixed::PI + Fixed::PI);

    for _ in 0..places {
        rest = rest + rest;
    }
    rest
}

/// Returns balls that contain the sine and the cosine of every angle in the ball.
///
/// Theorem (Leibniz): the remainder of an alternating series with decreasing terms is smaller than
/// the last term added. The terms decrease from the fifth on, because |x| is below 4 without whole
/// turns.
pub fn sin_cos(angle: Fixed) -> [Fixed; 2] {
    let turn = Fixed::PI + Fixed::PI;
    let x = angle - turn * Fixed::of((angle.about() / turn.about()).round());
    let square = x * x;
    [(x, 1), (Fixed::ONE, 0)].map(|(first, power)| {
        let mut sum = first;
        let mut term = first;
        for power in (power..64_u32).step_by(2) {
            term = Fixed::ZERO - (term * square).over((power + 1) * (power + 2));
            sum = sum + term;
        }
        sum.wider(term.size())
    })
}
