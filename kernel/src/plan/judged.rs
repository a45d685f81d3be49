//! A run that knows how wrong it is.

use super::run::{Picture, Run, distance};
use super::scene::{Scene, Twin};
use crate::error::Error;
use crate::form::Form;
use crate::real::Real;
use crate::state::State;

/// How much larger than the twins' distance the rounding error may be. Each is a sample of the same spread; that both
/// fall short k times has a chance of about 1/k^2. Without it one scene of 700 was wrong, with it none was.
const ROUNDING_SAFETY: f32 = 3.0;

/// The step's error over the distance to a run with twice the step. Where the steps resolve the motion it is 1/15 (order
/// 4) or 1/255 (order 8). But they may not, and both runs miss alike what neither sees: none of the gain is counted on.
const SHARE_OF_TWICE: f32 = 1.0;

/// The step's error over the distance to a run with half the step, at worst 16/15 where the steps resolve the motion.
const SHARE_OF_HALF: f32 = 2.0;

/// An error, pixels, by its two causes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Doubt {
    /// By the step.
    pub step: f32,
    /// By rounding, as measured.
    pub rounding: f32,
}

impl Doubt {
    /// What the error is hardly ever more than.
    pub fn bound(self) -> f32 {
        self.step + ROUNDING_SAFETY * self.rounding
    }
}

/// A motion beside one with another step, for the error of the step, and two whose given numbers are off by as
/// much as rounding may make them, for the error of rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Judged<R: Real, F: Form<R>> {
    own: Run<R, F>,
    other_step: Run<R, F>,
    /// The step's error over the distance to `other_step`.
    share: f32,
    twins: [Run<R, F>; 2],
    /// Steps made for each picture over those of the run itself.
    runs: f32,
    rods: [f32; 2],
}

impl<R: Real, F: Form<R>> Judged<R, F> {
    /// From `start`, with `steps` steps for each picture.
    pub fn new(scene: &Scene, start: &State<f64>, steps: u32) -> Self {
        let [own, first, second] = [Twin::None, Twin::Opposite, Twin::Alike].map(|twin| scene.rounded(start, twin));
        // A picture's worth is the longest step there is.
        let (other, share) = if steps > 1 { (steps / 2, SHARE_OF_TWICE) } else { (2, SHARE_OF_HALF) };
        Self {
            own: Run::new(&own, scene.rate, steps),
            other_step: Run::new(&own, scene.rate, other),
            share,
            twins: [&first, &second].map(|twin| Run::new(twin, scene.rate, steps)),
            runs: 3.0 + other as f32 / steps as f32,
            rods: scene.rods(),
        }
    }

    /// Steps made for each picture over those of the run itself.
    pub fn runs(&self) -> f32 {
        self.runs
    }

    /// As [`Run::advance`], one of the runs.
    pub fn advance(&mut self, most: u32) -> Result<bool, Error> {
        let Self { own, other_step, twins: [first, second], .. } = self;
        Ok(own.advance(most)? || other_step.advance(most)? || first.advance(most)? || second.advance(most)?)
    }

    /// The picture that all steps have led to, and how wrong it is.
    pub fn picture(&mut self) -> (Picture, Doubt) {
        let picture = self.own.picture();
        let apart = |other: &mut Run<R, F>| distance(self.rods, &picture, &other.picture());
        let step = self.share * apart(&mut self.other_step);
        let [first, second] = [apart(&mut self.twins[0]), apart(&mut self.twins[1])];
        (picture, Doubt { step, rounding: if first > second { first } else { second } })
    }
}
