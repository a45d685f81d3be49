//! The count of whole turns of the rods.

use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Direction, State};

/// Returns a negative number if the sine has changed its sign and `cos` is negative. Only the
/// highest bit of each word counts.
#[inline(always)] // As with `side`: otherwise maps of flips take 2.5 times as long.
pub(crate) fn turns_over([from, to, cos]: [i32; 3]) -> i32 {
    (from ^ to) & cos
}

/// Counts the whole turns of a direction, by the signs of its sine and cosine.
///
/// A direction must be observed at least once per quarter turn, otherwise turns are miscounted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    whole: i32,
    /// The sine and cosine that were observed last ([`sides`](super::Advance::sides)).
    last: [i32; 2],
}

impl Turns {
    /// Starts the count of both rods at the angles `start`, rad, whose directions have the signs
    /// `now`. Rounding may put a direction on the other side of upright than its angle; the count
    /// then follows `now`.
    ///
    /// Refuses 2^31 - 1 turns or more, by [`Error::OutOfRange`].
    pub fn of(start: [f64; 2], now: [[i32; 2]; 2]) -> Result<[Self; 2], Error> {
        let mut turns = start.map(|angle| {
            let whole = libm::rint(angle / core::f64::consts::TAU);
            let rest = angle - whole * core::f64::consts::TAU;
            // The last cosine counts as negative, so that the sign of the new one decides.
            Self {
                whole: whole as i32,
                last: [-i32::from(rest < 0.0), -1],
            }
        });

        for ((parameter, value), turns) in [Parameter::A1, Parameter::A2]
            .into_iter()
            .zip(start)
            .zip(&turns)
        {
            if turns.whole.unsigned_abs() >= i32::MAX as u32 {
                return Err(Error::OutOfRange { parameter, value });
            }
        }

        Self::observe(&mut turns, now);
        Ok(turns)
    }

    pub(super) fn within_half_a_turn(now: [[i32; 2]; 2]) -> [Self; 2] {
        now.map(|last| Self { whole: 0, last })
    }

    /// Observes the signs that the directions have `now`.
    pub fn observe(both: &mut [Self; 2], now: [[i32; 2]; 2]) {
        for (turns, now) in both.iter_mut().zip(now) {
            if turns_over([turns.last[0], now[0], turns.last[1] & now[1]]) < 0 {
                turns.whole = turns.whole.wrapping_add(if now[0] < 0 { 1 } else { -1 });
            }
            turns.last = now;
        }
    }

    /// Returns the angle, rad, including whole turns, of the direction that was observed last.
    pub fn angle<R: Real>(&self, [s, c]: Direction<R>) -> R {
        R::from_f64(f64::from(self.whole) * core::f64::consts::TAU) + s.atan2(c)
    }

    /// Returns `state` with whole turns added to its angles, so that each agrees with the direction
    /// that was observed last, from which it may differ by less than a quarter turn. No
    /// trigonometry is needed, because the sign of the sine gives the direction to within a quarter
    /// turn.
    #[must_use]
    pub fn unwrap([turns1, turns2]: &[Self; 2], state: State<f64>) -> State<f64> {
        use core::f64::consts::{FRAC_PI_2, TAU};
        let unwrapped = |turns: &Self, angle: f64| {
            let side = if turns.last[0] < 0 {
                -FRAC_PI_2
            } else {
                FRAC_PI_2
            };

            let near = f64::from(turns.whole) * TAU + side;
            angle + TAU * libm::rint((near - angle) / TAU)
        };
        State {
            a1: unwrapped(turns1, state.a1),
            a2: unwrapped(turns2, state.a2),
            ..state
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;

    fn counted(start: f64, now: f64) -> f64 {
        let direction = [libm::sin(now), libm::cos(now)];
        let signs = direction.map(|value| if value < 0.0 { -1 } else { 0 });
        let [turns, _] = Turns::of([start; 2], [signs; 2]).expect("few turns");
        turns.angle(direction)
    }

    /// If rounding has moved a direction to the other side of upright or hanging than its angle,
    /// the count follows the direction.
    #[test]
    fn counts_start_at_the_given_angles() {
        for start in (-440..=440).map(|i| 0.1 * f64::from(i)) {
            let angle = counted(start, start);
            assert!((angle - start).abs() < 1e-12, "{angle} instead of {start}");
        }

        for vertical in (-14..=14).map(|halves| f64::from(halves) * PI) {
            for [start, now] in
                [[-1e-6, 1e-6], [1e-6, -1e-6]].map(|pair| pair.map(|a| a + vertical))
            {
                let angle = counted(start, now);
                assert!((angle - now).abs() < 1e-12, "{angle} instead of {now}");
            }
        }
    }
}
