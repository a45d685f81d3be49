//! The page's equations as they stand there, for comparison only.

use double_pendulum::parts::Derivatives;
use double_pendulum::{Error, Parameters, Real};

/// Sine and cosine as two routines of the `libm` crate, as the page calls them.
pub trait Separate: Real {
    fn sin(self) -> Self;
    fn cos(self) -> Self;
}

impl Separate for f32 {
    fn sin(self) -> Self {
        libm::sinf(self)
    }
    fn cos(self) -> Self {
        libm::cosf(self)
    }
}

impl Separate for f64 {
    fn sin(self) -> Self {
        libm::sin(self)
    }
    fn cos(self) -> Self {
        libm::cos(self)
    }
}

/// Hamilton's equations as the source page prints them: five sines and cosines and four divisions, nothing simplified.
///
/// The peer that every other arithmetic is measured against; no device should run it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Textbook<R> {
    parameters: Parameters<R>,
}

impl<R: Separate> Derivatives<R> for Textbook<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Ok(Self { parameters: *parameters })
    }

    /// The time derivatives of (a1, a2, p1, p2) (`[math24]`), with den = m1 + m2 sin^2(a1 - a2):
    ///
    /// - a1' = (p1 l2 - p2 l1 cos(a1 - a2)) / (l1^2 l2 den)
    /// - a2' = (p2 (m1 + m2) l1 - p1 m2 l2 cos(a1 - a2)) / (m2 l1 l2^2 den)
    /// - p1' = -(m1 + m2) g l1 sin a1 - A1 + A2
    /// - p2' = -m2 g l2 sin a2 + A1 - A2
    /// - A1 = p1 p2 sin(a1 - a2) / (l1 l2 den)
    /// - A2 = (p1^2 m2 l2^2 - 2 p1 p2 m2 l1 l2 cos(a1 - a2) + p2^2 (m1 + m2) l1^2) sin(2 (a1 - a2))
    ///   / (2 l1^2 l2^2 den^2)
    #[inline(always)]
    fn derivatives(&self, &[a1, a2, p1, p2]: &[R; 4]) -> [R; 4] {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        let d = a1 - a2;
        let (sin_d, cos_d) = (d.sin(), d.cos());
        let m = m1 + m2;
        let den = m1 + m2 * sin_d * sin_d;
        let brackets = p1 * p1 * m2 * l2 * l2 - R::TWO * p1 * p2 * m2 * l1 * l2 * cos_d + p2 * p2 * m * l1 * l1;
        let a_1 = p1 * p2 * sin_d / (l1 * l2 * den);
        let a_2 = brackets * (R::TWO * d).sin() / (R::TWO * l1 * l1 * l2 * l2 * den * den);
        [
            (p1 * l2 - p2 * l1 * cos_d) / (l1 * l1 * l2 * den),
            (p2 * m * l1 - p1 * m2 * l2 * cos_d) / (m2 * l1 * l2 * l2 * den),
            -(m * g * l1 * a1.sin()) - a_1 + a_2,
            -(m2 * g * l2 * a2.sin()) + a_1 - a_2,
        ]
    }
}
