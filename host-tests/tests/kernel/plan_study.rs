//! The planner's predictions against the exact motion, over random scenes of all kinds, for every
//! processor.
//!
//! The ignored tests judge thousands of scenes of a class and print a line for each processor.
//! `CHIP=m3 SEED=201 SCENES=2000` selects one processor, one seed, and the number of scenes:
//!
//! ```text
//! CHIP=m3 SEED=201 SCENES=2000 cargo test --release -p host-tests --test kernel \
//!     plan_study::thousands_of_high -- --ignored --nocapture
//! ```

use std::env;
use std::f64::consts::PI;

use double_pendulum::plan::{Plan, PlanError, Problem};
use double_pendulum::{Motion, Parameters};
use exact::random::{log_uniform, symmetric};
use exact::taylor::Reference;
use fastrand::Rng;
use firmware::config::GRAVITY;
use firmware::motion::half_pixel;
use host_tests::plan::{CHIPS, Chip};
use rayon::prelude::*;

/// The largest number of scenes out of 2,000 with a frame that is inaccurate before the predicted
/// horizon, and the largest error of such a frame, half pixels.
const VIOLATIONS: usize = 1;
const LARGEST: f64 = 1.5;

/// The largest number of frames of a scene with an odd frame rate, so that the study ends.
const MOST_FRAMES: f64 = 3_000.0;
/// The smallest amplitude, rad.
const LEAST: f64 = 0.01;

/// A kind of scene.
///
/// Bob 1 has 1 kg and rod 1 has 1 m. Since gravity is given, only the ratios matter. `log` means
/// evenly distributed in the logarithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    /// Mass ratio m2/m1 1e-3 to 1e3, length ratio l2/l1 1e-2 to 1e2, 2 to 30 s: log.
    ///
    /// - Amplitude 0.01 to pi rad: every other one log, the others evenly.
    /// - One angle is as large as the amplitude. The other one is equal to it in every third scene,
    ///   and at most as large in the other scenes.
    /// - Every other scene starts at rest. The others start with velocities up to a share of the
    ///   largest ones: 20 times the rod's own sqrt(g/l), at most 60 rad/s. The share of 0.01 to 1
    ///   has the same distribution as the amplitude.
    Broad,
    /// A start at rest with both rods at 1.5 to 3.3 rad, to either side. Mass ratio 1 to 10 and
    /// length ratio 0.5 to 2, log. 30 s.
    High,
    /// A start at rest with one rod or both within 1e-10 to 1e-7 rad of upright, log, and the other
    /// rod hanging. Mass ratio 1e-2 to 1e2 and length ratio 0.1 to 10, log.
    Upright,
    /// The class [`Broad`](Self::Broad) with mass ratios of 10 to 1000.
    Heavy,
    /// The class [`Broad`](Self::Broad) with mass ratios of 1e-3 to 0.1.
    Light,
    /// The class [`Broad`](Self::Broad) with mass ratios of 0.1 to 10, length ratios of 0.3 to 3,
    /// and velocities of -60 to 60 rad/s, evenly.
    Fast,
    /// The class [`Broad`](Self::Broad) with 1 to 3000 frames per second and heights of 32 to 1e5
    /// pixels, log. At most [`MOST_FRAMES`].
    Odd,
}

impl Class {
    const ALL: [Self; 7] = [
        Self::Broad,
        Self::High,
        Self::Upright,
        Self::Heavy,
        Self::Light,
        Self::Fast,
        Self::Odd,
    ];

    /// Returns the scenes of this class, without end.
    fn scenes(self, seed: u64) -> impl Iterator<Item = Problem> {
        let mut rng = Rng::with_seed(seed);
        std::iter::repeat_with(move || self.scene(&mut rng))
    }

