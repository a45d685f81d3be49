//! Whether a frame is right.

use super::ball::Ball;
use super::enclosure::Enclosure;
use super::fixed::Fixed;

/// What is proved of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Both bobs are within the tolerance of where the exact motion has them, wherever in the set it is.
    Right,
    /// One is not, wherever it is.
    Wrong,
    /// It depends on where.
    Open,
}

impl Verdict {
    /// In a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Wrong => "wrong",
            Self::Open => "open",
        }
    }
}

impl Enclosure {
    /// Where the rods point, (sin, cos) each.
    pub fn exact_directions(&self) -> [[Fixed; 2]; 2] {
        let [sin1, cos1, s, c, ..] = self.hull();
        [[sin1, cos1], [sin1 * c - cos1 * s, cos1 * c + sin1 * s]]
    }

    /// The same in `f64`.
    pub fn directions(&self) -> [[Ball; 2]; 2] {
        self.exact_directions().map(|direction| direction.map(Fixed::ball))
    }

    /// Of a frame that shows rods of these `lengths` in these directions, each bob to be within `tolerance`.
    pub fn verdict(&self, shown: &[[f64; 2]; 2], lengths: [f64; 2], tolerance: f64) -> Verdict {
        let (exact, [l1, l2]) = (self.directions(), lengths.map(Ball::exact));
        let off = |rod: usize| [0, 1].map(|axis| exact[rod][axis] - Ball::exact(shown[rod][axis]));
        let ([x1, y1], [x2, y2]) = (off(0).map(|x| x * l1), off(1).map(|x| x * l2));
        let tolerance = Ball::exact(tolerance);
        let beyond = |x: Ball, y: Ball| x * x + y * y - tolerance * tolerance;
        let bobs = [beyond(x1, y1), beyond(x1 + x2, y1 + y2)];
        if bobs.iter().all(|beyond| beyond.is_at_most_zero()) {
            Verdict::Right
        } else if bobs.iter().any(|beyond| beyond.is_above_zero()) {
            Verdict::Wrong
        } else {
            Verdict::Open
        }
    }
}
