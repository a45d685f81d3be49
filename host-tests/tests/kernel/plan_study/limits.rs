//! The longest horizons that planning could verify if it knew the best method from the start.
//!
//! This is an upper limit for every search that verifies a method by comparing its run with other
//! runs. The ideal search of this study spends its whole budget on one method and its comparison,
//! and a comparison shows the exact error.

use double_pendulum::Method;
use double_pendulum::plan::{PlannedRun, Problem, Stepping};
use host_tests::commands::plan::{CHIPS, Chip};
use rayon::prelude::*;

use super::scenes::Class;
use super::{Case, Exact, LEAST_ENDING, distance, every_stepping, in_environment, quantiles, time};

/// The wanted 5 % quantile of the predicted horizons, divided by the longest true ones.
const WANTED: f64 = 0.75;

/// The largest error of a run in 64 bits that others may be compared with, half pixels.
const REFERENCE_ERROR: f64 = 0.15;

/// The steps per frame of the runs in 64 bits that others may be compared with, in addition to
/// those that a frame can pay for.
const FINE: [u32; 5] = [64, 96, 128, 192, 256];

/// The comparisons of a run in 32 bits with three, two and one finer runs: their cost, that of the
/// run included, in costs of the run, and the largest error that they can verify, half pixels.
///
/// The finer runs have 5/4, 6/4 and 7/4 of the steps. With three of them every error up to half a
/// pixel counts as verified. With two or one, the planner's bounds are 15 and 550 times the largest
/// distance. A fifth and a fiftieth allow for distances that are much smaller than the error.
const FINER_RUNS: [(f32, f64); 3] = [(5.5, 1.0), (3.75, 0.2), (2.25, 0.02)];

/// The comparison of a run in 64 bits with one in 3/4 of its steps.
const COARSER_RUN: [(f32, f64); 1] = [(1.75, 1.0)];

/// A method and step count with the largest error until each frame, half pixels, until the first
/// inaccurate frame.
struct Measured {
    stepping: Stepping,
    errors: Vec<f64>,
}

impl Measured {
    fn new(stepping: Stepping, exact: &mut Exact) -> Self {
        let mut errors = Vec::new();
        let mut largest = 0.0_f64;
        if let Ok(mut run) = PlannedRun::new(&exact.scene, stepping) {
            for frame in 1..=exact.scene.frames() {
                let shown = exact.frame(frame);
                if run.advance(1).is_err() {
                    break;
                }
                largest = largest.max(distance(&exact.scene, run.directions(), shown));
                if largest > 1.0 {
                    break;
                }
                errors.push(largest);
            }
        }
        Self { stepping, errors }
    }

    fn is_in_64_bits(&self) -> bool {
        self.stepping.method == Method::Extrapolation10Fixed64
    }

    /// Returns the number of frames with errors of at most `most` half pixels.
    fn frames(&self, most: f64) -> u32 {
        self.errors.partition_point(|error| *error <= most) as u32
    }
}

/// Returns the number of frames that the ideal search verifies on a chip, and the longest true
/// horizon of any method that a frame can pay for, frames.
fn verifiable(all: &[Measured], scene: &Problem, chip: &Chip) -> [u32; 2] {
    let budget = chip.processor.budget(scene);
    let cost = |one: &Measured| chip.processor.costs.of_frame(one.stepping);
    let paid = |cost: f32| (budget.planning / cost) as u32;

    let mut verified = 0;
    let mut longest = 0;
    for one in all.iter().filter(|one| cost(one) <= budget.frame) {
        let accurate = one.frames(1.0);
        longest = longest.max(accurate);

        // The closed form costs almost nothing.
        if one.stepping.method == Method::ClosedFormF32 {
            verified = verified.max(accurate);
            continue;
        }

        // Compare it with one run in 64 bits.
        for reference in all.iter().filter(|other| other.is_in_64_bits()) {
            let frames = accurate.min(reference.frames(REFERENCE_ERROR));
            verified = verified.max(frames.min(paid(cost(one) + cost(reference))));
        }

        // Compare it with runs of the same method.
        let comparisons = if one.is_in_64_bits() {
            COARSER_RUN.as_slice()
        } else {
            &FINER_RUNS
        };
        for &(runs, most) in comparisons {
            verified = verified.max(one.frames(most).min(paid(runs * cost(one))));
        }
    }
    [verified, longest]
}

/// Returns the share of the longest horizon that the ideal search verifies on each chip. It is
/// `None` if the plan of the real search or of the ideal one reaches the end of the scene.
fn shares(scene: &Problem) -> Vec<Option<f64>> {
    let mut exact = Exact::new(scene);
    let ends_early = CHIPS
        .each_ref()
        .map(|chip| Case::new(scene, chip, &mut exact).ends_early());
    if !ends_early.contains(&true) {
        return vec![None; CHIPS.len()];
    }

    let fine = FINE.map(|steps| Stepping {
        method: Method::Extrapolation10Fixed64,
        steps,
    });
    let all: Vec<_> = every_stepping()
        .into_iter()
        .chain(fine)
        .map(|stepping| Measured::new(stepping, &mut exact))
        .collect();
    CHIPS
        .iter()
        .zip(ends_early)
        .map(|(chip, ends_early)| {
            let [verified, longest] = verifiable(&all, scene, chip);
            let is_early = ends_early && verified < scene.frames();
            is_early.then(|| time(scene, verified) / time(scene, longest))
        })
        .collect()
}

/// Even the ideal search cannot give 95 % of the scenes that end early three quarters of their
/// longest horizon: the planning budgets, which are the cycles that a board can spare while it
/// plays the scene, are too small. This is a known failure on every processor.
///
/// `SEED=1 cargo test -p host-tests --test kernel limits:: -- --ignored --nocapture` prints the
/// numbers of the README. `SCENES=200` selects fewer scenes.
#[test]
#[ignore = "ten minutes"]
fn planning_is_too_short_for_the_wanted_horizons() {
    let (count, seeds) = in_environment();
    println!("| class, seed | processor | end early | median | 5 % |");
    for seed in seeds {
        let scenes: Vec<_> = Class::Broad.scenes(seed).take(count).collect();
        let all: Vec<_> = scenes.par_iter().map(shares).collect();
        for (i, chip) in CHIPS.iter().enumerate() {
            let ending = all.iter().filter_map(|shares| shares[i]);
            let number = ending.clone().count();
            let [median, least] = quantiles(ending);
            println!(
                "| {:?}, {seed} | {} | {number} | {median:.2} | {least:.2} |",
                Class::Broad,
                chip.title
            );
            assert!(number < LEAST_ENDING || least < WANTED, "{}", chip.name);
        }
    }
}