    /// Returns the next random scene of this class.
    fn scene(self, rng: &mut Rng) -> Problem {
        let ([least_mass, greatest_mass], [least_length, greatest_length]) = match self {
            Self::Broad | Self::Odd => ([1e-3, 1e3], [1e-2, 1e2]),
            Self::High => ([1.0, 10.0], [0.5, 2.0]),
            Self::Upright => ([1e-2, 1e2], [0.1, 10.0]),
            Self::Heavy => ([10.0, 1e3], [1e-2, 1e2]),
            Self::Light => ([1e-3, 0.1], [1e-2, 1e2]),
            Self::Fast => ([0.1, 10.0], [0.3, 3.0]),
        };
        let pendulum = Parameters {
            m1: 1.0,
            m2: log_uniform(rng, least_mass, greatest_mass),
            l1: 1.0,
            l2: log_uniform(rng, least_length, greatest_length),
            g: GRAVITY,
        };
        let start = match self {
            Self::High => {
                let mut angle = || (1.5 + 1.8 * rng.f64()) * if rng.bool() { 1.0 } else { -1.0 };
                Motion::at_rest(angle(), angle())
            }
            Self::Upright => {
                let mut upright =
                    || PI + log_uniform(rng, 1e-10, 1e-7) * if rng.bool() { 1.0 } else { -1.0 };
                let [a1, a2] = [upright(), upright()];
                match rng.u8(0..3) {
                    0 => Motion::at_rest(a1, a2),
                    1 => Motion::at_rest(a1, 0.0),
                    _ => Motion::at_rest(0.0, a2),
                }
            }
            Self::Fast => Motion {
                w1: 60.0 * symmetric(rng),
                w2: 60.0 * symmetric(rng),
                ..swing(rng)
            },
            Self::Broad | Self::Heavy | Self::Light | Self::Odd => {
                let start = swing(rng);
                pushed(rng, &pendulum, start)
            }
        };
        let duration = match self {
            Self::High => 30.0,
            _ => log_uniform(rng, 2.0, 30.0),
        };
        let [rate, height] = match self {
            Self::Odd => [
                log_uniform(rng, 1.0, 3e3).round(),
                log_uniform(rng, 32.0, 1e5),
            ],
            _ => [60.0, 64.0],
        };
        Problem {
            pendulum,
            start,
            tolerance: half_pixel(&pendulum, height),
            duration: duration.min(MOST_FRAMES / rate),
            rate: rate as u16,
        }
    }
}

/// Returns a number from [`LEAST`] to `most`. Half of the numbers are distributed evenly in the
/// logarithm, the others evenly.
fn size(rng: &mut Rng, most: f64) -> f64 {
    if rng.bool() {
        log_uniform(rng, LEAST, most)
    } else {
        LEAST + (most - LEAST) * rng.f64()
    }
}

/// Returns a start at rest, whose larger angle is from [`LEAST`] to pi rad.
fn swing(rng: &mut Rng) -> Motion<f64> {
    let amplitude = size(rng, PI);
    let other = amplitude * symmetric(rng);
    match rng.u8(0..3) {
        0 => Motion::at_rest(amplitude, amplitude),
        1 => Motion::at_rest(other, amplitude),
        _ => Motion::at_rest(amplitude, other),
    }
}

/// Gives every other start velocities.
fn pushed(rng: &mut Rng, pendulum: &Parameters<f64>, start: Motion<f64>) -> Motion<f64> {
    if !rng.bool() {
        return start;
    }
    let share = size(rng, 1.0);
    let mut velocity = |l: f64| share * symmetric(rng) * (20.0 * (GRAVITY / l).sqrt()).min(60.0);
    Motion {
        w1: velocity(pendulum.l1),
        w2: velocity(pendulum.l2),
        ..start
    }
}

/// A scene that is planned for a chip, with the judgement of its plan.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "the numbers are printed")]
struct Case {
    scene: Problem,
    /// `None` if there is no promise.
    plan: Option<Plan>,
    /// The predicted horizon, s; 0 without a plan.
    horizon: f64,
    /// The largest error until then, half pixels.
    error: f64,
}

impl Case {
    /// Plans a scene within the budgets of a chip, and compares every frame with the exact motion.
    fn new(scene: &Problem, chip: &Chip) -> Self {
        let budget = chip.processor.budget(scene);
        let plan = match Plan::search(scene, &chip.processor.costs, &budget) {
            Ok(plan) => Some(plan),
            Err(PlanError::NoMethod { .. }) => None,
            Err(error) => panic!("{scene:?}: {error}"),
        };
        Self {
            scene: *scene,
            plan,
            horizon: plan.map_or(0.0, |plan| plan.horizon),
            error: plan.map_or(0.0, |plan| largest_error(scene, &plan)),
        }
    }
}

