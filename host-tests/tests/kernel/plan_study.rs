//! The planner's predictions against the exact motion, over scenes of all kinds, for every processor.

use double_pendulum::plan::Problem;
use double_pendulum::{Motion, Parameters, Pendulum};
use firmware::config::GRAVITY;
use firmware::motion::half_pixel;
use host_tests::commands::plan::{CHIPS, Case, DURATIONS, median, scenes, study};
use host_tests::oracle::tolerances::{PLAN_ERROR, PLAN_SHARE};

/// Other scenes than those of [`thousands_of_scenes`].
const SEED: u64 = 20;
/// Scenes of all kinds, and lively ones among which many cease to be right before their end. Short, for the reference
/// takes its time.
const ALL: usize = 60;
const LIVELY: usize = 8;
/// How many must cease to be right, so that the median of their shares says something.
const LEAST_ENDING: usize = 6;

/// Of 2,000 scenes: where planning cannot pay for 64 bits, runs may have roundings alike by chance.
const VIOLATIONS: usize = 1;
/// The largest error of theirs, pixels.
const LARGEST: f64 = 1.5;
/// The predicted over the true horizon, in the median of those that cease to be right.
const SHARE: f64 = 0.9;

fn all() -> impl Iterator<Item = Problem> {
    scenes(SEED, 2.0..3.0).take(ALL)
}

/// A rod may turn over, and bob 1 is not so light that steps must be very fine.
fn lively(count: usize) -> impl Iterator<Item = Problem> {
    let is_lively = |scene: &Problem| {
        let pendulum = Pendulum::new(&scene.pendulum).expect("a good scene");
        let light = scene.pendulum.mass_ratio() > 30.0;
        !light && scene.start.a2.abs() > 1.5 && !pendulum.cannot_turn_over(&pendulum.to_state(&scene.start))
    };
    scenes(SEED + 1, 22.0..28.0).filter(is_lively).take(count)
}

/// Scenes that are right for some 20 s in 64 bits, each with neighbours: how the roundings fall is chance.
fn long() -> impl Iterator<Item = Problem> {
    let scenes = [(1.18219, 0.714144, 2.17128, 1.27892), (2.15233, 1.72009, -2.41900, -2.39437)];
    scenes.into_iter().flat_map(|(m2, l2, a1, a2)| {
        [-1e-6, 0.0, 1e-6].map(|beside| {
            let pendulum = Parameters { m1: 1.0, m2, l1: 1.0, l2, g: GRAVITY };
            let start = Motion::at_rest(a1 + beside, a2);
            Problem { pendulum, start, tolerance: half_pixel(&pendulum, 64.0), duration: 30.0, rate: 60 }
        })
    })
}

/// At most `most` violations, none by more than `error` pixels; the shares are told.
fn check(cases: &[Case], most: usize, error: f64) -> Vec<f64> {
    let violations: Vec<&Case> = cases.iter().filter(|case| case.is_violation()).collect();
    for case in &violations {
        println!("{} {} {:?} {:?} {:?}", case.number, case.chip.name, case.plan, case.verdict, case.scene);
    }
    assert!(violations.len() <= most, "{} violations: {violations:#?}", violations.len());
    assert!(violations.iter().all(|case| case.verdict.error <= error), "{violations:#?}");
    cases.iter().filter(|case| case.ends_early()).map(Case::share).collect()
}

#[test]
fn half_a_pixel_is_kept_until_the_predicted_horizon() {
    let cases = study(all().chain(lively(LIVELY)).chain(long()), &CHIPS).expect("good scenes");
    for chip in CHIPS {
        let of_chip: Vec<Case> = cases.iter().filter(|case| case.chip == chip).copied().collect();
        let shares = check(&of_chip, 1, PLAN_ERROR);
        let (ending, share) = (shares.len(), median(shares.into_iter()));
        println!("{}: {} scenes, {ending} end early, predicted {share:.2}", chip.title, of_chip.len());
        assert!(ending >= LEAST_ENDING && share >= PLAN_SHARE, "{}: {ending} end early, {share}", chip.title);
    }
}

/// The whole study: the README's table is what `cargo test -p host-tests --test kernel plan_study:: -- --ignored --nocapture`
/// prints of the first seed.
#[test]
#[ignore = "four minutes"]
fn thousands_of_scenes() {
    println!("| processor | no method | end early | violations | largest error (pixels) | predicted |");
    for seed in 1..=3 {
        let cases = study(scenes(seed, DURATIONS).take(2_000), &CHIPS).expect("good scenes");
        for chip in CHIPS {
            let of_chip: Vec<Case> = cases.iter().filter(|case| case.chip == chip).copied().collect();
            let count = |is_it: fn(&&Case) -> bool| of_chip.iter().filter(is_it).count();
            let [nothing, violations] = [count(|case| case.plan.is_err()), count(|case| case.is_violation())];
            let largest = of_chip.iter().map(|case| case.verdict.error).fold(0.0, f64::max);
            let shares = check(&of_chip, VIOLATIONS, LARGEST);
            let (ending, share) = (shares.len(), median(shares.into_iter()));
            println!("| {} | {nothing} | {ending} | {violations} | {largest:.1e} | {share:.2} |", chip.title);
            assert!(share >= SHARE, "{}: {share}", chip.title);
        }
    }
}
