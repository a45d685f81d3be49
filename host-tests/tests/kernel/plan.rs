//! The planner: what it chooses for scenes that one knows, its budgets, and what it refuses.

use std::f64::consts::PI;

use double_pendulum::Method;
use double_pendulum::plan::{Budget, Costs, Limit, Plan, PlanError, PlannedRun, Problem, Search, Way};
use double_pendulum::{Error, Motion, Parameter, Parameters};
use firmware::config::{CORTEX_M3, STM32F405};
use firmware::motion::half_pixel;

const RATE: u16 = 60;
const M3: Costs = CORTEX_M3.costs;
const M4F: Costs = STM32F405.costs;

/// Both rods at rest at `degrees`, on a display of 64 pixels.
fn scene(mass_ratio: f64, degrees: f64, duration: f64) -> Problem {
    let angle = degrees * (PI / 180.0);
    let pendulum = Parameters::equal_rods(mass_ratio, 1.0, 9.81);
    let tolerance = half_pixel(&pendulum, 64.0);
    Problem { pendulum, start: Motion::at_rest(angle, angle), tolerance, duration, rate: RATE }
}

fn planned(scene: &Problem) -> Plan {
    Plan::search(scene, &M4F, &STM32F405.budget(scene)).expect("a good scene")
}

/// The plan for a Cortex-M4F that may spend so much on a frame.
fn within(scene: &Problem, frame: f32) -> Result<Plan, PlanError> {
    Plan::search(scene, &M4F, &Budget { frame, planning: 1e10 })
}

fn finished(search: &mut Search) -> Plan {
    loop {
        if let Some(plan) = search.advance(f32::INFINITY).expect("a good scene") {
            return plan;
        }
    }
}

#[test]
fn small_oscillations_are_taken_from_the_closed_form() {
    let small = scene(1.0, 3.0, 10.0);
    let found = |costs: &Costs| Plan::search(&small, costs, &CORTEX_M3.budget(&small)).expect("a good scene");
    let Plan { method, steps, limit, horizon, .. } = found(&Costs { fixed32: 20e3, ..M3 });
    assert_eq!((method, steps, limit, horizon), (Method::ClosedFormF32, 0, Limit::End, 10.0));
    // One step costs less where it is made of integers, or by the floating-point unit.
    assert_eq!(found(&M3).method, Method::Rk4Fixed32);
    assert_eq!(planned(&small).method, Method::Rk4F32DirectionPlain);
}

#[test]
fn large_regular_oscillations_take_the_cheapest_steps() {
    let plan = planned(&scene(1.0, 60.0, 10.0));
    assert_eq!((plan.method, plan.steps, plan.limit), (Method::Rk4F32DirectionPlain, 1, Limit::End));
    assert!((1e-4..=1.0).contains(&plan.error) && plan.cost == M4F.direction_plain, "{plan:?}");
    assert_eq!(plan.dt, 1.0 / 60.0);
}

#[test]
fn a_chaotic_scene_is_predicted_for_as_long_as_it_can_be() {
    let figure7 = scene(2.75, 171.0, 30.0);
    let plan = planned(&figure7);
    assert!(plan.limit == Limit::Growth && (12.0..20.0).contains(&plan.horizon), "{plan:?}");
    let single = within(&figure7, 5e3).expect("a good scene");
    assert!(single.method != Method::Extrapolation10Fixed64 && (8.0..10.0).contains(&single.horizon), "{single:?}");
    let double = within(&figure7, 5e6).expect("a good scene");
    assert!(double.method == Method::Extrapolation10Fixed64 && double.horizon > 1.4 * single.horizon, "{double:?}");
    assert_eq!(double.dt, 1.0 / f64::from(60 * double.steps), "{double:?}");
}

/// What a frame cannot pay for is not looked at.
#[test]
fn looking_ahead_ends_where_the_frame_does() {
    let figure7 = scene(2.75, 171.0, 30.0);
    let frugal = within(&figure7, 5e3).expect("a good scene");
    assert!(frugal.limit == Limit::Budget && frugal.spent < 1e8, "{frugal:?}");
    let poor = within(&figure7, 300.0).expect_err("one step is too coarse");
    assert!(matches!(poor, PlanError::NoMethod { limit: Limit::Budget, spent } if spent < 4e6), "{poor:?}");
}

