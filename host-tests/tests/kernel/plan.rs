//! The planner: its choices for known scenes, its budgets, and its refusals.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use double_pendulum::Method;
use double_pendulum::plan::{
    Budget, Costs, Limit, Plan, PlanError, PlannedRun, Problem, Search, Stepping,
};
use double_pendulum::{Error, Motion, Parameter, Parameters, Pendulum};
use exact::random::{log_uniform, symmetric};
use fastrand::Rng;
use firmware::config::{CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, STM32F405};
use firmware::motion::half_pixel;
use rayon::prelude::*;

/// Frames per second.
const RATE: u16 = 60;
/// The costs of a Cortex-M3, where fixed point costs less than `f32`, in cycles.
const M3: Costs = CORTEX_M3.costs;
/// The costs of an STM32F405, a Cortex-M4F, where `f32` costs less, in cycles.
const M4F: Costs = STM32F405.costs;

/// Returns a problem with both rods at rest at `degrees`, on a display of 64 pixels.
fn scene(mass_ratio: f64, degrees: f64, duration: f64) -> Problem {
    let angle = degrees * (PI / 180.0);
    let pendulum = Parameters::equal_rods(mass_ratio, 1.0, 9.81);
    let tolerance = half_pixel(&pendulum, 64.0);
    Problem {
        pendulum,
        start: Motion::at_rest(angle, angle),
        tolerance,
        duration,
        rate: RATE,
    }
}

/// Returns the plan for a Cortex-M4F with this frame budget, in cycles, and a large planning
/// budget.
fn within(scene: &Problem, frame: f32) -> Result<Plan, PlanError> {
    Plan::search(
        scene,
        &M4F,
        &Budget {
            frame,
            planning: 1e10,
        },
    )
}

/// Runs a search to its end, and returns its plan.
fn finished(search: &mut Search) -> Plan {
    loop {
        if let Some(plan) = search.advance(f32::INFINITY).expect("a good scene") {
            return plan;
        }
    }
}

/// A case: the costs and the frame budget, the problem, and the expected method, step count, limit
/// and range of the horizon, s.
type Row = (
    Costs,
    f32,
    Problem,
    (Method, u32),
    Limit,
    RangeInclusive<f64>,
);

/// Nine scenes, each with a price list and a frame budget: the plan must have exactly the method,
/// step count and limit of its row, a horizon in the row's range, an error from 1e-6 to 1
/// tolerances, and the cost of the price list. The planning budget is large.
#[test]
fn planner_chooses_the_cheapest_method_with_the_longest_horizon() {
    use Method::{ClosedFormF32, Extrapolation10Fixed64, Rk4F32Direction, Rk4Fixed32};
    let small = scene(1.0, 3.0, 10.0);
    let large = scene(1.0, 60.0, 10.0);
    let figure7 = scene(2.75, 171.0, 30.0);
    let mut costly = M3;
    costly.fixed32 = 20e3;
    costly.fixed32_unlike = 20e3;
    let rows: [Row; 9] = [
        // A step costs less than the closed form if it uses integers or a floating-point unit.
        (
            costly,
            CORTEX_M3.frame,
            small,
            (ClosedFormF32, 0),
            Limit::End,
            10.0..=10.0,
        ),
        (
            M3,
            CORTEX_M3.frame,
            small,
            (Rk4Fixed32, 1),
            Limit::End,
            10.0..=10.0,
        ),
        (
            M4F,
            STM32F405.frame,
            small,
            (Rk4F32Direction, 1),
            Limit::End,
            10.0..=10.0,
        ),
        (
            M4F,
            STM32F405.frame,
            large,
            (Rk4F32Direction, 1),
            Limit::End,
            10.0..=10.0,
        ),
        // Chaotic motions get the longest possible horizon. Methods beyond the frame budget are not
        // tried.
        (
            M4F,
            STM32F405.frame,
            figure7,
            (Extrapolation10Fixed64, 7),
            Limit::Growth,
            16.5..=21.5,
        ),
        (
            M4F,
            5e3,
            figure7,
            (Rk4F32Direction, 16),
            Limit::Budget,
            7.0..=8.5,
        ),
        // A light elbow needs fine steps.
        (
            M4F,
            STM32F405.frame,
            scene(1e3, 30.0, 2.0),
            (Rk4F32Direction, 256),
            Limit::End,
            2.0..=2.0,
        ),
        (
            M4F,
            STM32F405.frame,
            scene(1.0, 30.0, 2.0),
            (Rk4F32Direction, 1),
            Limit::End,
            2.0..=2.0,
        ),
        // Twice the steps cost too much.
        (
            M4F,
            1e3,
            scene(1.0, 120.0, 30.0),
            (Rk4F32Direction, 4),
            Limit::Budget,
            10.0..=11.5,
        ),
    ];

    // Each plan equals its row, and its cost agrees with the price list.
    for (costs, frame, scene, (method, steps), limit, horizon) in rows {
        let plan = Plan::search(
            &scene,
            &costs,
            &Budget {
                frame,
                planning: 1e10,
            },
        )
        .expect("a good scene");
        assert_eq!(
            (plan.method, plan.steps, plan.limit),
            (method, steps, limit),
            "{plan:?}"
        );
        assert!(
            horizon.contains(&plan.horizon) && (1e-6..=1.0).contains(&plan.error),
            "{plan:?}"
        );
        let dt = if steps == 0 {
            0.0
        } else {
            1.0 / f64::from(u32::from(RATE) * steps)
        };
        assert_eq!(
            (plan.dt, plan.cost),
            (dt, costs.of_frame(Stepping { method, steps })),
            "{plan:?}"
        );
    }
}

