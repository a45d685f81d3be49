//! The planner's predictions against the exact motion, over scenes of all kinds, for every
//! processor.

mod ideal_search;
mod scenes;

use std::env;
use std::ops::RangeInclusive;

use double_pendulum::Method;
use double_pendulum::plan::{Plan, PlanError, PlannedRun, Problem, Search, Stepping};
use host_tests::commands::plan::{CHIPS, Chip};
use host_tests::oracle::tolerances::PLAN_SHARE;
use rayon::prelude::*;
use reference::taylor::Reference;
use scenes::Class;

/// The error, in units of half a pixel, of a frame that is wrong by more than half a pixel before
/// the planner's predicted horizon. It has no effect, because the test that uses it allows no such
/// frame.
const PLAN_ERROR: f64 = 0.75;

/// The largest number of scenes out of 2,000 with a frame that is inaccurate before the predicted
/// horizon, and the largest error of such a frame, half pixels.
const VIOLATIONS: usize = 1;
const LARGEST: f64 = 1.5;
/// The smallest ratio of the predicted horizon to the longest true one of any method that a frame
/// can pay for: in the median of the scenes that end early, and for 95 % of them.
///
/// High starts on the fast Cortex-M4F have a median of 0.88, because rounding in 64 bits ends their
/// horizons. With half the assumed rounding error it is 0.90, but then more plans are wrong than
/// [`VIOLATIONS`] allows.
const SHARE: [f64; 2] = [0.8, 0.5];
/// The smallest number of scenes that end early for an assertion about their shares.
const LEAST_ENDING: usize = 20;

/// The number of scenes of each class in the default run.
const SAMPLE: usize = 1;
/// The number of scenes of a class in the long run, for each of its seeds.
const SCENES: usize = 2_000;
const SEEDS: u64 = 3;

/// The number of scenes for each comparison of the reference with another one: in the default run,
/// and in the long one.
const CHECKED: [usize; 2] = [3, 16];
/// The order of the other reference, and the largest distance between the two, half pixels: a
/// hundredth of a pixel.
const OTHER_ORDER: usize = 30;
const REFERENCE_ERROR: f64 = 0.02;

/// The sine and cosine of both angles.
type Directions = [f64; 4];

/// The exact motion, frame by frame as far as it is needed.
struct Exact {
    scene: Problem,
    reference: Reference,
    /// The frames after the start.
    frames: Vec<Directions>,
}

/// Returns the time of frame `frame` of the scene, s since the start, which is frame 0.
fn time(scene: &Problem, frame: u32) -> f64 {
    f64::from(frame) / f64::from(scene.rate)
}

/// Returns the sine and cosine of both angles.
fn directions([a1, a2]: [f64; 2]) -> Directions {
    [libm::sin(a1), libm::cos(a1), libm::sin(a2), libm::cos(a2)]
}

impl Exact {
    fn new(scene: &Problem) -> Self {
        Self {
            scene: *scene,
            reference: Reference::new(&scene.pendulum, &scene.start),
            frames: Vec::new(),
        }
    }

    /// Returns frame `frame`, counted from 1.
    fn frame(&mut self, frame: u32) -> Directions {
        while self.frames.len() < frame as usize {
            let next = self.frames.len() as u32 + 1;
            self.reference.advance_to(time(&self.scene, next));
            self.frames
                .push(directions(self.reference.motion().angles()));
        }
        self.frames[frame as usize - 1]
    }

    /// Returns the error of each frame of a run, half pixels, or `None` if the run is refused. The
    /// errors are infinite after the motion has diverged.
    fn errors(&mut self, stepping: Stepping) -> Option<impl Iterator<Item = f64>> {
        let scene = self.scene;
        let mut run = PlannedRun::new(&scene, stepping).ok()?;
        Some((1..=scene.frames()).map(move |frame| {
            let exact = self.frame(frame);
            match run.advance(1) {
                Ok(()) => distance(&scene, run.directions(), exact),
                Err(_) => f64::INFINITY,
            }
        }))
    }

