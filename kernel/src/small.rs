//! The normal modes of small oscillations about hanging at rest, for any masses and lengths.

use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Parameters, Pendulum};

/// A normal mode: both angles oscillate at one frequency, in a fixed ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode<R> {
    /// Angular frequency, rad/s; finite and more than 0.
    pub frequency: R,
    /// The shape r = H2/H1 of the mode, the ratio of the amplitudes H of the angles: the angle of
    /// rod 2 if the angle of rod 1 is 1.
    pub shape: R,
}

/// The two normal modes of M a'' + K a = 0 (`[math24]`, "Small oscillations"; `[Landau]` paragraph
/// 23).
///
/// M is [`Pendulum::mass_matrix`] for parallel rods and K is [`Pendulum::stiffness`]. The
/// frequencies solve det(K - w^2 M) = 0, that is
/// (m1 + m2) g^2 - w^2 (m1 + m2)(l1 + l2) g + w^4 m1 l1 l2 = 0.
///
/// Here and in the methods, w1 > w2 > 0 are the angular frequencies of the fast and the slow mode,
/// rad/s, not the angular velocities of the rods.
///
/// The same two numbers are the growth rates about the inverted position (pi, pi), because K
/// changes its sign there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes<R> {
    /// The mode of w1. The rods swing against each other, and the shape is negative.
    pub fast: Mode<R>,
    /// The mode of w2. The rods swing together, and the shape is positive.
    pub slow: Mode<R>,
    /// w1 - w2, computed without cancellation, rad/s.
    exchange: R,
}

impl<R: Real> Modes<R> {
    /// Returns the modes of a pendulum.
    ///
    /// With M = m1 + m2 (here not the matrix), s = l1 + l2, d = l1 - l2 and
    /// c = sqrt((m1 d^2 + m2 s^2)/M):
    ///
    /// - w1^2 = g M (s + c) / (2 m1 l1 l2) and w2^2 = 2 g / (s + c)
    /// - shape of w1: -M (c + d) / (2 m2 l2); shape of w2: 2 l1 / (c + d)
    ///
    /// For d < 0 the sum is c + d = 4 m2 l1 l2 / (M (c - d)). The only subtraction is l1 - l2, so
    /// that nothing cancels.
    ///
    /// Both frequencies are within 4 ulp, in `f32` and `f64`.
    ///
    /// # Errors
    ///
    /// Refuses the parameters that [`Pendulum::new`] refuses, zero gravity by
    /// [`Error::NotPositive`], and, by [`Error::OutOfRange`], parameters whose modes are out of the
    /// range of `R` or subnormal.
    pub fn new(parameters: &Parameters<R>) -> Result<Self, Error> {
        parameters.check()?;
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        if g == R::ZERO {
            return Err(Error::NotPositive {
                parameter: Parameter::G,
                value: 0.0,
            });
        }

        let total = m1 + m2;
        let sum = l1 + l2;
        let difference = l1 - l2;
        let root = ((m1 * difference * difference + m2 * sum * sum) / total).sqrt();

        let fast = (g * total * (sum + root) / (R::TWO * m1 * l1 * l2)).sqrt();
        let slow = (R::TWO * g / (sum + root)).sqrt();
        // The shapes without the sum that would cancel.
        let reach = root + difference.abs();
        let short = R::TWO * l1 / reach;
        let long = total * reach / (R::TWO * m2 * l2);
        let (slow_shape, fast_shape) = if difference < R::ZERO {
            (long, -short)
        } else {
            (short, -long)
        };

        let modes = Self {
            fast: Mode {
                frequency: fast,
                shape: fast_shape,
            },
            slow: Mode {
                frequency: slow,
                shape: slow_shape,
            },
            exchange: g * total * root / (m1 * l1 * l2 * (fast + slow)),
        };
        if [fast, slow, fast_shape, slow_shape, modes.exchange]
            .into_iter()
            .all(R::is_normal)
        {
            Ok(modes)
        } else {
            Err(parameters.out_of_range())
        }
    }