/// Methods beyond the frame budget are not tried: with a small budget the limit is the frame budget,
/// and planning costs little. A method that costs more, and is accurate for less than a tenth
/// longer, is chosen if it is accurate to the end.
#[test]
fn planner_keeps_to_the_frame_budget_and_pays_for_the_end() {
    let figure7 = scene(2.75, 171.0, 30.0);
    // A small budget gives a shorter horizon.
    let frugal = within(&figure7, 5e3).expect("a good scene");
    assert!(
        frugal.limit == Limit::Budget && frugal.spent < 1.2e8,
        "{frugal:?}"
    );

    // A budget that reaches the end of the scene.
    let short = scene(2.75, 171.0, 1.05 * frugal.horizon);
    let lavish = within(&short, 1e6).expect("a good scene");
    assert_eq!(
        (lavish.limit, lavish.horizon),
        (Limit::End, short.duration),
        "{lavish:?} {frugal:?}"
    );
}

/// A search that has reached the end of a short scene is extended by 100 s. Its second plan must
/// have the method, step count and horizon of a plan of the whole scene, and `Search::horizon` must
/// report that horizon for the same steps, and 0 for others.
///
/// The extended horizon is less than a tenth longer than the first. This would not be worth a
/// method that costs more, but it is the same method.
#[test]
fn extended_search_returns_the_plan_again_with_its_longer_horizon() {
    let whole = within(&scene(2.75, 171.0, 30.0), STM32F405.frame).expect("a good scene");
    let short = scene(2.75, 171.0, 0.95 * whole.horizon);
    let mut search = Search::new(&short, &M4F, &STM32F405.budget(&short)).expect("a good scene");
    let first = finished(&mut search);
    search.extend(100.0);
    let second = finished(&mut search);
    assert_eq!((first.limit, first.horizon), (Limit::End, short.duration));
    assert_eq!(
        (second.method, second.steps, second.horizon),
        (whole.method, whole.steps, whole.horizon)
    );
    let planned = second.stepping();
    let finer = Stepping {
        steps: planned.steps + 1,
        ..planned
    };
    let horizons = [planned, finer].map(|stepping| search.horizon(stepping));
    assert_eq!(horizons, [second.horizon, 0.0]);
}

/// For 64 pairs of budgets and scenes no plan costs more than its frame budget, none has a horizon
/// of 0, and no search spends more than its planning budget, or than a preparation, which its start
/// costs. At least 10 plans are found, and not all.
#[test]
fn plans_keep_to_both_budgets() {
    let mut found = 0;
    for frame in [200.0, 1e3, 1e4, 1e6] {
        for planning in [1e5, 1e6, 1e7, 1e9] {
            // Regular and chaotic motions.
            for degrees in [3.0, 60.0, 120.0, 171.0] {
                match Plan::search(
                    &scene(2.75, degrees, 20.0),
                    &M4F,
                    &Budget { frame, planning },
                ) {
                    Ok(plan) => {
                        assert!(
                            plan.spent <= planning && plan.cost <= frame && plan.horizon > 0.0,
                            "{plan:?}"
                        );
                        found += 1;
                    }
                    Err(PlanError::NoMethod { spent, .. }) => {
                        assert!(spent <= planning.max(M4F.preparation), "{spent}");
                    }
                    Err(error) => panic!("{error}"),
                }
            }
        }
    }

    assert!(
        (10..64).contains(&found),
        "{found} of 64: some plans are found, some budgets are too small"
    );
}