    /// Returns the number of frames of a run before the first inaccurate one, and its largest error
    /// in the first `until` frames, half pixels. A run that is refused has no accurate frame and an
    /// infinite error; so has a frame after the motion has diverged.
    fn judge(&mut self, stepping: Stepping, until: u32) -> (u32, f64) {
        let Some(errors) = self.errors(stepping) else {
            return (0, f64::INFINITY);
        };
        let mut accurate = 0;
        let mut is_accurate = true;
        let mut largest = 0.0_f64;
        for (frame, error) in (1..).zip(errors) {
            // The count ends with the first inaccurate frame.
            is_accurate &= error <= 1.0;
            accurate += u32::from(is_accurate);
            if frame <= until {
                largest = largest.max(error);
            }
            if !is_accurate && frame >= until {
                break;
            }
        }
        (accurate, largest)
    }

    /// Returns the distance of the reference from a reference of another order, half pixels, in the
    /// last frame that it was used for.
    fn error(&self) -> f64 {
        let Some(last) = self.frames.last() else {
            return 0.0;
        };
        let Problem {
            pendulum, start, ..
        } = &self.scene;
        let mut other = Reference::new(pendulum, start).of_order(OTHER_ORDER);
        other.advance_to(time(&self.scene, self.frames.len() as u32));
        let [sin1, cos1, sin2, cos2] = directions(other.motion().angles());
        distance(&self.scene, [[sin1, cos1], [sin2, cos2]], *last)
    }
}

/// Returns the largest distance of either bob, or of bob 2 as seen from bob 1, from the exact
/// motion, half pixels; infinite if anything is not a number.
fn distance<T: Into<f64>>(scene: &Problem, shown: [[T; 2]; 2], exact: Directions) -> f64 {
    let [l1, l2] = [scene.pendulum.l1, scene.pendulum.l2].map(|l| l / scene.tolerance);
    let [[sin1, cos1], [sin2, cos2]] = shown.map(|direction| direction.map(Into::into));
    let [x1, y1] = [l1 * (sin1 - exact[0]), l1 * (cos1 - exact[1])];
    let [x2, y2] = [l2 * (sin2 - exact[2]), l2 * (cos2 - exact[3])];
    let distances = [x1.hypot(y1), x2.hypot(y2), (x1 + x2).hypot(y1 + y2)];
    if distances.iter().all(|distance| distance.is_finite()) {
        distances.into_iter().fold(0.0, f64::max)
    } else {
        f64::INFINITY
    }
}

/// Returns all methods and step counts that brute force tries: powers of two in 32 bits, as the
/// planner usually takes them, and every tenth to third count in 64 bits.
fn every_stepping() -> Vec<Stepping> {
    let in_64_bits = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16, 20, 24, 32, 48];
    let of = |method| move |steps| Stepping { method, steps };
    in_64_bits
        .into_iter()
        .map(of(Method::Extrapolation10Fixed64))
        .chain(powers().map(of(Method::Rk4Fixed32)))
        .chain(powers().map(of(Method::Rk4F32Direction)))
        .chain([of(Method::ClosedFormF32)(1)])
        .collect()
}

/// Returns the step counts that brute force tries in 32 bits.
fn powers() -> impl Iterator<Item = u32> {
    (0..12).map(|power| 1 << power)
}

/// A scene that is planned for a chip, with the judgement of its plan.
#[derive(Clone, Copy, Debug)]
struct Case {
    scene: Problem,
    /// `None` if no method meets the tolerance.
    plan: Option<Plan>,
    /// The true horizon of the plan, s: the time of its last accurate frame.
    horizon: f64,
    /// The longest true horizon of any method that a frame can pay for, s. It is searched for if
    /// the plan ends early.
    longest: f64,
    /// The longest horizon, s, that planning predicts for one of these methods if it spends its
    /// whole budget on that one, or the horizon of the plan if that is longer. It is searched for
    /// if the plan ends early.
    reachable: f64,
    /// The largest error until the predicted horizon, half pixels.
    error: f64,
}