    /// Returns the carrier frequency (w1 + w2)/2, rad/s, of the fast swing inside the envelope.
    #[must_use]
    pub fn carrier(&self) -> R {
        R::HALF * (self.fast.frequency + self.slow.frequency)
    }

    /// Returns the modulation frequency (w1 - w2)/2, rad/s, of the slow cosine of each amplitude.
    /// `[math24]` calls it "beat frequency".
    #[must_use]
    pub fn modulation(&self) -> R {
        R::HALF * self.exchange
    }

    /// Returns the exchange frequency w1 - w2, rad/s, at which the energy moves from rod to rod and
    /// back.
    #[must_use]
    pub fn exchange(&self) -> R {
        self.exchange
    }
}

impl<R: Real> Pendulum<R> {
    /// Returns the stiffness matrix K of small oscillations, N m/rad, row by row: diag((m1 + m2) g
    /// l1, m2 g l2).
    #[must_use]
    pub fn stiffness(&self) -> [[R; 2]; 2] {
        let [k1, k2] = self.torque;
        [[k1, R::ZERO], [R::ZERO, k2]]
    }

    /// Returns the normal modes ([`Modes::new`]). Refuses zero gravity, by [`Error::NotPositive`],
    /// and modes out of the range of `R`, by [`Error::OutOfRange`].
    pub fn modes(&self) -> Result<Modes<R>, Error> {
        Modes::new(self.parameters())
    }
}

/// Returns the mass ratio m2/m1 that makes small oscillations exactly periodic with w1/w2 =
/// `fast`/`slow`.
///
/// With p = `fast`, q = `slow` and the `lengths` [l1, l2] in m,
///
/// mu = (p^2 l1 - q^2 l2)(p^2 l2 - q^2 l1) / (p q (l1 + l2))^2,
///
/// which follows from (w1/w2 + w2/w1)^2 = (1 + mu)(l1 + l2)^2/(l1 l2). For equal rods it is mu =
/// ((r^2 - 1)/(2r))^2 with r = p/q. A common period is 2 pi p/w1 = 2 pi q/w2, s. Close to the least
/// possible ratio p/q a factor cancels, and mu has fewer correct digits.
///
/// # Errors
///
/// Refuses lengths that are NaN or infinite ([`Error::NotFinite`]), zero or negative
/// ([`Error::NotPositive`]); a `slow` of 0 ([`Error::NotFinite`]); a ratio p/q that no masses can
/// give, because it does not exceed the square root of the longer rod over the shorter
/// ([`Error::TooSmall`]); and lengths for which the formula overflows or underflows in `R`
/// ([`Error::OutOfRange`]).
pub fn periodic_mass_ratio<R: Real>(fast: u16, slow: u16, lengths: [R; 2]) -> Result<R, Error> {
    let [l1, l2] = lengths;
    let parameters = Parameters {
        m1: R::ONE,
        m2: R::ONE,
        l1,
        l2,
        g: R::ONE,
    };
    parameters.check()?;
    if slow == 0 {
        return Err(Error::NotFinite {
            parameter: Parameter::FrequencyRatio,
            value: f64::INFINITY,
        });
    }

    let p = R::from_f64(f64::from(fast));
    let q = R::from_f64(f64::from(slow));
    let numerator1 = p * p * l1 - q * q * l2;
    let numerator2 = p * p * l2 - q * q * l1;
    let denominator = p * q * (l1 + l2);

    if !(numerator1.is_finite() && numerator2.is_finite()) {
        return Err(parameters.out_of_range());
    }

    // At the limit bob 2 would have no mass.
    if numerator1 > R::ZERO && numerator2 > R::ZERO {
        let mass_ratio = numerator1 * numerator2 / (denominator * denominator);
        if mass_ratio.is_normal() {
            Ok(mass_ratio)
        } else {
            Err(parameters.out_of_range())
        }
    } else {
        let ratio = if l1 > l2 { l1 / l2 } else { l2 / l1 };
        Err(Error::TooSmall {
            parameter: Parameter::FrequencyRatio,
            value: (p / q).to_f64(),
            limit: ratio.sqrt().to_f64(),
        })
    }
}
