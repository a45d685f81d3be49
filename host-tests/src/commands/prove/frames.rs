//! The frames a method draws, held against the exact motion.

use double_pendulum::Error;
use double_pendulum::plan::{PlannedRun, Problem, Way};

use crate::prove::{Enclosure, Verdict};

/// What is proved of a method's frames.
#[derive(Clone, Debug)]
pub struct Proof {
    /// How the frames are computed.
    pub way: Way,
    motion: PlannedRun,
    /// So many frames are right, from the start on.
    pub right: u32,
    /// The first one that is wrong.
    pub wrong: Option<u32>,
    /// Frames until then, or until now, of which neither can be proved.
    pub open: u32,
}

impl Proof {
    /// Of nothing yet.
    pub fn new(scene: &Problem, way: Way) -> Result<Self, Error> {
        let motion = PlannedRun::new(&scene.pendulum, &scene.start, scene.rate, way)?;
        Ok(Self { way, motion, right: 0, wrong: None, open: 0 })
    }

    fn judge(&mut self, scene: &Problem, frame: u32, set: &Enclosure) -> Verdict {
        let _is_lost = self.motion.advance(1);
        let shown = self.motion.directions().map(|direction| direction.map(f64::from));
        let verdict = set.verdict(&shown, [scene.pendulum.l1, scene.pendulum.l2], scene.tolerance);
        match verdict {
            _ if self.wrong.is_some() => {}
            Verdict::Right => self.right = if self.right + 1 == frame { frame } else { self.right },
            Verdict::Open => self.open += 1,
            Verdict::Wrong => self.wrong = Some(frame),
        }
        verdict
    }
}

/// Judges every frame until a wrong one in each of `proofs`, or as long as the motion can be followed and `goes_on`, which is told
/// the set that it is in and the verdicts. How many frames.
pub fn follow<E>(
    scene: &Problem,
    mut set: Enclosure,
    proofs: &mut [Proof],
    mut goes_on: impl FnMut(u32, &Enclosure, &[Verdict]) -> Result<bool, E>,
) -> Result<u32, E> {
    for frame in 1..=scene.frames() {
        if proofs.iter().all(|proof| proof.wrong.is_some()) || set.advance().is_err() {
            return Ok(frame - 1);
        }
        let verdicts: Vec<_> = proofs.iter_mut().map(|proof| proof.judge(scene, frame, &set)).collect();
        if !goes_on(frame, &set, &verdicts)? {
            return Ok(frame);
        }
    }
    Ok(scene.frames())
}