impl Case {
    /// Plans a scene within the budgets of a chip, and judges the plan.
    fn new(scene: &Problem, chip: &Chip, exact: &mut Exact) -> Self {
        let budget = chip.processor.budget(scene);
        let mut case = Self {
            scene: *scene,
            plan: None,
            horizon: 0.0,
            longest: 0.0,
            reachable: 0.0,
            error: 0.0,
        };
        match Plan::search(scene, &chip.processor.costs, &budget) {
            Ok(plan) => {
                // The plan is judged until its predicted horizon, and further while it is accurate.
                let predicted = (plan.horizon * f64::from(scene.rate)).round() as u32;
                let (accurate, error) = exact.judge(plan.stepping(), predicted);
                case.plan = Some(plan);
                case.horizon = time(scene, accurate);
                case.longest = case.horizon;
                case.reachable = plan.horizon;
                case.error = error;
            }
            Err(PlanError::NoMethod { .. }) => {}
            Err(error) => panic!("{scene:?}: {error}"),
        }
        case
    }

    /// Returns true if there is a plan whose predicted horizon is before the end of the scene.
    fn ends_early(&self) -> bool {
        let frames = |plan: Plan| (plan.horizon * f64::from(self.scene.rate)).round() as u32;
        self.plan
            .is_some_and(|plan| frames(plan) < self.scene.frames())
    }

    /// Returns true if a frame was inaccurate before the predicted horizon.
    fn is_violation(&self) -> bool {
        self.error > 1.0
    }

    /// Returns the shares of the plan and of the reachable horizon, if the plan ends early: these
    /// horizons divided by the longest true one. The result is at most 1, even if a prediction is
    /// too long.
    fn shares(&self) -> Option<[f64; 2]> {
        let plan = self.plan.filter(|_| self.ends_early())?;
        let longest = self.longest.max(self.reachable);
        Some([plan.horizon, self.reachable].map(|horizon| horizon / longest))
    }
}

/// Returns the horizon, s, that the whole planning budget of a chip predicts for one method
/// ([`Search::of`]). It is 0 if the method refuses the motion or no frame is predicted to be
/// accurate.
fn evaluated(stepping: Stepping, scene: &Problem, chip: &Chip) -> f64 {
    let budget = chip.processor.budget(scene);
    let horizon = |steps| {
        let stepping = Stepping { steps, ..stepping };
        let search = Search::of(stepping, scene, &chip.processor.costs, &budget);
        let mut search = search.expect("the scene was planned");
        loop {
            match search.advance(f32::INFINITY) {
                Ok(None) => {}
                Ok(Some(plan)) => return plan.horizon,
                Err(_) => return 0.0,
            }
        }
    };
    // The closed form has no steps. Its step count belongs to the run that it is compared with.
    if stepping.method == Method::ClosedFormF32 {
        powers().map(horizon).fold(0.0, f64::max)
    } else {
        horizon(stepping.steps)
    }
}

/// Plans a scene for every chip and runs the plans. With `by_force`, searches the longest true
/// horizon and the longest reachable one. With `is_checked`, compares the reference with another
/// one.
fn judged(scene: &Problem, by_force: bool, is_checked: bool) -> Vec<Case> {
    let mut exact = Exact::new(scene);
    let mut cases: Vec<_> = CHIPS
        .iter()
        .map(|chip| Case::new(scene, chip, &mut exact))
        .collect();
    if by_force && cases.iter().any(Case::ends_early) {
        for stepping in every_stepping() {
            let is_affordable = |chip: &Chip| {
                chip.processor.costs.of_frame(stepping) <= chip.processor.budget(scene).frame
            };
            let needed = |case: &Case, chip: &Chip| case.ends_early() && is_affordable(chip);
            // A method is run only for chips that can pay for it.
            if !cases
                .iter()
                .zip(&CHIPS)
                .any(|(case, chip)| needed(case, chip))
            {
                continue;
            }
            let horizon = time(scene, exact.judge(stepping, 0).0);
            for (case, chip) in cases.iter_mut().zip(&CHIPS) {
                if needed(case, chip) {
                    case.longest = case.longest.max(horizon);
                    // A prediction is hardly ever longer than the true horizon, so that other
                    // methods cannot raise it.
                    if horizon > case.reachable {
                        let reachable = evaluated(stepping, scene, chip);
                        case.reachable = case.reachable.max(reachable);
                    }
                }
            }
        }
    }
    if is_checked {
        let error = exact.error();
        assert!(error < REFERENCE_ERROR, "{scene:?}: {error}");
    }
    cases
}

