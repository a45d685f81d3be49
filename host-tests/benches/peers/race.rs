//! Running in turns, at the effort an error asks for.

use std::hint::black_box;
use std::iter::successors;
use std::time::Instant;

use crate::contestants::{Contestant, PARTS, Scene};

/// Runs of each, in turns; the fastest counts.
const ROUNDS: usize = 200;

/// A contestant with its effort, what it errs by, rad, and the fastest time.
pub struct Entry {
    pub contestant: &'static Contestant,
    pub effort: u32,
    pub error: f64,
    pub time: f64,
}

impl Entry {
    /// In proportion to the time that RK4 would need for an error that all share: the error falls with the fourth power
    /// of the number of steps.
    pub fn time_at_equal_error(&self) -> f64 {
        self.time * self.error.powf(0.25)
    }
}

/// Every contestant at one effort.
pub fn at_effort(contestants: &'static [Contestant], scene: &Scene, effort: u32) -> Vec<Entry> {
    let exact = scene.exact();
    let entry = |contestant: &'static Contestant| Entry {
        contestant,
        effort,
        error: contestant.error(scene, &exact, effort),
        time: f64::INFINITY,
    };
    contestants.iter().map(entry).collect()
}

/// Every contestant at the least effort that errs by at most `error`, rad; those that never do are left out.
pub fn at_error(contestants: &'static [Contestant], scene: &Scene, error: f64) -> Vec<Entry> {
    let exact = scene.exact();
    let least = |contestant: &'static Contestant| {
        let efforts =
            successors(Some(4), |effort| Some(effort + 1 + effort / 128)).take_while(|&next| next <= contestant.most);
        let mut tries = efforts.map(|effort| (effort, contestant.error(scene, &exact, effort)));
        let (effort, error) = tries.find(|&(_, found)| found <= error)?;
        Some(Entry { contestant, effort, error, time: f64::INFINITY })
    };
    contestants.iter().filter_map(least).collect()
}

/// Runs the whole scene with all entries in turns and notes the fastest time of each.
pub fn run(entries: &mut [Entry], scene: &Scene) {
    for _ in 0..ROUNDS {
        for entry in entries.iter_mut() {
            let start = Instant::now();
            black_box((entry.contestant.run)(scene, PARTS, black_box(entry.effort)));
            entry.time = start.elapsed().as_secs_f64().min(entry.time);
        }
    }
}
