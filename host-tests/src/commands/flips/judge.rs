//! How far the map is right: it is held against the exact motion.

use std::f64::consts::PI;

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::{DirectionF64, Error, Motion};

use fastrand::Rng;

use super::map::{Followed, Map};
use reference::taylor::Reference;

/// The judge's steps are so many times finer; its arithmetic is compensated `f64`.
const FINER: u32 = 16;
/// Times between which the exact motion is looked at, sqrt(l1/g).
const LOOKS: f64 = 0.1;

/// How a map's points were judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Points that may turn over.
    pub points: usize,
    /// Of them, those whose time is more than a grey level off.
    pub wrong: usize,
    pub doubtful: usize,
    /// Those that are wrong and not in doubt.
    pub unsuspected: usize,
}

/// Has the reference judge so many points of the upper half of a map that may turn over, drawn at random, the same in each run:
/// 0.1 s each. How many of them are more than a grey level off.
pub fn sample(map: &Map, judged: usize) -> Result<usize, Error> {
    let points = map.points(|_| ())?;
    let starts = map.starts().zip(points);
    let mut candidates: Vec<_> = starts.filter(|(_, point)| point.flip != Flip::Never).collect();
    Rng::with_seed(1).shuffle(&mut candidates);
    let is_wrong = |(start, point): &([f32; 2], Followed)| map.differ(point.flip, exact(map, *start));
    Ok(candidates.into_iter().take(judged).filter(is_wrong).count())
}

/// Judges all points of the upper half of a map by fine steps in `f64`.
pub fn judge(map: &Map) -> Result<Judgement, Error> {
    let points = map.points(|_| ())?;
    let dt = map.dt / f64::from(FINER);
    let fine = Flips::<DirectionF64>::new(&map.parameters.cast(), dt, (f64::from(map.limit) / dt) as u32)?;
    let mut verdict = Judgement::default();
    for (start, point) in map.starts().zip(points) {
        let [a1, a2] = start.map(f64::from);
        let exact = match fine.of(a1, a2)? {
            _ if point.flip == Flip::Never => continue,
            Flip::Never => Flip::Never,
            Flip::After(time) => Flip::After(time as f32),
            Flip::Later => Flip::Later,
        };
        let (wrong, doubtful) = (map.differ(point.flip, exact), map.is_in_doubt(point));
        verdict.points += 1;
        verdict.wrong += usize::from(wrong);
        verdict.doubtful += usize::from(doubtful);
        verdict.unsuspected += usize::from(wrong && !doubtful);
    }
    Ok(verdict)
}

/// The flip of the exact motion, to 30 digits.
fn exact(map: &Map, [a1, a2]: [f32; 2]) -> Flip<f32> {
    let mut motion = Reference::new(&map.parameters.cast(), &Motion::at_rest(a1.into(), a2.into()));
    let mut before = [a1, a2].map(f64::from);
    for look in 1..=(f64::from(map.limit) / LOOKS) as u32 {
        let time = f64::from(look) * LOOKS;
        motion.advance_to(time);
        let after = motion.motion().angles();
        let passed =
            |rod: usize| (after[rod].abs() > PI).then(|| (after[rod].abs() - PI) / (after[rod] - before[rod]).abs());
        if let Some(since) = [0, 1].into_iter().filter_map(passed).reduce(f64::max) {
            return Flip::After((time - since * LOOKS) as f32);
        }
        before = after;
    }
    Flip::Later
}
