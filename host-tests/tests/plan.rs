//! The planner: what it chooses for scenes that one knows, its budgets, and what it refuses.

use std::f64::consts::PI;

use double_pendulum::plan::{Budget, Costs, Limit, Method, Plan, Problem, plan};
use double_pendulum::{Error, Motion, Parameter, Parameters};

const RATE: u16 = 60;
/// The clock of a Cortex-M4F, Hz, and for how long it may look ahead, s.
const CLOCK: f32 = 168e6;
const PLANNING: f32 = 2.0;

/// Both rods at rest at `degrees`, on a display of 64 pixels.
fn scene(mass_ratio: f64, degrees: f64, duration: f64) -> Problem {
    let angle = degrees * (PI / 180.0);
    let pendulum = Parameters::equal_rods(mass_ratio, 1.0, 9.81);
    Problem { pendulum, start: Motion::at_rest(angle, angle), height: 64.0, duration, rate: RATE }
}

fn planned(scene: &Problem) -> Plan {
    plan(scene, &Costs::CORTEX_M4F, &Budget::half_of(CLOCK, RATE, PLANNING)).expect("a good scene")
}

#[test]
fn small_oscillations_are_taken_from_the_closed_form() {
    let small = scene(1.0, 3.0, 10.0);
    let plan = plan(&small, &Costs::CORTEX_M3, &Budget::half_of(50e6, RATE, 20.0)).expect("a good scene");
    assert_eq!((plan.way, plan.steps, plan.limit), (Method::ClosedForm, 0, Limit::End));
    assert_eq!(plan.horizon, 10.0);
    // One step costs less where the floating-point unit makes it.
    assert_eq!(planned(&small).way, Method::DirectionPlain);
}

#[test]
fn large_regular_oscillations_take_the_cheapest_steps() {
    let plan = planned(&scene(1.0, 60.0, 10.0));
    assert_eq!((plan.way, plan.steps, plan.limit), (Method::DirectionPlain, 1, Limit::End));
    assert!(plan.error <= 0.5 && plan.cycles == Costs::CORTEX_M4F.direction_plain, "{plan:?}");
}

#[test]
fn a_chaotic_scene_is_promised_for_as_long_as_it_can_be() {
    let figure7 = scene(2.75, 171.0, 30.0);
    let plan = planned(&figure7);
    assert!(plan.limit != Limit::End && (5.0..15.0).contains(&plan.horizon), "{plan:?}");
    let frugal = Budget { frame: 5e3, planning: 1e9 };
    let single = double_pendulum::plan::plan(&figure7, &Costs::CORTEX_M4F, &frugal).expect("a good scene");
    assert!(single.way != Method::Direction8 && (5.5..8.0).contains(&single.horizon), "{single:?}");
    let lavish = Budget { frame: 5e6, planning: 1e11 };
    let double = double_pendulum::plan::plan(&figure7, &Costs::CORTEX_M4F, &lavish).expect("a good scene");
    assert!(double.way == Method::Direction8 && double.horizon > 2.0 * single.horizon, "{double:?}");
}

#[test]
fn a_light_elbow_takes_fine_steps() {
    let [light, alike] = [1e3, 1.0].map(|mass_ratio| planned(&scene(mass_ratio, 30.0, 2.0)));
    assert!(light.steps > 8 * alike.steps, "{light:?} {alike:?}");
}

#[test]
fn budgets_are_kept() {
    for frame in [200.0, 1e3, 1e4, 1e6] {
        for planning in [1e3, 1e5, 1e7, 1e9] {
            for degrees in [3.0, 60.0, 120.0, 171.0] {
                let budget = Budget { frame, planning };
                let plan = plan(&scene(2.75, degrees, 20.0), &Costs::CORTEX_M4F, &budget).expect("a good scene");
                assert!(plan.planning <= planning, "{plan:?}");
                assert!(plan.cycles <= frame || plan.horizon == 0.0, "{plan:?}");
            }
        }
    }
}

#[test]
fn bad_scenes_are_refused_by_name() {
    let good = scene(1.0, 90.0, 10.0);
    let costs = Costs::CORTEX_M4F;
    let budget = Budget::half_of(CLOCK, RATE, PLANNING);
    let refused = |scene: &Problem| plan(scene, &costs, &budget).expect_err("refused").parameter();
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        assert_eq!(refused(&Problem { height: bad, ..good }), Parameter::Height);
        assert_eq!(refused(&Problem { duration: bad, ..good }), Parameter::Duration);
        let pendulum = Parameters { m2: bad, ..good.pendulum };
        assert_eq!(refused(&Problem { pendulum, ..good }), Parameter::M2);
        let bad = bad as f32;
        let cost = plan(&good, &Costs { direction: bad, ..costs }, &budget).expect_err("refused");
        assert_eq!(cost.parameter(), Parameter::Cost);
        let allowed = plan(&good, &costs, &Budget { frame: bad, ..budget }).expect_err("refused");
        assert_eq!(allowed.parameter(), Parameter::Budget);
    }
    assert_eq!(refused(&Problem { rate: 0, ..good }), Parameter::Rate);
    let start = Motion { w1: f64::NAN, ..good.start };
    assert_eq!(refused(&Problem { start, ..good }), Parameter::W1);
    let limit = f64::from(u32::MAX) / f64::from(RATE);
    let too_long = Error::TooLarge { parameter: Parameter::Duration, value: 1e9, limit };
    assert_eq!(plan(&Problem { duration: 1e9, ..good }, &costs, &budget), Err(too_long));
}

/// Weightless and motionless, as far from reason as numbers go: a plan or a refusal, never a panic.
#[test]
fn every_scene_gets_a_plan_or_a_refusal() {
    let values = [1e-300, 1e-30, 1e-3, 1.0, 1e3, 1e30, 1e300];
    let budget = Budget { frame: 1e6, planning: 1e6 };
    let mut planned = 0;
    for m2 in values {
        for l2 in values {
            for g in [0.0, 9.81, 1e30] {
                for w2 in [0.0, 1.0, 1e30] {
                    let pendulum = Parameters { m1: 1.0, m2, l1: 1.0, l2, g };
                    let start = Motion { w2, ..Motion::at_rest(3.0, -1.0) };
                    let scene = Problem { pendulum, start, height: 64.0, duration: 2.0, rate: RATE };
                    if let Ok(plan) = plan(&scene, &Costs::CORTEX_M4F, &budget) {
                        planned += 1;
                        assert!((0.0..=2.0).contains(&plan.horizon), "{plan:?} for {scene:?}");
                    }
                }
            }
        }
    }
    assert!(planned > 20, "{planned}");
}
