//! The count of whole turns of the rods.

use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Direction, State};

/// Returns a negative number if the sine has changed its sign, from `from` to `to`, and `cos` is
/// negative; another number otherwise. Only the highest bit of each word counts.
#[inline(always)] // As with `side`: otherwise maps of flips take 2.5 times as long.
pub(crate) fn turns_over([from, to, cos]: [i32; 3]) -> i32 {
    (from ^ to) & cos
}

/// Counts the whole turns of a direction, by the signs of its sine and cosine.
///
/// A direction must be observed at least once per quarter turn, otherwise turns are miscounted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    /// The number of whole turns, positive counter-clockwise.
    whole: i32,
    /// The sine and cosine that were observed last, as words whose highest bit is the sign.
    last: [i32; 2],
}

impl Turns {
    /// Starts the count at the angles `start`, rad, whose directions have the signs `now`. The
    /// result has one count for each rod.
    ///
    /// `now` is the sine and cosine of each rod as words whose highest bit is the sign
    /// ([`sides`](super::Advance::sides)). Rounding may put a direction on the other side of
    /// upright than its angle; the count then follows `now`. The angles must not be NaN; this is
    /// not checked.
    ///
    /// # Errors
    ///
    /// Refuses 2^31 - 1 turns or more in either direction, also infinite angles, by
    /// [`Error::OutOfRange`] with the angle, a1 or a2.
    pub fn of(start: [f64; 2], now: [[i32; 2]; 2]) -> Result<[Self; 2], Error> {
        // Count from the nearest whole turn; the rest is at most half a turn.
        let mut turns = start.map(|angle| {
            let whole = libm::rint(angle / core::f64::consts::TAU);
            let rest = angle - whole * core::f64::consts::TAU;
            // The last cosine counts as negative, so that the sign of the new one decides.
            Self {
                whole: whole as i32,
                last: [-i32::from(rest < 0.0), -1],
            }
        });

        // The conversion to `i32` saturates, so a count out of range is seen by its size.
        for ((parameter, value), turns) in [Parameter::A1, Parameter::A2]
            .into_iter()
            .zip(start)
            .zip(&turns)
        {
            if turns.whole.unsigned_abs() >= i32::MAX as u32 {
                return Err(Error::OutOfRange { parameter, value });
            }
        }

        // The rounded directions may be on the other side of upright than the angles.
        Self::observe(&mut turns, now);
        Ok(turns)
    }

    /// Starts the count at the angles in [-pi, pi] whose directions have the signs `now`.
    pub(super) fn within_half_a_turn(now: [[i32; 2]; 2]) -> [Self; 2] {
        now.map(|last| Self { whole: 0, last })
    }

    /// Observes the signs that the directions have `now`
    /// ([`sides`](super::Advance::sides)). For each rod that has turned over since the last
    /// call, it counts one turn up if that was counter-clockwise, and one down otherwise.
    ///
    /// The count wraps after 2^31 turns.
    pub fn observe(both: &mut [Self; 2], now: [[i32; 2]; 2]) {
        for (turns, now) in both.iter_mut().zip(now) {
            if turns_over([turns.last[0], now[0], turns.last[1] & now[1]]) < 0 {
                turns.whole = turns.whole.wrapping_add(if now[0] < 0 { 1 } else { -1 });
            }
            turns.last = now;
        }
    }

    /// Returns the angle, rad, including whole turns, of the argument. It must be the direction
    /// that was observed last; this is not checked. Its length does not matter, except that 0 or
    /// infinity gives a meaningless angle. NaN gives NaN.
    pub fn angle<R: Real>(&self, [s, c]: Direction<R>) -> R {
        R::from_f64(f64::from(self.whole) * core::f64::consts::TAU) + s.atan2(c)
    }

    /// Returns `state` with whole turns added to its angles, rad, so that each agrees with the
    /// direction that was observed last and its turns. The angles may already include turns. The
    /// momenta are unchanged. An angle that is NaN or infinite gives NaN.
    ///
    /// The state may differ from that direction by less than a quarter turn. If it differs by more,
    /// the count may be wrong by a turn; this is not checked. The function needs no trigonometry,
    /// because the sign of the sine gives the direction to within a quarter turn.
    #[must_use]
    pub fn unwrap([turns1, turns2]: &[Self; 2], state: State<f64>) -> State<f64> {
        use core::f64::consts::{FRAC_PI_2, TAU};
        let unwrapped = |turns: &Self, angle: f64| {
            let side = if turns.last[0] < 0 {
                -FRAC_PI_2
            } else {
                FRAC_PI_2
            };

            // Add the turns that bring the angle closest to the middle of the half turn that the
            // sign of the last sine selects.
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

    /// Returns the angle of a count that starts at `start`, rad, with the direction of `now`, rad.
    fn counted(start: f64, now: f64) -> f64 {
        let direction = [libm::sin(now), libm::cos(now)];
        let signs = direction.map(|value| if value < 0.0 { -1 } else { 0 });
        let [turns, _] = Turns::of([start; 2], [signs; 2]).expect("few turns");
        turns.angle(direction)
    }

    /// The count starts at angles of up to 44 rad, seven turns, in both directions. If rounding has
    /// moved a direction to the other side of upright or hanging than its angle, the count follows
    /// the direction.
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
