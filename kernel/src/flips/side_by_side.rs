//! The map of flips for many starts at once, in the processor's vectors.

use core::array::from_fn;

use super::falling::Falling;
use super::lanes::{DirectionLanes, Numbers};
use super::{Flip, Flips, passes};
use crate::error::Error;
use crate::methods::direction::BLOCK;
use crate::methods::turns::turns_over;
use crate::methods::{Advance, DirectionF32Plain};
use crate::numbers::RealOperations;
use crate::pendulum::{Direction, State};

type Motions<const N: usize> = DirectionLanes<N, ROWS>;
type LaneDirections<const N: usize> = [Direction<Numbers<N>>; 2];

/// The number of rows of lanes. Three keep a processor busy; with more, the compiler no longer uses
/// vectors of 4.
const ROWS: usize = 3;

/// The start that a lane follows, and the number of steps left.
#[derive(Clone, Copy)]
struct Lane {
    start: usize,
    left: u32,
}

impl Flips<DirectionF32Plain> {
    /// Computes the first flip of each of `starts`, the angles a1 and a2, rad, at rest, and passes
    /// it to `give` with the index of the start, counted from 0.
    ///
    /// Each start has exactly one result, in any order, bit-identical to that of [`of`](Self::of).
    /// Three times `N` starts are computed at a time; 8 lanes suit processors with vectors of 4 and
    /// of 8. The function is inlined, so that it is compiled for the processor of its caller.
    ///
    /// # Errors
    ///
    /// Refuses the first start whose angles are not finite, by [`Error::NotFinite`]. Some starts
    /// then lack their results.
    #[inline(always)]
    #[doc(hidden)] // For hosts with vectors only.
    pub fn of_each<const N: usize>(
        &self,
        starts: impl IntoIterator<Item = [f32; 2]>,
        mut give: impl FnMut(usize, Flip<f32>),
    ) -> Result<(), Error> {
        let mut starts = starts.into_iter().enumerate();
        let hanging = self.highest.started(&State::at_rest(0.0, 0.0))?;
        let mut motions = Motions::<N>::new(&hanging);
        let mut lanes: [[Option<Lane>; N]; ROWS] = [[None; N]; ROWS];
        loop {
            for (place, lane) in lanes.as_flattened_mut().iter_mut().enumerate() {
                if let Some(Lane { start, .. }) = lane.take_if(|lane| lane.left == 0) {
                    give(start, Flip::Later);
                }
                if lane.is_none() {
                    let next = self.next(&mut starts, &mut give)?;
                    motions.put(place, next.as_ref().map_or(&hanging, |(_, motion)| motion));
                    *lane = next.map(|(start, _)| Lane {
                        start,
                        left: self.steps,
                    });
                }
            }
            if lanes.as_flattened().iter().all(Option::is_none) {
                return Ok(());
            }
            self.follow(&mut motions, &mut lanes, &mut give);
        }
    }

    fn next(
        &self,
        starts: &mut impl Iterator<Item = (usize, [f32; 2])>,
        give: &mut impl FnMut(usize, Flip<f32>),
    ) -> Result<Option<(usize, DirectionF32Plain)>, Error> {
        for (start, [a1, a2]) in starts {
            match Falling::start(self, a1, a2)? {
                Some(Falling { motion, .. }) => return Ok(Some((start, motion))),
                None => give(start, Flip::Never),
            }
        }
        Ok(None)
    }

    /// Computes a block of steps and restores the lengths.
    #[inline(always)]
    fn follow<const N: usize>(
        &self,
        motions: &mut Motions<N>,
        lanes: &mut [[Option<Lane>; N]; ROWS],
        give: &mut impl FnMut(usize, Flip<f32>),
    ) {
        let mut before: [LaneDirections<N>; ROWS] = from_fn(|row| motions.rods(row));
        for step in 0..BLOCK {
            // Keep the state before the last step for the lanes that leave it out.
            let kept = (step + 1 == BLOCK).then_some(*motions);
            motions.step();
            if let Some(mut kept) = kept {
                for (place, lane) in lanes.as_flattened().iter().enumerate() {
                    let count = |lane: &Lane| {
                        u64::from(self.steps) - u64::from(lane.left) + u64::from(BLOCK)
                    };
                    if lane
                        .as_ref()
                        .is_some_and(|lane| self.highest.leaves_out(count(lane)))
                    {
                        motions.keep(place, &mut kept);
                    }
                }
                motions.restore_lengths();
            }

            for (row, before) in before.iter_mut().enumerate() {
                let rods = motions.rods(row);
                // A flip is rare, so the lanes are examined only if any has one.
                if any_turns_over(before, &rods) {
                    for (place, lane) in lanes[row].iter_mut().enumerate() {
                        let at = |rods: &LaneDirections<N>| {
                            rods.map(|direction| direction.map(|part| part.0[place].side()))
                        };
                        let before = at(before);
                        let after = at(&rods);
                        let passes =
                            |lane: &mut Lane| step < lane.left && passes(&before, &after) < 0;
                        if let Some(Lane { start, left }) = lane.take_if(passes) {
                            give(start, self.passage(self.steps - left + step, before, after));
                        }
                    }
                }
                *before = rods;
            }
        }

        lanes
            .as_flattened_mut()
            .iter_mut()
            .flatten()
            .for_each(|lane| lane.left = lane.left.saturating_sub(BLOCK));
    }
}

