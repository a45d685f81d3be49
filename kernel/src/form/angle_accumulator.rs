//! A range-reduced angle accumulator: it loses no digit, however often the angle turns.

use super::checkpoint::{RestoreError, Words};
use super::sum::Sum;
use crate::real::Real;
use crate::sine::by_quarters;
use crate::trig::{Own, SinCos};

/// Marks to the quarter turn; they lie near the multiples of pi/32 = 0.098 rad.
const MARKS: i32 = 16;

/// pi/32, rad.
const SPACING: f64 = core::f64::consts::FRAC_PI_2 / MARKS as f64;

/// The largest start angle, rad: 262,000 turns. Beyond it the remainder from a mark would lose digits.
pub(crate) const LARGEST: f64 = 1.647e6;

/// An angle as a mark, counted with all whole turns, and the remainder from there.
///
/// The remainder is kept near 0.05 rad, so that its last place weighs 4e-9 rad in `f32` at every angle, and the
/// direction follows from that of the mark by a small turn.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct AngleAccumulator<R, S> {
    mark: i32,
    /// `length` (sin, cos) of the mark.
    direction: [R; 2],
    rest: R,
    sum: S,
}

impl<R: Real, S: Sum<R>> AngleAccumulator<R, S> {
    /// The angle `value`, rad, at most [`LARGEST`]; its directions come with the given `length`.
    #[must_use]
    #[inline(never)] // seldom: once in flash, not once for each caller
    pub fn new(value: f64, length: R) -> Self {
        let mark = libm::rint(value / SPACING);
        let [high, middle, low] = f64::PI_OVER_TWO.map(|part| mark * (part / f64::from(MARKS)));
        let mark = mark as i32;
        let rest = ((value - high) - middle) - low - offset::<R>(mark).to_f64();
        Self { mark, direction: direction(mark, length), rest: R::from_f64(rest), sum: S::new(rest) }
    }

    /// The angle that [`bits`](Self::bits) told; its directions come with the given `length`.
    pub fn restore(words: &mut Words, length: R) -> Result<Self, RestoreError> {
        let mark = u32::try_from(words.word()?).map_err(|_| RestoreError::NotSavedHere)? as i32;
        let rest = words.number()?;
        let sum = S::restore(words.number()?).ok_or(RestoreError::NotSavedHere)?;
        Ok(Self { mark, direction: direction(mark, length), rest, sum })
    }

    /// The direction: `length` (sin, cos).
    #[must_use]
    #[inline(always)]
    pub fn direction(&self) -> [R; 2] {
        R::turned(self.direction, self.rest)
    }

    /// The direction of the angle `further` on, by the full routine.
    #[must_use]
    #[inline]
    pub fn direction_at(&self, further: R) -> [R; 2] {
        let [s, c] = self.direction;
        let (sine, cosine) = Own::sin_cos(self.rest + further);
        [s * cosine + c * sine, c * cosine - s * sine]
    }

    /// Adds `change`, rad.
    #[inline(always)]
    pub fn add(&mut self, change: R) {
        self.rest = self.sum.add(self.rest, change);
    }

    /// The remainder from the mark, rad.
    #[must_use]
    #[inline(always)]
    pub fn rest(&self) -> R {
        self.rest
    }

    /// Counts from the nearest mark instead; the angle stays the same.
    pub fn renormalise(&mut self, length: R) {
        let marks = (self.rest * R::from_f64(1.0 / SPACING)).nearest();
        if marks == 0 {
            return;
        }
        let old = offset::<R>(self.mark);
        self.mark = self.mark.wrapping_add(marks);
        self.direction = direction(self.mark, length);
        let [high, middle, low] =
            R::PI_OVER_TWO.map(|part| R::from_f64(f64::from(marks)) * (part * R::from_f64(1.0 / 16.0)));
        self.rest = (self.rest - high) - middle; // exact
        for part in [-low, old, -offset::<R>(self.mark)] {
            self.add(part);
        }
    }

    /// The angle in parts: the mark's multiple of pi/32, and the rest, rad.
    #[must_use]
    pub fn parts(&self) -> (i32, f64) {
        let rest = self.rest.to_f64() + self.sum.lost().to_f64();
        (self.mark, offset::<R>(self.mark).to_f64() + rest)
    }

    /// Everything carried from step to step.
    pub fn bits(&self, feed: &mut impl FnMut(u64)) {
        feed(u64::from(self.mark as u32));
        feed(self.rest.bits());
        feed(self.sum.lost().bits());
    }
}

/// The angle of a mark and a rest, rad.
pub(crate) fn angle((mark, rest): (i32, f64)) -> f64 {
    f64::from(mark) * SPACING + rest
}