/// The results of a chip.
struct Results {
    /// The number of plans that end early.
    ending: usize,
    /// The median and the 5 % quantile of the [shares](Case::shares) of these plans.
    planned: [f64; 2],
    /// The same of the reachable horizons. It equals `planned` without brute force.
    reachable: [f64; 2],
}

impl Results {
    fn new(cases: &[&Case]) -> Self {
        let shares: Vec<_> = cases.iter().filter_map(|case| case.shares()).collect();
        Self {
            ending: shares.len(),
            planned: quantiles(shares.iter().map(|[planned, _]| *planned)),
            reachable: quantiles(shares.iter().map(|[_, reachable]| *reachable)),
        }
    }
}

/// Returns the median and the 5 % quantile; 1 if there are no numbers.
fn quantiles(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut sorted: Vec<_> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    [0.5, 0.05].map(|quantile| {
        let place = (quantile * sorted.len() as f64) as usize;
        sorted.get(place).copied().unwrap_or(1.0)
    })
}

/// Studies scenes on every chip and prints a line for each. Allows `most` violations, each of at
/// most `largest` half pixels.
fn study(
    name: &str,
    scenes: &[Problem],
    by_force: bool,
    (most, largest): (usize, f64),
) -> Vec<Results> {
    let [often, rarely] = CHECKED;
    let checked = if by_force { rarely } else { often };
    let cases: Vec<_> = scenes
        .par_iter()
        .enumerate()
        .map(|(i, scene)| judged(scene, by_force, i % checked == 0))
        .collect();

    // The results of one chip.
    let of_chip = |(i, chip): (usize, &Chip)| {
        let cases: Vec<_> = cases.iter().map(|cases| &cases[i]).collect();
        let violations: Vec<_> = cases.iter().filter(|case| case.is_violation()).collect();
        let error = cases.iter().map(|case| case.error).fold(0.0, f64::max);
        let nothing = cases.iter().filter(|case| case.plan.is_none()).count();
        let results = Results::new(&cases);

        // A line of the README's table. Only brute force knows the reachable horizons.
        let [median, least] = results.planned;
        print!(
            "| {name} | {} | {nothing} | {} | {} | {error:.2} | {median:.2} | {least:.2} |",
            chip.title,
            results.ending,
            violations.len(),
        );
        if by_force {
            let [median, least] = results.reachable;
            print!(" {median:.2} | {least:.2} |");
        }
        println!();
        assert!(
            violations.len() <= most && violations.iter().all(|case| case.error <= largest),
            "{name}, {}: {violations:#?}",
            chip.name
        );
        results
    };
    CHIPS.iter().enumerate().map(of_chip).collect()
}

/// A scene of every class, three with a long horizon, and the scenes that were once wrong are
/// planned for each processor. No frame until the predicted horizon may be wrong by more than half
/// a pixel. At least ten plans of each processor must end early, and the median of their predicted
/// horizons must be at least 0.7 ([`PLAN_SHARE`]) of the plan's true one. The reference must agree
/// with one of another order to a hundredth of a pixel.
#[test]
fn half_a_pixel_is_kept_until_the_predicted_horizon() {
    let sample = Class::ALL
        .into_iter()
        .flat_map(|class| class.scenes(0).take(SAMPLE));
    let scenes: Vec<_> = scenes::hard()
        .chain(scenes::long().step_by(2))
        .chain(sample)
        .collect();
    for results in study("sample", &scenes, false, (0, PLAN_ERROR)) {
        let [share, _] = results.planned;
        assert!(results.ending >= 10 && share >= PLAN_SHARE, "{share}");
    }
}

/// No frame of a scene with a short rod 2 is wrong by more than half a pixel before the predicted
/// horizon, on any processor. On the two fast ones five plans or more end early, and the median of
/// their horizons is at least [`PLAN_SHARE`] of the plan's true one.
#[test]
fn short_rods_keep_their_horizons() {
    let scenes: Vec<_> = scenes::short_rods().collect();
    let results = study("short rods", &scenes, false, (0, PLAN_ERROR));
    for results in &results[..2] {
        let [share, _] = results.planned;
        assert!(results.ending >= 5 && share >= PLAN_SHARE, "{share}");
    }
}