/// A frame budget that equals the cost of a plan gives the same plan, and a slightly smaller budget
/// one that costs less.
#[test]
fn frame_budget_of_the_exact_cost_is_enough() {
    for (mass_ratio, degrees) in [(1.0, 60.0), (1.0, 120.0), (2.75, 171.0), (1e3, 30.0)] {
        let scene = scene(mass_ratio, degrees, 20.0);
        // The budget of the plan itself, and slightly less.
        for costs in [&M3, &M4F] {
            let within = |frame| {
                Plan::search(
                    &scene,
                    costs,
                    &Budget {
                        frame,
                        planning: 1e10,
                    },
                )
            };

            let lavish = within(1e6).expect("a good scene");
            let enough = within(lavish.cost).expect("a good scene");
            assert_eq!(enough.stepping(), lavish.stepping());
            if let Ok(frugal) = within(lavish.cost.next_down()) {
                assert!(frugal.cost < lavish.cost, "{frugal:?} {lavish:?}");
            }
        }
    }
}

/// Returns the initial method of `scene` with this frame budget.
fn initial(scene: &Problem, costs: &Costs, frame: f32) -> Option<Stepping> {
    Stepping::initial(scene, costs, frame).expect("a pendulum")
}

/// With a large frame budget the initial method must be that in 64 bits. With its exact cost as the
/// budget it must be the same; with slightly less it must cost less; and with less than a step in
/// 64 bits costs, it must be in 32 bits.
#[test]
fn initial_method_is_in_64_bits_if_a_frame_pays_for_it() {
    for degrees in [60.0, 120.0, 171.0] {
        let scene = scene(2.75, degrees, 20.0);
        for costs in [&M3, &M4F] {
            let within = |frame| initial(&scene, costs, frame).expect("a method");
            let lavish = within(1e7);
            assert_eq!(lavish.method, Method::Extrapolation10Fixed64);
            assert_eq!(within(costs.of_frame(lavish)), lavish);

            // A budget just below the exact cost forces a cheaper method.
            let frugal = within(costs.of_frame(lavish).next_down());
            assert!(
                costs.of_frame(frugal) < costs.of_frame(lavish),
                "{frugal:?} {lavish:?}"
            );
            let poor = within(costs.fixed64.next_down());
            assert!(
                poor.method != Method::Extrapolation10Fixed64
                    && costs.of_frame(poor) < costs.fixed64,
                "{poor:?}"
            );
        }
    }
}

/// The largest relative energy error of an initial method in 20 s. Steps twice as long would have
/// up to 5e-3.
const INITIAL_ENERGY: f64 = 2e-3;

/// On each of four processors the initial method must be within the frame budget, and keep the
/// energy above rest for 20 s to a relative 2e-3 ([`INITIAL_ENERGY`]), from rest at 90, 120 and 180
/// degrees. At least six of the twelve must be in 32 bits. The mass ratio 100 is the largest that
/// can be set by keys.
#[test]
fn initial_method_resolves_the_energy_of_the_fastest_scenes() -> Result<(), Error> {
    let mut in_32_bits = 0;
    for (processor, degrees) in [CORTEX_M3, CORTEX_M4F, CORTEX_M0PLUS, STM32F405]
        .into_iter()
        .flat_map(|processor| [90.0, 120.0, 180.0].map(|degrees| (processor, degrees)))
    {
        let scene = scene(100.0, degrees, 20.0);
        let stepping = initial(&scene, &processor.costs, processor.frame).expect("a method");
        assert!(processor.costs.of_frame(stepping) <= processor.frame);
        in_32_bits += u32::from(stepping.method != Method::Extrapolation10Fixed64);

        // The energy of the whole motion.
        let pendulum = Pendulum::new(&scene.pendulum)?;
        let start = pendulum.energy_above_rest(&pendulum.to_state(&scene.start));
        let mut run = PlannedRun::new(&scene, stepping)?;
        let mut worst: f64 = 0.0;
        for _ in 0..scene.frames() {
            run.advance(1)?;
            worst = worst.max((run.energy_above_rest(&pendulum) / start - 1.0).abs());
        }
        assert!(worst <= INITIAL_ENERGY, "{stepping:?} {degrees}: {worst:e}");
    }

    assert!(in_32_bits >= 6, "{in_32_bits}");
    Ok(())
}

