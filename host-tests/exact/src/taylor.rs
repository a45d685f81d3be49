//! The reference: the exact motion to about 30 digits, computed independently of the kernel.
//!
//! It integrates Lagrange's two second-order equations (not Hamilton's), written again from the
//! book, by power series in time of order 36 (not Runge-Kutta), in double-double arithmetic of 106
//! bits (not f32 or f64). It uses only the kernel's plain data structures.
//!
//! Its results are within the [enclosure](crate::enclosure) of random motions, of the hard cases
//! and of the scenes, to 1e-31 times the growth of a small error and, if it is above 1 rad, the
//! larger angle of the start (tests `known_answers` and `motions`).

use double_pendulum::{Motion, Parameters, State};
use twofloat::TwoFloat;
use twofloat::consts::FRAC_PI_2;

use super::enclosure::Start;

/// The highest power of time in the series, unless [`Reference::of_order`] sets another.
const ORDER: usize = 36;

/// The first power of time whose coefficient is computed in `f64`.
///
/// In a step, each term is about a ninth of the one before it. Term 20 is about 1e-19 of the value,
/// so 16 digits of it are 35 digits of the value.
const FIRST_IN_F64: usize = 20;

/// A double pendulum in exact motion. A step takes about 0.1 ms. A rod of 1 m needs 20 to 50 steps
/// a second.
#[derive(Clone, Debug)]
pub struct Reference {
    parameters: Parameters<TwoFloat>,
    order: usize,
    time: TwoFloat,
    /// a1, a2 (rad); w1, w2 (rad/s).
    motion: [TwoFloat; 4],
    /// The power series of the motion about the time `about`.
    series: [Vec<TwoFloat>; 4],
    about: TwoFloat,
    end: TwoFloat,
}

impl Reference {
    /// Starts at time 0 from `motion`. Every `f64` is taken as exact, but for angles that the kernel
    /// takes as quarter turns (`double_pendulum::radians`).
    pub fn new(parameters: &Parameters<f64>, motion: &Motion<f64>) -> Self {
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        let &Motion { a1, a2, w1, w2 } = motion;
        let [m1, m2, l1, l2, g] = [m1, m2, l1, l2, g].map(TwoFloat::from);
        let [a1, a2] = [a1, a2].map(|angle| {
            let quarters = (angle / f64::from(FRAC_PI_2)).round();
            if quarters * f64::from(FRAC_PI_2) == angle {
                FRAC_PI_2 * quarters
            } else {
                TwoFloat::from(angle)
            }
        });
        let [w1, w2] = [w1, w2].map(TwoFloat::from);
        Self::exact(Parameters { m1, m2, l1, l2, g }, [a1, a2, w1, w2])
    }

    /// Starts from a1, a2 (rad), w1, w2 (rad/s).
    pub fn exact(parameters: Parameters<TwoFloat>, motion: [TwoFloat; 4]) -> Self {
        let zero = TwoFloat::from(0.0);
        Self {
            parameters,
            order: ORDER,
            time: zero,
            motion,
            series: [const { Vec::new() }; 4],
            about: zero,
            end: zero,
        }
    }

    pub fn of(start: &Start) -> Self {
        let (Parameters { m1, m2, l1, l2, g }, Motion { a1, a2, w1, w2 }) = start.about;
        let numbers = start.fractions.map_or_else(
            || [a1, a2, w1, w2, m1, m2, l1, l2, g].map(TwoFloat::from),
            |fractions| {
                fractions.map(|(above, below)| divide(TwoFloat::from(above), TwoFloat::from(below)))
            },
        );
        let [a1, a2, w1, w2, m1, m2, l1, l2, g] = numbers;
        let radians = |x: TwoFloat, degrees: bool| {
            // Exact at quarter turns.
            if degrees {
                divide(x, TwoFloat::from(90.0)) * FRAC_PI_2
            } else {
                x
            }
        };
        let [in_degrees, per_second] = start.degrees;
        let [quarters1, quarters2] = start.quarters();
        let angle = |a: TwoFloat, quarters: Option<f64>| {
            quarters.map_or_else(
                || radians(a, in_degrees),
                |quarters| FRAC_PI_2 * TwoFloat::from(quarters),
            )
        };
        let [a1, a2] = [angle(a1, quarters1), angle(a2, quarters2)];
        let [w1, w2] = [w1, w2].map(|w| radians(w, per_second));
        Self::exact(Parameters { m1, m2, l1, l2, g }, [a1, a2, w1, w2])
    }