/// Scenes of the broad class with very unlike masses: the seed, the index, the processor, and the
/// smallest allowed predicted horizon, s. Without the following rules of the search, the predicted
/// horizons were less than 0.83 of these, most of them less than two thirds.
///
/// In the first scene planning can only pay for one finer run. In the next two, the budgets do not
/// pay for steps of 4 admissible steps, and longer ones are accurate enough. In the next three, a
/// reference would use up the planning budget in a small part of the scene. In the next two, fixed
/// point refuses all steps that a frame can pay for, but a frame can pay for `f32`. In the second
/// of these, planning cannot pay for steps of 64 admissible steps, but a frame can.
///
/// In the other scenes a frame cannot pay for 64 bits. In the first two of them it can only pay for
/// steps of more than 64 admissible steps. In the next one it can pay for 13 steps, but not for 16.
/// In the next three, finer steps help although rounding seems to be the larger error. In the last
/// one, `f32` helps after fixed point.
const UNLIKE: [(u64, usize, &str, f64); 15] = [
    (1, 22, "m3", 2.9),
    (1, 32, "slow-m4f", 16.4),
    (1, 45, "slow-m4f", 12.1),
    (1, 58, "m4f", 2.5),
    (1, 128, "m4f", 20.4),
    (1, 147, "m4f", 4.8),
    (1, 18, "pico", 4.9),
    (1, 22, "pico", 2.9),
    (7, 33, "m3", 12.9),
    (7, 208, "pico", 10.3),
    (7, 205, "m3", 1.5),
    (7, 51, "m4f", 1.9),
    (7, 209, "m4f", 8.1),
    (7, 65, "slow-m4f", 4.6),
    (7, 275, "pico", 2.7),
];

/// Plans of scenes with very unlike masses have at least the horizons of [`UNLIKE`], and errors of
/// at most [`PLAN_ERROR`] half pixels until then.
#[test]
fn unlike_masses_keep_their_horizons() {
    for (seed, index, name, least) in UNLIKE {
        assert_horizon(Class::Broad, (seed, index), name, least);
    }
}

/// Asserts that the plan of a scene, with this seed and index, has at least the predicted horizon
/// `least`, s, on a processor, and errors of at most [`PLAN_ERROR`] half pixels until then.
fn assert_horizon(class: Class, (seed, index): (u64, usize), name: &str, least: f64) {
    let scene = class.scenes(seed).nth(index).expect("no end");
    let chip = CHIPS.iter().find(|chip| chip.name == name).expect("a chip");
    let case = Case::new(&scene, chip, &mut Exact::new(&scene));
    let horizon = case.plan.map_or(0.0, |plan| plan.horizon);
    assert!(
        horizon >= least && case.error <= PLAN_ERROR,
        "{seed} {index}, {name}: {case:?}"
    );
}

/// With high starts, planning is spent on 64 bits: in the first three scenes after fast growth of
/// errors in a trial with three finer runs, in the other two after finer steps in 32 bits have
/// gained little. Without these rules the predicted horizons were 16.4, 17.4, 18.5, 8.9 and 8.8 s.
#[test]
fn high_starts_keep_their_horizons() {
    for (seed, index, name, least) in [
        (7, 5, "m3", 20.8),
        (7, 41, "slow-m4f", 25.1),
        (7, 84, "pico", 26.3),
        (2, 29, "slow-m4f", 11.7),
        (2, 44, "slow-m4f", 12.4),
    ] {
        assert_horizon(Class::High, (seed, index), name, least);
    }
}

/// In a small oscillation with a heavy bob 2 on a short rod, no steps that a frame of a Cortex-M0+
/// can pay for are accurate enough to show how long the closed form is accurate. Finer steps, which
/// cost more than a frame, show that it is for at least 4 s.
#[test]
fn steps_beyond_the_frame_budget_measure_the_closed_form() {
    let scene = Class::Heavy.scenes(7).nth(99).expect("no end");
    let chip = CHIPS
        .iter()
        .find(|chip| chip.name == "pico")
        .expect("a chip");
    let case = Case::new(&scene, chip, &mut Exact::new(&scene));
    let plan = case.plan.expect("a plan");
    assert_eq!(plan.method, Method::ClosedFormF32);
    assert!(plan.horizon >= 4.0 && !case.is_violation(), "{case:?}");
}