/// The method must have exactly 128 steps per frame.
#[test]
fn initial_method_of_mass_ratio_100_on_a_cortex_m3_is_fixed_point() {
    let stepping = initial(&scene(100.0, 120.0, 20.0), &M3, CORTEX_M3.frame);
    let expected = Stepping {
        method: Method::Rk4Fixed32,
        steps: 128,
    };
    assert_eq!(stepping, Some(expected));
}

/// Steps that resolve 20,000 rad/s cost more than a frame of a Cortex-M3 can pay for. A larger
/// budget pays for them.
#[test]
fn too_fast_motion_has_no_initial_method() {
    let mut scene = scene(1.0, 120.0, 20.0);
    scene.start.w2 = 2e4;
    assert_eq!(initial(&scene, &M3, CORTEX_M3.frame), None);
    assert!(initial(&scene, &M3, 1e9).is_some(), "at any cost");
}

/// A budget below a step in 64 bits gives fixed point. A mass ratio of 100,000, which fixed point
/// refuses, gives `f32`. A run by the initial method must be accepted in both cases.
#[test]
fn initial_method_can_be_run() {
    let poor = M3.fixed64.next_down();
    for (mass_ratio, frame, method) in [
        (1.0, poor, Method::Rk4Fixed32),
        (1e5, 1e9, Method::Rk4F32Direction),
    ] {
        let scene = scene(mass_ratio, 10.0, 20.0);
        let stepping = initial(&scene, &M3, frame).expect("a method");
        assert_eq!(stepping.method, method);
        assert!(PlannedRun::new(&scene, stepping).is_ok(), "{stepping:?}");
    }
}

/// Fixed point refuses the longest steps, which are tried first, of these fast scenes. The step
/// count that is returned must be accepted, and half of it refused.
#[test]
fn requested_method_takes_steps_that_it_accepts() {
    for degrees in [60.0, 120.0, 180.0] {
        let scene = scene(100.0, degrees, 20.0);
        let stepping = Stepping::of(&scene, Method::Rk4Fixed32).expect("a pendulum");
        assert!(PlannedRun::new(&scene, stepping).is_ok(), "{stepping:?}");
        let longer = Stepping {
            steps: stepping.steps / 2,
            ..stepping
        };
        assert!(PlannedRun::new(&scene, longer).is_err(), "{longer:?}");
    }
}

/// A requested method has the longest steps that resolve the motion: exactly 7 per frame by
/// extrapolation in 64 bits, 4 by fixed point of 32 bits and 2 by compensated `f32`.
///
/// Steps in 64 bits have a high order, but are shorter than the first steps of other methods. Fixed
/// point refuses 2 steps here.
#[test]
fn requested_method_has_steps_that_resolve_the_motion() {
    let scene = scene(2.75, 171.0, 20.0);
    let steps = |method| Stepping::of(&scene, method).expect("a pendulum").steps;
    assert_eq!(
        [
            Method::Extrapolation10Fixed64,
            Method::Rk4Fixed32,
            Method::Rk4F32Direction
        ]
        .map(steps),
        [7, 4, 2]
    );
}

/// Evaluated in 64 bits, a small pendulum that hangs at rest is accurate to the end: shadows of a
/// motion without energy do not leave their range.
#[test]
fn a_pendulum_at_rest_is_accurate_to_the_end() -> Result<(), PlanError> {
    let mut still = scene(1.0, 0.0, 30.0);
    still.pendulum = Parameters {
        m1: 0.01,
        m2: 0.01,
        l1: 0.03,
        l2: 0.03,
        g: 9.81,
    };
    still.tolerance = half_pixel(&still.pendulum, 64.0);
    for costs in [M3, M4F] {
        let stepping = Stepping {
            method: Method::Extrapolation10Fixed64,
            steps: 2,
        };
        let budget = Budget {
            frame: 1e9,
            planning: 1e10,
        };
        let mut search = Search::of(stepping, &still, &costs, &budget)?;
        assert_eq!(finished(&mut search).limit, Limit::End);
    }
    Ok(())
}