/// Returns the largest distance of either bob, or of bob 2 as seen from bob 1, from the exact motion
/// until the predicted horizon, half pixels.
fn largest_error(scene: &Problem, plan: &Plan) -> f64 {
    let [l1, l2] = [scene.pendulum.l1, scene.pendulum.l2].map(|l| l / scene.tolerance);
    let mut reference = Reference::new(&scene.pendulum, &scene.start);
    let mut run = plan.run(scene).expect("a plan can be run");
    let frames = (plan.horizon * f64::from(scene.rate)).round() as u32;
    let mut largest = 0.0_f64;
    for frame in 1..=frames {
        reference.advance_to(f64::from(frame) / f64::from(scene.rate));
        if run.advance(1).is_err() {
            return f64::INFINITY;
        }
        let exact = reference.motion().angles().map(f64::sin_cos);
        let off = |rod: usize| {
            let [sin, cos] = run.directions()[rod].map(f64::from);
            [sin - exact[rod].0, cos - exact[rod].1]
        };
        let [bob1, relative] = [off(0).map(|x| l1 * x), off(1).map(|x| l2 * x)];
        let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
        let sizes = [bob1, relative, bob2].map(|[x, y]| x.hypot(y));
        largest = sizes.into_iter().fold(largest, f64::max);
    }
    largest
}

/// Studies scenes on a chip and prints a line. Allows `most` violations, each of at most `largest`
/// half pixels.
fn study(name: &str, scenes: &[Problem], chip: &Chip, most: usize, largest: f64) {
    let cases: Vec<_> = scenes
        .par_iter()
        .map(|scene| Case::new(scene, chip))
        .collect();
    let violations: Vec<_> = cases.iter().filter(|case| case.error > 1.0).collect();
    let error = cases.iter().map(|case| case.error).fold(0.0, f64::max);
    let nothing = cases.iter().filter(|case| case.plan.is_none()).count();
    let mean = cases.iter().map(|case| case.horizon).sum::<f64>() / cases.len() as f64;
    println!(
        "| {name} | {} | {} | {nothing} | {} | {error:.2} | {mean:.2} |",
        chip.name,
        cases.len(),
        violations.len()
    );
    assert!(
        violations.len() <= most && violations.iter().all(|case| case.error <= largest),
        "{name}, {}: {violations:#?}",
        chip.name
    );
}

/// Two scenes of every class, and scenes that earlier planners predicted too long, have no frame
/// that is wrong by more than half a pixel until the predicted horizon, on any processor.
///
/// In the first of the latter, near upright, truncation errors below the rounding error of a step
/// all had the same direction for thousands of steps. In the last one, the ellipsoid was narrower
/// than the rounding errors of the shadows.
#[test]
fn half_a_pixel_is_kept_until_the_predicted_horizon() {
    let once_wrong = [
        (Class::Upright, 102, 47),
        (Class::Odd, 102, 33),
        (Class::High, 203, 1202),
    ];
    let scenes: Vec<_> = Class::ALL
        .into_iter()
        .flat_map(|class| class.scenes(0).take(2))
        .chain(once_wrong.map(|(class, seed, i)| class.scenes(seed).nth(i).expect("no end")))
        .collect();
    for chip in &CHIPS {
        study("sample", &scenes, chip, 0, 1.0);
    }
}

/// Studies a whole class. At most [`VIOLATIONS`] plans of 2,000 for each processor and seed may have
/// an inaccurate frame before the predicted horizon, of at most [`LARGEST`] half pixels.
fn thousands(class: Class) {
    let text = |name: &str| env::var(name).ok();
    let number = |name: &str| text(name).and_then(|text| text.parse::<u64>().ok());
    let count = number("SCENES").map_or(2_000, |count| count as usize);
    let seeds = number("SEED").map_or(201..=203, |seed| seed..=seed);
    let wanted = text("CHIP");
    println!("| class, seed | processor | scenes | no promise | violations | largest | mean, s |");
    for seed in seeds {
        let scenes: Vec<_> = class.scenes(seed).take(count).collect();
        for chip in &CHIPS {
            if wanted.as_ref().is_none_or(|name| *name == chip.name) {
                let name = format!("{class:?}, {seed}");
                study(&name, &scenes, chip, VIOLATIONS, LARGEST);
            }
        }
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
