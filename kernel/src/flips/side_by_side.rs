//! Many starts at once, in the lanes of the processor's vectors.

use core::array::from_fn;

use super::{Falling, Flip, Flips, turns_over};
use crate::error::Error;
use crate::form::{Direction, DirectionForm, DirectionLanes, DirectionState, Part, Plain, RESTORING};
use crate::lanes::Lanes;

type Form = DirectionForm<f32, Plain>;
type Motion = DirectionState<f32, Plain>;

/// Which start a lane follows, and how far it is.
#[derive(Clone, Copy)]
struct Lane {
    start: usize,
    steps: u32,
}

impl Flips<f32, Form> {
    /// What becomes of each of `starts`, the angles a1 and a2, rad: as [`of`](Self::of), to the bit, `N` at a time.
    ///
    /// A lane whose motion has turned over takes the next start. 16 lanes suit processors with vectors of 4 and of 8. Inlined
    /// wherever it is called, so that it is compiled for the processor its caller is compiled for.
    ///
    /// Refuses angles that are not finite, having given the flips of those before.
    #[inline(always)]
    pub fn of_each<const N: usize>(
        &self,
        starts: impl IntoIterator<Item = [f32; 2]>,
        mut give: impl FnMut(usize, Flip<f32>),
    ) -> Result<(), Error> {
        let mut starts = starts.into_iter().enumerate();
        let mut motions = DirectionLanes::<f32, N>::new(&self.form, &self.highest);
        let mut lanes: [Option<Lane>; N] = [None; N];
        loop {
            for (place, lane) in lanes.iter_mut().enumerate().filter(|(_, lane)| lane.is_none()) {
                if let Some((start, carried)) = self.next(&mut starts, &mut give)? {
                    motions.put(place, &carried);
                    *lane = Some(Lane { start, steps: 0 });
                }
            }
            if lanes.iter().all(Option::is_none) {
                return Ok(());
            }
            self.follow(&mut motions, &mut lanes, &mut give);
        }
    }

    /// The next start that may turn over.
    fn next(
        &self,
        starts: &mut impl Iterator<Item = (usize, [f32; 2])>,
        give: &mut impl FnMut(usize, Flip<f32>),
    ) -> Result<Option<(usize, Motion)>, Error> {
        for (start, [a1, a2]) in starts {
            match self.start(a1, a2)? {
                Some(Falling { carried, .. }) => return Ok(Some((start, carried))),
                None => give(start, Flip::Never),
            }
        }
        Ok(None)
    }

    /// Steps until the lengths are due to be restored, and restores them.
    #[inline(always)]
    fn follow<const N: usize>(
        &self,
        motions: &mut DirectionLanes<f32, N>,
        lanes: &mut [Option<Lane>; N],
        give: &mut impl FnMut(usize, Flip<f32>),
    ) {
        let mut watched: [i32; N] = from_fn(|place| -i32::from(lanes[place].is_some()));
        let mut heads = motions.heads();
        for step in 0..RESTORING {
            motions.step();
            if step + 1 == RESTORING {
                motions.restore_lengths();
            }
            let before = core::mem::replace(&mut heads, motions.heads());
            let passes: [i32; N] = from_fn(|place| {
                let [upper, lower] = [0, 1].map(|rod| signs(&before[rod], &heads[rod], place));
                (upper | lower) & watched[place]
            });
            if passes.iter().fold(0, |any, &pass| any | pass) < 0 {
                for place in 0..N {
                    if let Some(lane) = lanes[place].filter(|_| passes[place] < 0) {
                        let at =
                            |heads: &[Direction<Lanes<f32, N>>; 2]| heads.map(|head| head.map(|part| part.0[place]));
                        let steps = lane.steps + step;
                        let flip = || self.passage(steps, at(&before), at(&heads));
                        give(lane.start, if steps < self.steps { flip() } else { Flip::Later });
                        (lanes[place], watched[place]) = (None, 0);
                    }
                }
            }
        }
        for lane in lanes.iter_mut() {
            if let Some(Lane { start, steps }) = lane {
                *steps += RESTORING;
                if *steps >= self.steps {
                    give(*start, Flip::Later);
                    *lane = None;
                }
            }
        }
    }
}

/// As [`turns_over`] of one lane.
#[inline(always)]
fn signs<const N: usize>(
    [from, _]: &Direction<Lanes<f32, N>>,
    [to, cos]: &Direction<Lanes<f32, N>>,
    place: usize,
) -> i32 {
    turns_over([from, to, cos].map(|part| part.0[place].sign()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flips::step_size;
    use crate::form::Fixed32Form;
    use crate::params::Parameters;
    extern crate std;
    use std::vec::Vec;

    const LIMIT: f64 = 30.0;
    /// Enough for rods that turn over in the very step after which lengths are restored.
    const SIDE: usize = 91;

    /// A square of starts, all turns.
    fn starts(side: usize) -> impl Iterator<Item = [f32; 2]> + Clone {
        let angle = move |i: usize| ((i as f64 + 0.5) / side as f64 * 6.4 - 3.2) as f32;
        (0..side * side).map(move |i| [angle(i % side), angle(i / side)])
    }

    /// Steps that are no multiple of those from one restoring to the next; starts that are no multiple of the lanes.
    fn flips(parameters: &Parameters<f32>) -> Result<Flips<f32, Form>, Error> {
        let dt = step_size(parameters)?;
        Flips::new(parameters, dt, (LIMIT / dt) as u32 | 1)
    }

    #[test]
    fn every_lane_is_what_one_motion_gives() -> Result<(), Error> {
        for parameters in
            [Parameters::equal_rods(1.0, 1.0, 1.0), Parameters { m1: 2.0, m2: 1.0, l1: 1.0, l2: 0.6, g: 1.0 }]
        {
            let flips = flips(&parameters)?;
            let mut found: Vec<Option<Flip<f32>>> = std::vec![None; SIDE * SIDE];
            flips.of_each::<16>(starts(SIDE), |start, flip| assert_eq!(found[start].replace(flip), None))?;
            for (flip, [a1, a2]) in found.iter().zip(starts(SIDE)) {
                assert_eq!(*flip, Some(flips.of(a1, a2)?), "{a1} {a2}");
            }
            let count = |kind: fn(&Flip<f32>) -> bool| found.iter().flatten().filter(|flip| kind(flip)).count();
            assert!(count(|flip| matches!(flip, Flip::Never)) > 1000);
            assert!(count(|flip| matches!(flip, Flip::After(_))) > 1000);
            assert!(count(|flip| matches!(flip, Flip::Later)) > 300);
        }
        Ok(())
    }

    #[test]
    fn fixed_point_finds_the_same_but_for_chaos() -> Result<(), Error> {
        for mass_ratio in [0.01, 0.1, 1.0, 3.0] {
            let parameters = Parameters::equal_rods(mass_ratio, 1.0, 1.0);
            let dt = step_size(&parameters)?;
            let steps = (10.0 / dt) as u32;
            let float = Flips::<f32, Form>::new(&parameters, dt, steps)?;
            let fixed = Flips::<f32, Fixed32Form>::new(&parameters, dt, steps)?;
            let mut other = 0;
            for [a1, a2] in starts(20) {
                other += u32::from(match (float.of(a1, a2)?, fixed.of(a1, a2)?) {
                    (Flip::After(one), Flip::After(other)) => (one - other).abs() > 0.05,
                    (one, other) => one != other,
                });
            }
            assert!(other <= 4, "{other} of 400 at mass ratio {mass_ratio}");
        }
        Ok(())
    }
}
