//! Looking ahead with one step size: how wrong each way is, picture by picture.

use super::cost::{Costs, Way};
use super::judged::{Doubt, Judged};
use super::run::{Picture, Run, distance};
use super::scene::{Scene, Twin};
use crate::error::Error;
use crate::form::{AngleForm, PictureForm, PictureForm8, Plain};
use crate::modes::Modes;
use crate::small_oscillations::SmallOscillations;
use crate::state::State;

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
    /// Whether rounding made its bound when it failed: finer steps do not help.
    pub by_rounding: bool,
}

impl Trial {
    /// At the start.
    pub fn new(way: Way, steps: u32) -> Self {
        Self { way, steps, right: 0, error: 0.0, failed: false, by_rounding: false }
    }

    /// Takes note of a picture `beside` pixels from the judged one, which itself is in `doubt`. NaN is wrong.
    fn note(&mut self, beside: f32, doubt: Doubt, limit: f32) {
        if self.failed {
            return;
        }
        if beside + doubt.bound() <= limit {
            let error = beside + doubt.error();
            self.error = if error > self.error { error } else { self.error };
            self.right += 1;
        } else {
            self.failed = true;
            self.by_rounding = doubt.is_by_rounding();
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
    /// From `start`, with `steps` steps to a picture.
    pub fn new(scene: &Scene, start: &State<f64>, steps: u32) -> Self {
        let rounded = scene.rounded::<f32>(start, Twin::None);
        let (parameters, _) = &rounded;
        let motion = <[f64; 4]>::from(scene.start).map(|x| x as f32).into();
        let linear = Modes::new(parameters).ok().map(|modes| SmallOscillations::new(modes, &motion));
        let ways = [Way::Picture, Way::ClosedForm, Way::PicturePlain, Way::Angle];
        Self {
            judged: Judged::from_state(scene, start, steps),
            plain: Run::new(&rounded, scene.rate, steps),
            angle: Run::new(&rounded, scene.rate, steps),
            linear,
            rods: scene.rods(),
            trials: ways.map(|way| Trial::new(way, steps)),
        }
    }

    /// As [`Look::advance`].
    fn advance(&mut self, costs: &Costs, cycles: f32) -> Result<bool, Error> {
        let [_, _, plain, angle] = &self.trials;
        let most = |way: Way| steps_for(costs, way, cycles);
        Ok(self.judged.advance(most(Way::Picture))?
            || !plain.failed && self.plain.advance(most(Way::PicturePlain))?
            || !angle.failed && self.angle.advance(most(Way::Angle))?)
    }

    /// As [`Look::compare`].
    fn compare(&mut self, t: f64, limit: f32) {
        let (picture, doubt) = self.judged.picture();
        let beside = |other: Picture| distance(self.rods, &picture, &other);
        let [own, closed, plain, angle] = &mut self.trials;
        own.note(0.0, doubt, limit);
        if !closed.failed {
            closed.note(self.linear.map_or(f32::INFINITY, |motion| beside(motion.directions(t as f32))), doubt, limit);
        }
        if !plain.failed {
            plain.note(beside(self.plain.picture()), doubt, limit);
        }
        if !angle.failed {
            angle.note(beside(self.angle.picture()), doubt, limit);
        }
    }

    fn cost(&self, costs: &Costs) -> f32 {
        let [own, ..] = self.trials;
        let judged = costs.of_frame(own.way, own.steps) * Judged::<f32, PictureForm<f32>>::RUNS;
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
    /// From `start`, with `steps` steps to a picture.
    pub fn new(scene: &Scene, start: &State<f64>, steps: u32) -> Self {
        Self { judged: Judged::from_state(scene, start, steps), trial: Trial::new(Way::Picture8, steps) }
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
    /// Makes steps of one motion towards the next picture, as many as `cycles` pay for and one at least, or prepares
    /// them. `false` if there is nothing left to do.
    pub fn advance(&mut self, costs: &Costs, cycles: f32) -> Result<bool, Error> {
        match self {
            Look::Single(look) => look.advance(costs, cycles),
            Look::Double(look) => look.judged.advance(steps_for(costs, look.trial.way, cycles)),
        }
    }

    /// Compares the pictures at time `t`, s, when all steps towards them are made. A way fails where it may be more than
    /// `limit` pixels off.
    pub fn compare(&mut self, t: f64, limit: f32) {
        match self {
            Look::Single(look) => look.compare(t, limit),
            Look::Double(look) => {
                let (_, doubt) = look.judged.picture();
                look.trial.note(0.0, doubt, limit);
            }
        }
    }

    /// Looks at `way` alone, beside what judges it.
    pub fn only(&mut self, way: Way) {
        if let Look::Single(look) = self {
            look.trials.iter_mut().filter(|trial| trial.way != way).for_each(|trial| trial.failed = true);
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

    /// Cycles of the dearest of the steps that are made.
    pub fn dearest_step(&self, costs: &Costs) -> f32 {
        let steps = self.trials().iter().filter(|trial| trial.way != Way::ClosedForm && !trial.failed);
        let judge = costs.of_frame(self.judge().way, 1);
        steps.map(|trial| costs.of_frame(trial.way, 1)).fold(judge, f32::max)
    }

    /// Cycles that the next picture takes.
    pub fn cost(&self, costs: &Costs) -> f32 {
        match self {
            Look::Single(look) => look.cost(costs),
            Look::Double(look) => {
                costs.of_frame(look.trial.way, look.trial.steps) * Judged::<f64, PictureForm8<f64>>::RUNS
            }
        }
    }
}

/// How many steps of `way` these `cycles` pay for, one at least.
fn steps_for(costs: &Costs, way: Way, cycles: f32) -> u32 {
    let steps = (cycles / costs.of_frame(way, 1)) as u32;
    if steps > 0 { steps } else { 1 }
}