/// A costlier way that is right for less than a tenth longer is worth it if it is right to the end.
#[test]
fn the_end_is_worth_its_cost() {
    let figure7 = scene(2.75, 171.0, 30.0);
    let frugal = within(&figure7, 5e3).expect("a good scene");
    let short = scene(2.75, 171.0, 1.05 * frugal.horizon);
    let lavish = within(&short, 1e6).expect("a good scene");
    assert_eq!((lavish.limit, lavish.horizon), (Limit::End, short.duration), "{lavish:?} {frugal:?}");
}

/// By the same method, it is right for less than a tenth longer: too little to be worth a costlier one.
#[test]
fn a_plan_that_is_looked_at_farther_is_told_anew_where_it_ends() {
    let whole = planned(&scene(2.75, 171.0, 30.0));
    let short = scene(2.75, 171.0, 0.95 * whole.horizon);
    let mut search = Search::new(&short, &M4F, &STM32F405.budget(&short)).expect("a good scene");
    let first = finished(&mut search);
    search.extend(100.0);
    let second = finished(&mut search);
    assert_eq!((first.limit, first.horizon), (Limit::End, short.duration));
    assert_eq!((second.method, second.steps, second.horizon), (whole.method, whole.steps, whole.horizon));
}

#[test]
fn a_light_elbow_takes_fine_steps() {
    let [light, alike] = [1e3, 1.0].map(|mass_ratio| planned(&scene(mass_ratio, 30.0, 2.0)));
    assert!(light.steps > 8 * alike.steps, "{light:?} {alike:?}");
}