/// What a mark is beside its multiple of pi/32, rad.
fn offset<R: Real>(mark: i32) -> R {
    let within = mark & (MARKS - 1);
    if within <= MARKS / 2 { R::MARKS[within as usize][0] } else { -R::MARKS[(MARKS - within) as usize][0] }
}

/// `length` (sin, cos) of a mark.
fn direction<R: Real>(mark: i32, length: R) -> [R; 2] {
    let within = mark & (MARKS - 1);
    let first = if within <= MARKS / 2 {
        let [_, s, c] = R::MARKS[within as usize];
        (s, c)
    } else {
        let [_, s, c] = R::MARKS[(MARKS - within) as usize];
        (c, s)
    };
    let (s, c) = by_quarters(first, (mark >> 4) as u32);
    [length * s, length * c]
}

#[cfg(test)]
mod tests {
    use super::super::sum::{Compensated, Plain};
    use super::*;

    /// The angle to ten digits below the last turn, rad: the marks' whole turns are left out.
    fn within_turn<R: Real, S: Sum<R>>(turn: &AngleAccumulator<R, S>) -> f64 {
        let (mark, rest) = turn.parts();
        angle((mark & (4 * MARKS - 1), rest))
    }

    /// The remainder and the direction do not know how many turns there were: the same bits after a million.
    #[test]
    fn whole_turns_cost_no_digit() {
        let mut near = AngleAccumulator::<f32, Compensated<f32>>::new(0.3, 1.0);
        let mut far = AngleAccumulator { mark: near.mark + 4 * MARKS * 1_000_000, ..near };
        for i in 0..100_000 {
            for turn in [&mut near, &mut far] {
                turn.add(0.02 + 1e-7 * i as f32);
                turn.renormalise(1.0);
            }
            assert_eq!((near.rest, near.sum, near.direction), (far.rest, far.sum, far.direction));
            assert_eq!(far.mark - near.mark, 4 * MARKS * 1_000_000);
        }
    }

    /// A million turns in equal steps of 51/1024 rad, 1.3e8 of them, whose sum is known exactly: what a step of that size
    /// loses is 4e-10 rad. (A plain `f32` would stand still at 5e5 rad, where its last place outweighs the step.)
    #[test]
    fn a_million_turns_add_up() {
        const STEPS: u32 = 126_200_000;
        const STEP: f64 = 51.0 / 1024.0;
        let mut turn = AngleAccumulator::<f32, Compensated<f32>>::new(0.0, 1.0);
        for _ in 0..STEPS {
            turn.add(STEP as f32);
            if turn.rest().abs() > 0.06 {
                turn.renormalise(1.0);
            }
        }
        // STEP times STEPS has 33 bits; what is left of it beyond whole turns, by parts of 2 pi that multiply exactly
        let total = f64::from(STEPS) * STEP;
        let turns = libm::rint(total / core::f64::consts::TAU);
        assert!(turns > 1e6);
        let [high, middle, low] = f64::PI_OVER_TWO.map(|part| 4.0 * part * turns);
        let expected = ((total - high) - middle) - low;
        let apart = within_turn(&turn) - expected;
        let apart = apart - core::f64::consts::TAU * libm::rint(apart / core::f64::consts::TAU);
        assert!(apart.abs() < 0.1, "{apart:e} rad after {turns} turns");
    }

    /// On the way, every direction is that of the angle, whatever the sign and size of the angle and its steps.
    #[test]
    fn directions_follow_the_angle() {
        fn follow<R: Real>(start: f64, step: f64, tolerance: f64) {
            let mut turn = AngleAccumulator::<R, Plain>::new(start, R::TWO);
            for _ in 0..500 {
                let (sine, cosine) = libm::sincos(angle(turn.parts()));
                let [s, c] = turn.direction().map(R::to_f64);
                assert!((s / 2.0 - sine).abs().max((c / 2.0 - cosine).abs()) < tolerance, "{start} {step}");
                turn.add(R::from_f64(step));
                turn.renormalise(R::TWO);
            }
        }
        for start in [0.0, 0.5, -3.0, 999.0, -999.0] {
            for step in [0.01, -0.03, 0.7, -2.9] {
                follow::<f32>(start, step, 2e-7);
                follow::<f64>(start, step, 5e-13);
            }
        }
    }

    /// The table of marks is right: offsets included, sines and cosines are those of the angle.
    #[test]
    fn marks_are_accurate() {
        fn worst<R: Real>() -> f64 {
            (0..4 * MARKS).fold(0.0, |worst: f64, mark| {
                let (sine, cosine) = libm::sincos(f64::from(mark) * SPACING + offset::<R>(mark).to_f64());
                let [s, c] = direction(mark, R::ONE).map(R::to_f64);
                worst.max((s - sine).abs()).max((c - cosine).abs())
            })
        }
        assert!(worst::<f32>() < 1.2e-10);
        assert!(worst::<f64>() < 1e-15);
    }
}