/// Each method in its own steps must be accepted as a run, and its evaluation must find that all
/// frames of a second are accurate. For the closed form this must hold at any step count.
///
/// Equal rods are close to the end of the range of fixed point. The runs that a motion is compared
/// with must not be refused if the motion itself is not.
#[test]
fn methods_that_can_be_run_can_be_evaluated() {
    let methods = [
        Method::Rk4Fixed32,
        Method::Rk4F32Direction,
        Method::Extrapolation10Fixed64,
    ];

    let large = [60.0, 90.0, 120.0]
        .into_iter()
        .flat_map(|degrees| methods.map(|method| (degrees, method)));
    for (degrees, method) in large.chain([(3.0, Method::ClosedFormF32)]) {
        let scene = scene(1.0, degrees, 1.0);
        let stepping = Stepping::of(&scene, method).expect("a pendulum");
        assert!(
            PlannedRun::new(&scene, stepping).is_ok(),
            "{stepping:?} at {degrees}"
        );
        let mut search =
            Search::of(stepping, &scene, &M3, &CORTEX_M3.budget(&scene)).expect("a good scene");
        let plan = finished(&mut search);
        // The closed form has no steps.
        let steps = if method == Method::ClosedFormF32 {
            stepping.steps + 7
        } else {
            stepping.steps
        };

        let horizons = [plan.horizon, search.horizon(Stepping { method, steps })];
        assert_eq!(horizons, [scene.duration; 2], "{plan:?} at {degrees}");
    }
}

/// A tolerance, duration, mass, price or budget that is NaN, infinite, zero or negative; a rate of
/// 0; an infinite velocity; and too many frames must be refused with exactly the expected error.
#[test]
fn errors_contain_the_parameter_and_its_value() {
    let good = scene(1.0, 90.0, 10.0);
    let budget = STM32F405.budget(&good);
    let refused = |scene: Problem, costs: Costs, budget: Budget, expected: Error| {
        let found = Plan::search(&scene, &costs, &budget).expect_err("refused");
        assert_eq!(
            format!("{found:?}"),
            format!("{:?}", PlanError::Refused(expected))
        );
    };

    // No number, infinite, zero, and negative.
    for value in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let error = |parameter| match value.is_finite() {
            true => Error::NotPositive { parameter, value },
            false => Error::NotFinite { parameter, value },
        };
        let single = value as f32;
        let pendulum = Parameters {
            m2: value,
            ..good.pendulum
        };
        refused(
            Problem {
                tolerance: value,
                ..good
            },
            M4F,
            budget,
            error(Parameter::Tolerance),
        );

        refused(
            Problem {
                duration: value,
                ..good
            },
            M4F,
            budget,
            error(Parameter::Duration),
        );

        refused(
            Problem { pendulum, ..good },
            M4F,
            budget,
            error(Parameter::M2),
        );

        let mut costs = M4F;
        costs.direction = single;
        let parameter = Parameter::Price(Method::Rk4F32Direction);
        refused(good, costs, budget, error(parameter));

        let mut costs = M4F;
        costs.preparation = single;
        refused(good, costs, budget, error(Parameter::Preparation));

        let mut costs = M4F;
        costs.comparison = single;
        refused(good, costs, budget, error(Parameter::Comparison));

        refused(
            good,
            M4F,
            Budget {
                frame: single,
                ..budget
            },
            error(Parameter::FrameBudget),
        );

        refused(
            good,
            M4F,
            Budget {
                planning: single,
                ..budget
            },
            error(Parameter::PlanningBudget),
        );
    }

    let parameter = Parameter::Rate;
    refused(
        Problem { rate: 0, ..good },
        M4F,
        budget,
        Error::NotPositive {
            parameter,
            value: 0.0,
        },
    );

    let parameter = Parameter::W1;
    let value = f64::NEG_INFINITY;
    let start = Motion {
        w1: value,
        ..good.start
    };
    refused(
        Problem { start, ..good },
        M4F,
        budget,
        Error::NotFinite { parameter, value },
    );

    let parameter = Parameter::Duration;
    let limit = f64::from(u32::MAX) / f64::from(RATE);
    let too_long = Error::TooLarge {
        parameter,
        value: 1e9,
        limit,
    };

    refused(
        Problem {
            duration: 1e9,
            ..good
        },
        M4F,
        budget,
        too_long,
    );
}