    /// Returns the reference with power series of another order, at least 24, and with it other
    /// steps. The distance between the results of two orders shows how accurate both are.
    #[must_use]
    pub fn of_order(self, order: usize) -> Self {
        Self { order, ..self }
    }

    pub fn advance_to(&mut self, t: f64) {
        let t = TwoFloat::from(t);
        while self.time < t {
            if self.time >= self.end {
                self.series = self.series_now();
                self.about = self.time;
                self.end = self.time + longest_step(&self.series, self.order);
            }

            self.time = if self.end < t { self.end } else { t };
            let h = self.time - self.about;
            // The small terms are added first, in `f64`.
            let sum = |series: &Vec<TwoFloat>| {
                let (first, last) = series.split_at(FIRST_IN_F64);
                let last = last.iter().rev().fold(0.0, |sum, c| sum * h.hi() + c.hi());
                first
                    .iter()
                    .rev()
                    .fold(TwoFloat::from(last), |sum, &c| sum * h + c)
            };
            self.motion = self.series.each_ref().map(sum);
        }
    }

    /// Returns the motion with all turns.
    pub fn motion(&self) -> Motion<f64> {
        let [a1, a2, w1, w2] = self.motion.map(f64::from);
        Motion { a1, a2, w1, w2 }
    }

    /// Returns the state with all turns.
    pub fn state(&self) -> State<f64> {
        self.exact_state().map(f64::from).into()
    }

    /// (sin a1, cos a1, sin a2, cos a2).
    pub fn directions(&self) -> [TwoFloat; 4] {
        let [a1, a2, ..] = self.motion;
        let [[sin1, cos1], [sin2, cos2]] = [a1, a2].map(sin_cos);
        [sin1, cos1, sin2, cos2]
    }

    /// (a1, a2, p1, p2).
    pub fn exact_state(&self) -> [TwoFloat; 4] {
        let Parameters { m1, m2, l1, l2, .. } = self.parameters;
        let [a1, a2, w1, w2] = self.motion;
        let [_, cos_d] = sin_cos(a1 - a2);
        let p1 = (m1 + m2) * l1 * l1 * w1 + m2 * l1 * l2 * w2 * cos_d;
        let p2 = m2 * l2 * l2 * w2 + m2 * l1 * l2 * w1 * cos_d;
        [a1, a2, p1, p2]
    }

    /// Returns the coefficients of the power series of a1, a2, w1, w2 about the current time.
    ///
    /// The series of the sine and cosine of a1, a2 and D = a1 - a2 are computed along with them by
    /// s' = c a' and c' = -s a'.
    fn series_now(&self) -> [Vec<TwoFloat>; 4] {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        let total = m1 + m2;
        let [a1, a2, w1, w2] = self.motion;
        let [[sin1, cos1], [sin2, cos2], [sin_d, cos_d]] = [a1, a2, a1 - a2].map(sin_cos);
        let mut z = [a1, a2, w1, w2, sin1, cos1, sin2, cos2, sin_d, cos_d].map(|value| vec![value]);
        let [mut square1, mut square2, mut f1, mut f2, mut den, mut turn] =
            [(); 6].map(|()| Vec::new());
        let [mut acceleration1, mut acceleration2] = [(); 2].map(|()| Vec::new());

        for k in 0..self.order {
            let [_, _, w1, w2, sin1, cos1, sin2, cos2, sin_d, cos_d] = &z;

            // The accelerations follow from (m1 + m2) l1 w1' + m2 l2 w2' cos D = f1 and l1 w1' cos
            // D + l2 w2' = f2.
            square1.push(product(w1, w1));
            square2.push(product(w2, w2));
            f1.push(-m2 * l2 * product(&square2, sin_d) - total * g * sin1[k]);
            f2.push(l1 * product(&square1, sin_d) - g * sin2[k]);
            let square = m2 * product(sin_d, sin_d);
            den.push(if k == 0 { square + m1 } else { square });
            let quotient =
                |n: TwoFloat, before: &[TwoFloat]| divide(n - product(&den[1..], before), den[0]);
            acceleration1.push(quotient(
                divide(f1[k] - m2 * product(&f2, cos_d), l1),
                &acceleration1,
            ));
            acceleration2.push(quotient(
                divide(total * f2[k] - product(&f1, cos_d), l2),
                &acceleration2,
            ));
            turn.push(w1[k] - w2[k]);

            let slopes = [
                w1[k],
                w2[k],
                acceleration1[k],
                acceleration2[k],
                product(w1, cos1),
                -product(w1, sin1),
                product(w2, cos2),
                -product(w2, sin2),
                product(&turn, cos_d),
                -product(&turn, sin_d),
            ];
            for (z, slope) in z.iter_mut().zip(slopes) {
                z.push(slope / (k + 1) as f64);
            }
        }

        let [a1, a2, w1, w2, ..] = z;
        [a1, a2, w1, w2]
    }
}