/// Near upright, with a heavy bob 2, a frame of the slow processors cannot pay for steps in 64 bits
/// that resolve every motion of the energy, and 32 bits of fixed point are not trusted. Longer
/// steps in 64 bits are tried: of 30 scenes at most one has no method on a Cortex-M3, and at most
/// three on a Cortex-M0+. No frame is wrong by more than half a pixel before the predicted horizon.
#[test]
fn motions_near_upright_have_a_method() {
    for (name, most) in [("m3", 1), ("pico", 3)] {
        let chip = CHIPS.iter().find(|chip| chip.name == name).expect("a chip");
        let cases: Vec<_> = Class::Upright
            .scenes(1)
            .take(30)
            .map(|scene| Case::new(&scene, chip, &mut Exact::new(&scene)))
            .collect();
        let nothing = cases.iter().filter(|case| case.plan.is_none()).count();
        assert!(nothing <= most, "{name}: {nothing}");
        assert!(!cases.iter().any(Case::is_violation), "{cases:#?}");
    }
}

/// Returns the number of scenes and the seeds of a long run. The environment variables
/// `SCENES=200 SEED=1` select fewer scenes or a single seed. A value that is no number is ignored.
fn in_environment() -> (usize, RangeInclusive<u64>) {
    let number = |name: &str| {
        env::var(name)
            .ok()
            .and_then(|text| text.parse::<u64>().ok())
    };
    let count = number("SCENES").map_or(SCENES, |count| count as usize);
    let seeds = number("SEED").map_or(1..=SEEDS, |seed| seed..=seed);
    (count, seeds)
}

/// Studies a whole class. At most [`VIOLATIONS`] plans for each processor and seed may have an
/// inaccurate frame before the predicted horizon, of at most [`LARGEST`] half pixels.
///
/// The shares of the horizons must be at least [`SHARE`] if [`LEAST_ENDING`] plans or more end
/// early. This is a known failure of all classes but high starts. Most plans end early because
/// their planning budget is used up: the cycles that a board can spare while it plays the scene.
/// The reachable shares are those of a plan that measures a single method as the planner does. They
/// are no upper limit: a search knows a horizon from earlier trials, and needs a reference only for
/// that long. The study [`ideal_search`] measures a search that knows the best method.
///
/// `cargo test -p host-tests --test kernel plan_study::thousands --
/// --ignored --nocapture` prints the README's table.
///
/// The environment variables `SCENES=200 SEED=1` select fewer scenes.
fn thousands(class: Class) {
    let (count, seeds) = in_environment();
    println!(
        "| class, seed | processor | no method | end early | violations | largest error \
        | median share | 5 % | median reachable | 5 % |"
    );
    let mut short = Vec::new();
    let mut compared = 0;
    for seed in seeds {
        let scenes: Vec<_> = class.scenes(seed).take(count).collect();
        let name = format!("{class:?}, {seed}");
        for results in study(&name, &scenes, true, (VIOLATIONS, LARGEST)) {
            // The median and the 5 % quantile of the shares must be large enough.
            let shares = results.planned;
            let is_long = shares
                .iter()
                .zip(SHARE)
                .all(|(share, least)| *share >= least);
            if results.ending >= LEAST_ENDING {
                compared += 1;
                if !is_long {
                    short.push((name.clone(), shares));
                }
            }
        }
    }

    // The shares of all other classes are a known failure, which must show.
    if class == Class::High {
        assert!(short.is_empty(), "the shares are too small: {short:?}");
    } else {
        assert!(compared == 0 || !short.is_empty(), "no share is too small");
    }
}

/// A long test for each class, so that they can be run one by one.
macro_rules! thousands {
    ($($name:ident $class:ident)*) => {$(
        #[test]
        #[ignore = "an hour"]
        fn $name() {
            thousands(Class::$class);
        }
    )*};
}

thousands! {
    thousands_of_broad Broad
    thousands_of_high High
    thousands_of_upright Upright
    thousands_of_heavy Heavy
    thousands_of_light Light
    thousands_of_fast Fast
    thousands_of_odd Odd
}
