//! The planner's promises against the exact motion, over scenes of all kinds.

use host_tests::planning::{Case, GROSS, M4F, median, study};
use host_tests::tolerance::{PLAN_KEPT, PLAN_SHARE};

/// Other scenes than the report's.
const SEED: u64 = 20;
const SCENES: usize = 200;
/// So many of them, at least, are promised for a part of their duration.
const CUT: usize = 5;

#[test]
fn half_a_pixel_is_kept_until_the_promised_horizon() {
    let cases = study(SEED, SCENES, 2.0..6.0, &M4F, || ()).expect("good scenes");
    let broken: Vec<&Case> = cases.iter().filter(|case| !case.is_kept()).collect();
    let kept = 1.0 - broken.len() as f64 / cases.len() as f64;
    assert!(kept >= PLAN_KEPT, "{broken:#?}");
    assert!(broken.iter().all(|case| case.verdict.error <= GROSS), "{broken:#?}");

    let cut: Vec<&Case> = cases.iter().filter(|case| case.plan.horizon < case.scene.duration).collect();
    let share = median(cut.iter().map(|case| case.share()));
    println!("{} scenes, {} broken, {} promised in part: {share:.2}", cases.len(), broken.len(), cut.len());
    assert!(cut.len() >= CUT, "only {} scenes say anything about the horizon", cut.len());
    assert!(share >= PLAN_SHARE, "{share}");
    assert!(median(cases.iter().map(Case::share)) >= PLAN_SHARE);
}