/// A reference that planning cannot pay for leaves no promise, and the limit is the planning budget.
/// A frame that pays for no candidate leaves none either, and the limit is the frame budget.
#[test]
fn limit_without_a_plan_is_the_budget_to_raise() {
    let scene = scene(1.0, 120.0, 20.0);
    let limit = |frame, planning| match Plan::search(&scene, &M3, &Budget { frame, planning }) {
        Err(PlanError::NoMethod { limit, .. }) => limit,
        other => panic!("{other:?}"),
    };
    assert_eq!(limit(CORTEX_M3.frame, 1e6), Limit::Planning);
    assert_eq!(limit(100.0, 1e9), Limit::Budget);
}

/// Returns 200 random problems at the usual rate and height, with mass ratios of 0.1 to 10, length
/// ratios of 0.3 to 3 and any angles at rest, for 3 s.
fn random_problems() -> impl Iterator<Item = Problem> {
    let mut rng = Rng::with_seed(5);
    (0..200).map(move |_| {
        let pendulum = Parameters {
            m1: 1.0,
            m2: log_uniform(&mut rng, 0.1, 10.0),
            l1: 1.0,
            l2: log_uniform(&mut rng, 0.3, 3.0),
            g: 9.81,
        };
        let start = Motion::at_rest(PI * symmetric(&mut rng), PI * symmetric(&mut rng));
        Problem {
            pendulum,
            start,
            tolerance: half_pixel(&pendulum, 64.0),
            duration: 3.0,
            rate: RATE,
        }
    })
}

/// Returns the horizon of a plan, s; 0 if there is none.
fn horizon(problem: &Problem, costs: &Costs, budget: &Budget) -> f64 {
    Plan::search(problem, costs, budget).map_or(0.0, |plan| plan.horizon)
}

/// Twice the frame budget, or twice the planning budget, never gives a shorter horizon than the
/// smaller budgets do, except for one frame. The smaller budgets pay for a part of the methods.
#[test]
fn a_larger_budget_never_gives_a_shorter_horizon() {
    const FRAME: f64 = 1.0 / RATE as f64;
    random_problems().par_bridge().for_each(|problem| {
        for (costs, frame) in [(M3, 15e3), (M3, 60e3), (M4F, 4e3), (M4F, 40e3)] {
            let planning = 2.0 * frame * problem.frames() as f32;
            let small = horizon(&problem, &costs, &Budget { frame, planning });
            for (frame, planning) in [(2.0 * frame, planning), (frame, 2.0 * planning)] {
                let large = horizon(&problem, &costs, &Budget { frame, planning });
                assert!(
                    large >= small - 1.001 * FRAME,
                    "{small} {large} with {frame} {planning}: {problem:?}"
                );
            }
        }
    });
}

/// The mirror image of a motion, and the motion with all lengths and gravity four times as large,
/// have the same plan. The bits of all numbers are then the same, except for signs and exponents.
#[test]
fn a_plan_does_not_depend_on_the_side_or_on_the_unit_of_length() {
    random_problems().par_bridge().for_each(|problem| {
        let Problem {
            pendulum: Parameters { l1, l2, g, .. },
            start: Motion { a1, a2, .. },
            ..
        } = problem;
        let mirrored = Problem {
            start: Motion::at_rest(-a1, -a2),
            ..problem
        };
        let scaled = Problem {
            pendulum: Parameters {
                l1: 4.0 * l1,
                l2: 4.0 * l2,
                g: 4.0 * g,
                ..problem.pendulum
            },
            tolerance: 4.0 * problem.tolerance,
            ..problem
        };
        for processor in [CORTEX_M3, CORTEX_M4F] {
            let plan = |problem: &Problem| {
                let budget = processor.budget(problem);
                let plan = Plan::search(problem, &processor.costs, &budget);
                plan.map(|plan| (plan.stepping(), plan.limit, plan.horizon))
            };
            assert_eq!(plan(&problem), plan(&mirrored), "{problem:?}");
            assert_eq!(plan(&problem), plan(&scaled), "{problem:?}");
        }
    });
}
