//! Looking ahead with one step size: how wrong each way is, picture by picture.

use super::cost::{Costs, Way};
use super::judged::{Doubt, Judged};
use super::run::{Picture, Run, distance};
use super::scene::{Scene, Twin};
use crate::error::Error;
use crate::form::{AngleForm, PictureForm, PictureForm8, Plain};
use crate::modes::Modes;
use crate::small_oscillations::SmallOscillations;
use crate::state::Motion;

/// How a way has fared so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    /// The way.
    pub way: Way,
    /// Steps to a picture.
    pub steps: u32,
    /// Pictures it was right in, from the start on.
    pub right: u32,
    /// The largest error measured in them, pixels.
    pub error: f32,
    /// Whether it has been wrong.
    pub failed: bool,
    /// Whether rounding was the greater part of its own error when it failed: finer steps do not help.
    pub by_rounding: bool,
}

impl Trial {
    fn new(way: Way, steps: u32) -> Self {
        Self { way, steps, right: 0, error: 0.0, failed: false, by_rounding: false }
    }

    /// Takes note of a picture `beside` pixels from the judged one, which itself is in `doubt`. NaN is wrong.
    fn note(&mut self, beside: f32, doubt: Doubt, limit: f32) {
        if self.failed {
            return;
        }
        if beside + doubt.bound() <= limit {
            let error = beside + doubt.step + doubt.rounding;
            self.error = if error > self.error { error } else { self.error };
            self.right += 1;
        } else {
            self.failed = true;
            self.by_rounding = doubt.rounding > doubt.step;
        }
    }
}

/// All ways in `f32` with one step size. The compensated picture form is the best of them and judges the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Single {
    judged: Judged<f32, PictureForm<f32>>,
    plain: Run<f32, PictureForm<f32, Plain>>,
    angle: Run<f32, AngleForm<f32>>,
    linear: Option<SmallOscillations<f32>>,
    rods: [f32; 2],
    trials: [Trial; 4],
}

impl Single {
    /// At the start, with `steps` steps to a picture.
    pub fn new(scene: &Scene, steps: u32) -> Result<Self, Error> {
        let start = scene.rounded::<f32>(Twin::None)?;
        let Motion { a1, a2, w1, w2 } = scene.start;
        let motion = [a1, a2, w1, w2].map(|x| x as f32).into();
        let linear = Modes::new(&start.0).ok().map(|modes| SmallOscillations::new(modes, &motion));
        let ways = [Way::Picture, Way::ClosedForm, Way::PicturePlain, Way::Angle];
        Ok(Self {
            judged: Judged::new(scene, steps)?,
            plain: Run::new(&start, scene.rate, steps)?,
            angle: Run::new(&start, scene.rate, steps)?,
            linear,
            rods: scene.rods(),
            trials: ways.map(|way| Trial::new(way, steps)),
        })
    }

    /// The next picture, at time `t`, s.
    fn advance(&mut self, t: f64, limit: f32) {
        let (picture, doubt) = self.judged.advance();
        let beside = |other: Picture| distance(self.rods, &picture, &other);
        let [own, closed, plain, angle] = &mut self.trials;
        own.note(0.0, doubt, limit);
        if !closed.failed {
            closed.note(self.linear.map_or(f32::INFINITY, |motion| beside(motion.directions(t as f32))), doubt, limit);
        }
        if !plain.failed {
            plain.note(beside(self.plain.advance()), doubt, limit);
        }
        if !angle.failed {
            angle.note(beside(self.angle.advance()), doubt, limit);
        }
    }

    fn cost(&self, costs: &Costs) -> f32 {
        let [own, ..] = self.trials;
        let judged = costs.of_frame(own.way, own.steps) * self.judged.runs();
        let others = self.trials.iter().filter(|trial| trial.way != own.way && !trial.failed);
        others.fold(judged, |sum, trial| sum + costs.of_frame(trial.way, trial.steps))
    }
}

/// The way in `f64` with one step size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    judged: Judged<f64, PictureForm8<f64>>,
    trial: Trial,
}

impl Double {
    /// At the start, with `steps` steps to a picture.
    pub fn new(scene: &Scene, steps: u32) -> Result<Self, Error> {
        Ok(Self { judged: Judged::new(scene, steps)?, trial: Trial::new(Way::Picture8, steps) })
    }
}

/// Looking ahead in one precision with one step size.
#[derive(Clone, Copy, Debug)]
pub(super) enum Look {
    /// In `f32`.
    Single(Single),
    /// In `f64`.
    Double(Double),
}

impl Look {
    /// The next picture, at time `t`, s. A way fails where it may be more than `limit` pixels off.
    pub fn advance(&mut self, t: f64, limit: f32) {
        match self {
            Look::Single(look) => look.advance(t, limit),
            Look::Double(look) => {
                let (_, doubt) = look.judged.advance();
                look.trial.note(0.0, doubt, limit);
            }
        }
    }

    /// How the ways have fared.
    pub fn trials(&self) -> &[Trial] {
        match self {
            Look::Single(look) => &look.trials,
            Look::Double(look) => core::slice::from_ref(&look.trial),
        }
    }

    /// How the way has fared that judges the others.
    pub fn judge(&self) -> &Trial {
        match self {
            Look::Single(Single { trials: [own, ..], .. }) => own,
            Look::Double(look) => &look.trial,
        }
    }

    /// Cycles that the next picture takes.
    pub fn cost(&self, costs: &Costs) -> f32 {
        match self {
            Look::Single(look) => look.cost(costs),
            Look::Double(look) => costs.of_frame(look.trial.way, look.trial.steps) * look.judged.runs(),
        }
    }
}