#[test]
fn budgets_are_kept() {
    let mut found = 0;
    for frame in [200.0, 1e3, 1e4, 1e6] {
        for planning in [1e3, 1e5, 1e7, 1e9] {
            for degrees in [3.0, 60.0, 120.0, 171.0] {
                let budget = Budget { frame, planning };
                match Plan::search(&scene(2.75, degrees, 20.0), &M4F, &budget) {
                    Ok(plan) => {
                        assert!(plan.spent <= planning && plan.cost <= frame && plan.horizon > 0.0, "{plan:?}");
                        found += 1;
                    }
                    Err(PlanError::NoMethod { spent, .. }) => assert!(spent <= planning, "{spent}"),
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }
    assert!((20..64).contains(&found), "{found} of 64: some hold, some cannot be had");
}

/// What a plan costs is just enough for it; by less, another is found that costs less.
#[test]
fn a_budget_that_is_just_enough_is_enough() {
    for (mass_ratio, degrees) in [(1.0, 60.0), (1.0, 120.0), (2.75, 171.0), (1e3, 30.0)] {
        let scene = scene(mass_ratio, degrees, 20.0);
        for costs in [&M3, &M4F] {
            let within = |frame| Plan::search(&scene, costs, &Budget { frame, planning: 1e10 });
            let lavish = within(1e6).expect("a good scene");
            let enough = within(lavish.cost).expect("a good scene");
            assert_eq!((enough.method, enough.steps, enough.horizon), (lavish.method, lavish.steps, lavish.horizon));
            if let Ok(frugal) = within(lavish.cost.next_down()) {
                assert!(frugal.cost < lavish.cost, "{frugal:?} {lavish:?}");
            }
        }
    }
}

/// The way that lasts longest is in 64 bits where a frame can pay for it, and else what it can pay for.
#[test]
fn the_lasting_way_is_what_a_frame_can_pay_for() {
    for degrees in [60.0, 120.0, 171.0] {
        let Problem { pendulum, start, .. } = scene(2.75, degrees, 20.0);
        for costs in [&M3, &M4F] {
            let within = |frame| Way::lasting(&pendulum, &start, RATE, costs, frame).expect("a pendulum");
            let cost = |way: Way| costs.of_frame(way.method, way.steps);
            let lavish = within(1e7);
            assert_eq!((lavish.method, within(cost(lavish))), (Method::Extrapolation10Fixed64, lavish));
            let frugal = within(cost(lavish).next_down());
            assert!(cost(frugal) < cost(lavish), "{frugal:?} {lavish:?}");
            let poor = within(costs.fixed64.next_down());
            assert!(poor.method != Method::Extrapolation10Fixed64 && cost(poor) < costs.fixed64, "{poor:?}");
            let resolving = Way::of(&pendulum, &start, RATE, poor.method).expect("a pendulum");
            let is_finest = costs.of_frame(poor.method, 2 * poor.steps) >= costs.fixed64;
            assert!(resolving == poor || resolving.steps > poor.steps && is_finest, "{poor:?} {resolving:?}");
            let poorer = within(cost(poor).next_down());
            assert!(poorer.steps == (poor.steps / 2).max(1), "{poorer:?} {poor:?}");
        }
    }
}

/// Fixed point refuses a mass ratio of 100,000.
#[test]
fn the_lasting_way_can_be_gone() {
    for (mass_ratio, method) in [(1.0, Method::Rk4Fixed32), (1e5, Method::Rk4F32Direction)] {
        let Problem { pendulum, start, .. } = scene(mass_ratio, 10.0, 20.0);
        let way = Way::lasting(&pendulum, &start, RATE, &M3, M3.fixed64.next_down()).expect("a pendulum");
        assert_eq!(way.method, method);
        assert!(PlannedRun::new(&pendulum, &start, RATE, way).is_ok(), "{way:?}");
    }
}

/// In steps as long as resolve the motion: in 64 bits those are of a high order, but shorter than the first that others try.
#[test]
fn a_method_that_is_asked_for_resolves_the_motion() {
    let Problem { pendulum, start, .. } = scene(2.75, 171.0, 20.0);
    let steps = |method| Way::of(&pendulum, &start, RATE, method).expect("a pendulum").steps;
    assert_eq!([Method::Extrapolation10Fixed64, Method::Rk4Fixed32, Method::Rk4F32Direction].map(steps), [3, 2, 2]);
}

/// What fixed point takes ends just beyond equal rods: the runs beside the motion must not be refused where it is not.
#[test]
fn a_way_that_can_be_gone_is_looked_at() {
    for degrees in [60.0, 90.0, 120.0] {
        let scene = scene(1.0, degrees, 1.0);
        for method in [Method::Rk4Fixed32, Method::Rk4F32Direction, Method::Extrapolation10Fixed64] {
            let way = Way::of(&scene.pendulum, &scene.start, RATE, method).expect("a pendulum");
            assert!(PlannedRun::new(&scene.pendulum, &scene.start, RATE, way).is_ok(), "{way:?} at {degrees}");
            let mut search =
                Search::of(method, way.steps, &scene, &M3, &CORTEX_M3.budget(&scene)).expect("a good scene");
            let plan = finished(&mut search);
            assert_eq!(plan.horizon, scene.duration, "{plan:?} at {degrees}");
        }
    }
}

/// A light elbow at 90 degrees: steps that resolve it cost several times what a Cortex-M3 has, and the closed form is wrong
/// from the first frame on.
#[test]
fn where_no_method_is_right_there_is_no_plan_but_a_method_asked_for_is_told() {
    let scene = Problem { tolerance: 2.0 / 240.0, ..scene(1e3, 90.0, 20.0) };
    let budget = CORTEX_M3.budget(&scene);
    let Err(PlanError::NoMethod { limit, spent }) = Plan::search(&scene, &M3, &budget) else {
        panic!("{:?}", Plan::search(&scene, &M3, &budget))
    };
    assert!(limit != Limit::End && spent <= budget.planning, "{limit:?} {spent}");
    let mut search = Search::of(Method::ClosedFormF32, 1, &scene, &M3, &budget).expect("a good scene");
    let asked = finished(&mut search);
    assert_eq!((asked.method, asked.horizon), (Method::ClosedFormF32, 0.0));
}

#[test]
fn what_is_refused_is_named_with_its_value() {
    let good = scene(1.0, 90.0, 10.0);
    let budget = STM32F405.budget(&good);
    let refused = |scene: Problem, costs: Costs, budget: Budget, expected: Error| {
        let found = Plan::search(&scene, &costs, &budget).expect_err("refused");
        assert_eq!(format!("{found:?}"), format!("{:?}", PlanError::Refused(expected)));
    };
    for value in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let error = |parameter| match value.is_finite() {
            true => Error::NotPositive { parameter, value },
            false => Error::NotFinite { parameter, value },
        };
        let (single, pendulum) = (value as f32, Parameters { m2: value, ..good.pendulum });
        refused(Problem { tolerance: value, ..good }, M4F, budget, error(Parameter::Tolerance));
        refused(Problem { duration: value, ..good }, M4F, budget, error(Parameter::Duration));
        refused(Problem { pendulum, ..good }, M4F, budget, error(Parameter::M2));
        refused(good, Costs { direction: single, ..M4F }, budget, error(Parameter::Cost));
        refused(good, M4F, Budget { frame: single, ..budget }, error(Parameter::Budget));
        refused(good, M4F, Budget { planning: single, ..budget }, error(Parameter::Budget));
    }
    let parameter = Parameter::Rate;
    refused(Problem { rate: 0, ..good }, M4F, budget, Error::NotPositive { parameter, value: 0.0 });
    let (parameter, value) = (Parameter::W1, f64::NEG_INFINITY);
    let start = Motion { w1: value, ..good.start };
    refused(Problem { start, ..good }, M4F, budget, Error::NotFinite { parameter, value });
    let (parameter, limit) = (Parameter::Duration, f64::from(u32::MAX) / f64::from(RATE));
    let too_long = Error::TooLarge { parameter, value: 1e9, limit };
    refused(Problem { duration: 1e9, ..good }, M4F, budget, too_long);
    // Out of the range of f32.
    let pendulum = Parameters { m1: 1e60, m2: 1e60, ..good.pendulum };
    assert!(matches!(Plan::search(&Problem { pendulum, ..good }, &M4F, &budget), Err(PlanError::Refused(_))));
}

/// Where no method meets the tolerance, the limit is what to raise: the planning budget while an affordable candidate has not failed yet, else the
/// frame budget.
#[test]
fn the_limit_is_what_would_help() {
    // the closed form, all that a frame can pay for, is wrong from the first frame on
    let light = Problem { tolerance: 2.0 / 240.0, ..scene(1e3, 90.0, 20.0) };
    let costs = Costs { closed_form: 10.0, ..M3 };
    let limit = |frame, planning| match Plan::search(&light, &costs, &Budget { frame, planning }) {
        Err(PlanError::NoMethod { limit, .. }) => limit,
        other => panic!("{other:?}"),
    };
    let begun = 1.2 * M3.preparation;
    assert_eq!([limit(20.0, begun), limit(5.0, begun)], [Limit::Planning, Limit::Budget]);
    assert_eq!(limit(20.0, 20.0 * M3.preparation), Limit::Budget);
    assert_eq!([limit(20.0, 1.0), limit(20.0, 0.5 * M3.preparation)], [Limit::Planning; 2]);
}

/// Twice the steps are right for longer, but not by a tenth.
#[test]
fn what_is_hardly_better_is_not_worth_its_cost() {
    let lively = within(&scene(1.0, 120.0, 30.0), 13e3).expect("a good scene");
    assert_eq!((lively.method, lively.steps), (Method::Rk4F32Direction, 2), "{lively:?}");
}

/// Where 32 bits of fixed point do not take a pendulum, it is looked at in floating point.
#[test]
fn a_pendulum_out_of_the_range_of_fixed_point_gets_a_plan() {
    let budget = Budget { frame: 1e6, planning: 1e9 };
    let plan = Plan::search(&scene(1e5, 10.0, 2.0), &M3, &budget).expect("a plan");
    assert!(plan.horizon > 0.0, "{plan:?}");
}

/// Steps that together cost no more than is allowed, or one that does.
#[test]
fn a_piece_of_the_search_is_no_larger_than_allowed() {
    let figure7 = scene(2.75, 171.0, 30.0);
    let budget = Budget { frame: 5e3, planning: 1e9 };
    let mut search = Search::new(&figure7, &M4F, &budget).expect("a good scene");
    let allowed = 1.5 * M4F.fixed64;
    loop {
        let (before, is_preparing) = (search.spent(), search.is_preparing());
        let found = search.advance(allowed).expect("a good scene");
        let most = if is_preparing { M4F.preparation } else { allowed };
        assert!(search.spent() - before <= most + 1.0, "{before} {}", search.spent());
        if found.is_some() {
            break;
        }
    }
}

/// Weightless and motionless, as far from reason as numbers go: a plan or a refusal, never a panic.
#[test]
fn every_scene_gets_a_plan_or_a_refusal() {
    let values = [1e-300, 1e-30, 1e-3, 1.0, 1e3, 1e30, 1e300];
    let budget = Budget { frame: 1e6, planning: 1e7 };
    let mut planned = 0;
    for m2 in values {
        for l2 in values {
            for g in [0.0, 9.81, 1e30] {
                for w2 in [0.0, 1.0, 1e30] {
                    let pendulum = Parameters { m1: 1.0, m2, l1: 1.0, l2, g };
                    let start = Motion { w2, ..Motion::at_rest(3.0, -1.0) };
                    let scene = Problem { pendulum, start, tolerance: 0.1, duration: 2.0, rate: RATE };
                    if let Ok(plan) = Plan::search(&scene, &M4F, &budget) {
                        planned += 1;
                        assert!((0.0..=2.0).contains(&plan.horizon), "{plan:?} for {scene:?}");
                    }
                }
            }
        }
    }
    assert!(planned > 20, "{planned}");
}