/// Returns coefficient k of the product of two power series; `a` and `b` are their coefficients 0
/// to k.
///
/// Below [`FIRST_IN_F64`], the products of the high words and their sums are split exactly into a
/// rounded value and its error. The errors are summed in `f64`, with the products of a high and a
/// low word (T. Ogita, S. Rump, S. Oishi, "Accurate sum and dot product", 2005). Products of two
/// low words are left out. The error of n terms is at most about (n + 3)^2 2^-106 times the sum of
/// their magnitudes. From there on, the high words are multiplied and summed in `f64`.
fn product(a: &[TwoFloat], b: &[TwoFloat]) -> TwoFloat {
    let terms = a.iter().zip(b.iter().rev());
    if a.len() > FIRST_IN_F64 {
        return terms.fold(0.0, |sum, (a, b)| sum + a.hi() * b.hi()).into();
    }
    let [sum, errors] = terms.fold([0.0; 2], |[sum, errors], (a, b)| {
        let term = TwoFloat::new_mul(a.hi(), b.hi());
        let sum = TwoFloat::new_add(sum, term.hi());
        let small = a.hi() * b.lo() + a.lo() * b.hi();
        [sum.hi(), errors + (sum.lo() + term.lo() + small)]
    });
    TwoFloat::new_add(sum, errors)
}

fn sin_cos(angle: TwoFloat) -> [TwoFloat; 2] {
    let quarter_turns = f64::from(angle / FRAC_PI_2).round();
    // The first quarter turn that is left over is at most half a quarter.
    let x = angle - FRAC_PI_2 * quarter_turns;
    let alternating = |first: TwoFloat, mut power: f64| {
        let mut sum = first;
        let mut term = first;
        while term.hi().abs() > 1e-36 {
            term = -(term * x * x) / ((power + 1.0) * (power + 2.0));
            sum += term;
            power += 2.0;
        }
        sum
    };
    let sin = alternating(x, 1.0);
    let cos = alternating(1.0.into(), 0.0);
    match quarter_turns.rem_euclid(4.0) as u8 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

/// Returns a/b to full precision. The quotient of twofloat 0.8.4 is accurate to 1e-16 only, so its
/// remainder is divided as well.
pub fn divide(a: TwoFloat, b: TwoFloat) -> TwoFloat {
    let quotient = a / b;
    quotient + (a - quotient * b) / b
}

/// Returns the states at `times` (s, ascending) of the motion that begins at `start`.
pub fn states(
    parameters: &Parameters<f64>,
    start: &Motion<f64>,
    times: impl Iterator<Item = f64>,
) -> Vec<State<f64>> {
    let mut reference = Reference::new(parameters, start);
    let state = |t| {
        reference.advance_to(t);
        reference.state()
    };
    times.map(state).collect()
}

/// The smallest term of a series that is kept, relative to the rates of the motion.
const RESOLUTION: f64 = 1e-33;

/// Returns the step size that reduces the last terms of each series to the resolution of its value
/// (A. Jorba, M. Zou, "A software package for the numerical integration of ODEs by means of
/// high-order Taylor methods", 2005). Four terms are checked, because a motion with a symmetry in
/// time has only every second or fourth.
fn longest_step(motion: &[Vec<TwoFloat>; 4], order: usize) -> f64 {
    let magnitude = |x: TwoFloat| f64::from(x).abs();
    let rate = magnitude(motion[2][0])
        .max(magnitude(motion[3][0]))
        .max(1.0);

    let limits = motion
        .iter()
        .zip([1.0, 1.0, rate, rate])
        .flat_map(|(series, scale)| {
            (order - 3..=order).map(move |k| {
                let last = magnitude(series[k]).max(f64::MIN_POSITIVE);
                (RESOLUTION * scale / last).powf(1.0 / k as f64)
            })
        });
    limits.fold(f64::INFINITY, f64::min)
}