/// The loop over the lanes is the inner one, so that the compiler uses vectors.
#[inline(always)]
fn any_turns_over<const N: usize>(before: &LaneDirections<N>, after: &LaneDirections<N>) -> bool {
    let mut any = [0; 2];
    for (rod, any) in any.iter_mut().enumerate() {
        let [from, _] = before[rod];
        let [to, cos] = after[rod];
        for place in 0..N {
            *any |= turns_over([from, to, cos].map(|part| part.0[place].side()));
        }
    }
    any[0] | any[1] < 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flips::step_size;
    use crate::methods::Fixed32;
    use crate::pendulum::Parameters;
    use std::vec::Vec;

    /// At 30 s chaotic motions flip late. At 5 s some flip in each of the steps that the last block
    /// must not count.
    const LIMITS: [f64; 2] = [30.0, 5.0];
    /// Enough starts for flips in the step after which lengths are restored.
    const SIDE: usize = 91;

    fn starts(side: usize) -> impl Iterator<Item = [f32; 2]> + Clone {
        let angle = move |i: usize| ((i as f64 + 0.5) / side as f64 * 6.4 - 3.2) as f32;
        (0..side * side).map(move |i| [angle(i % side), angle(i / side)])
    }

    fn flips(parameters: &Parameters<f32>, limit: f64) -> Result<Flips<DirectionF32Plain>, Error> {
        let dt = step_size(parameters)?;
        Flips::new(parameters, dt, (limit / dt) as u32 | 1)
    }

    #[multiversion::multiversion(targets("x86_64+avx2+fma"))]
    fn all(flips: &Flips<DirectionF32Plain>) -> Result<Vec<Option<Flip<f32>>>, Error> {
        any(flips)
    }

    fn any(flips: &Flips<DirectionF32Plain>) -> Result<Vec<Option<Flip<f32>>>, Error> {
        let mut found = std::vec![None; SIDE * SIDE];
        flips.of_each::<8>(starts(SIDE), |start, flip| {
            assert_eq!(found[start].replace(flip), None)
        })?;
        Ok(found)
    }

    /// Neither starts nor steps fill the lanes, so that lanes leave out steps at different times.
    #[test]
    fn lanes_equal_single_motions() -> Result<(), Error> {
        let equal = Parameters::equal_rods(1.0, 1.0, 1.0);
        let different = Parameters {
            m1: 2.0,
            m2: 1.0,
            l1: 1.0,
            l2: 0.6,
            g: 1.0,
        };
        let [late, early] = LIMITS;
        for (parameters, limit) in [
            (equal, late),
            (equal, early),
            (different, late),
            (different, early),
        ] {
            let flips = flips(&parameters, limit)?;
            let flips = Flips {
                highest: flips.highest.leaving_out_more(),
                ..flips
            };

            let found = any(&flips)?;
            assert_eq!(found, all(&flips)?, "vectors as this processor has them");
            for (flip, [a1, a2]) in found.iter().zip(starts(SIDE)) {
                assert_eq!(*flip, Some(flips.of(a1, a2)?), "{a1} {a2}");
            }

            let count = |kind: fn(&Flip<f32>) -> bool| {
                found.iter().flatten().filter(|flip| kind(flip)).count()
            };
            assert!(count(|flip| matches!(flip, Flip::Never)) > 1000);
            assert!(count(|flip| matches!(flip, Flip::After(_))) > 1000);
            assert!(count(|flip| matches!(flip, Flip::Later)) > 300);
        }
        Ok(())
    }

    #[test]
    fn fixed_point_agrees_except_in_chaos() -> Result<(), Error> {
        for mass_ratio in [0.01, 0.1, 1.0, 3.0] {
            let parameters = Parameters::equal_rods(mass_ratio, 1.0, 1.0);
            let dt = step_size(&parameters)?;
            let steps = (10.0 / dt) as u32;
            let float = Flips::<DirectionF32Plain>::new(&parameters, dt, steps)?;
            let fixed = Flips::<Fixed32>::new(&parameters, dt, steps)?;

            // In chaos the arithmetics differ.
            let mut other = 0;
            for [a1, a2] in starts(20) {
                let float = float.of(a1, a2)?;
                let fixed = fixed.of(a1, a2)?;
                other += u32::from(match (float, fixed) {
                    (Flip::After(one), Flip::After(other)) => (one - other).abs() > 0.05,
                    _ => float != fixed,
                });
            }
            assert!(other <= 4, "{other} of 400 at mass ratio {mass_ratio}");
        }
        Ok(())
    }
}
