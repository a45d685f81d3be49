//! The planner of a scene: its work in a tick, its results, and their format in messages.

use double_pendulum::Method;
use double_pendulum::plan::{Budget, Limit, Plan, PlanError, Problem, Stepping};
use emulator::host::Show;
use firmware::config::{
    CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, PLANNED, PROCESSORS, Processor, SETTLED_TICKS, STM32F405,
    TICK_RATE,
};
use firmware::graphics::Format;
use firmware::motion::{CatchingUp, Horizon, Planner, Resources, Settings, Simulation};
use firmware::protocol::{Command, Field};
use firmware::scenes::SceneName;

/// The initial stepping of these tests, with finer steps than any reference. It is accurate for at
/// least as long as any other stepping.
const LASTING: Stepping = Stepping {
    method: Method::Extrapolation10Fixed64,
    steps: 8,
};
/// The height of the planned display, pixels.
const HEIGHT: f32 = 57.0;
/// The number of ticks until all results here are found.
const PATIENCE: u64 = 1200;

/// Returns a planner that has just started with [`LASTING`].
fn planner(processor: Processor, settings: &Settings) -> Planner {
    let mut planner = Planner::new(processor);
    planner.start(settings, Some(HEIGHT), Some(LASTING), false);
    planner
}

/// In the first [`SETTLED_TICKS`] ticks a planner does no work, not even in advance, and has no
/// horizon. Then it begins. So a held button restarts the scene before any planning.
#[test]
fn nothing_is_planned_before_the_start_has_settled() {
    let mut planner = planner(CORTEX_M3, &Settings::default());
    for _ in 0..SETTLED_TICKS {
        assert!(!planner.work_ahead());
        assert_eq!((planner.tick(), planner.horizon(LASTING)), (None, 0.0));
    }
    planner.tick();
    assert!(
        planner.is_searching()
            && planner
                .planned()
                .is_some_and(|answer| answer.found.is_none())
    );
    assert!((0..PATIENCE).any(|_| planner.tick().is_some() || planner.horizon(LASTING) > 0.0));
}

/// A tick that pays for exactly one preparation is enough to begin: a preparation may use the whole
/// budget of a tick that has not spent anything yet.
#[test]
fn a_preparation_may_use_the_whole_budget_of_a_tick() {
    let processor = Processor {
        look_ahead: CORTEX_M3.costs.preparation,
        ..CORTEX_M3
    };
    let mut planner = planner(processor, &Settings::default());
    assert!((0..PATIENCE).any(|_| planner.tick().is_some() || planner.horizon(LASTING) > 0.0));
}

/// The results do not depend on whether all or some of the planning is done before its tick.
#[test]
fn results_of_a_tick_do_not_depend_on_when_the_work_is_done() {
    for settings in [Settings::default(), Settings::equal_rods(1.0, 20.0)] {
        let [mut late, mut early, mut uneven] = [(); 3].map(|()| planner(CORTEX_M4F, &settings));
        // All work in its tick, all work in advance, and some of it in advance.
        for tick in 0..PATIENCE {
            while early.work_ahead() {}
            for _ in 0..tick % 7 {
                uneven.work_ahead();
            }
            let found = late.tick();
            assert_eq!((early.tick(), uneven.tick()), (found, found), "tick {tick}");
            let horizons = [&early, &uneven].map(|planner| planner.horizon(LASTING));
            assert_eq!(horizons, [late.horizon(LASTING); 2], "tick {tick}");
        }
    }
}

/// The reports and events of a scene do not depend on planning in advance. This is true at any
/// speed, after a pause, and in ticks of the clock in which the scene does not advance.
#[test]
fn reports_do_not_depend_on_work_in_advance_at_any_speed() {
    const SPEEDS: [f64; 4] = [1.0, 0.5, 0.01, 1.5];
    let calm = Settings::equal_rods(1.0, 20.0);
    for (name, settings) in [
        (SceneName::Page, Settings::default()),
        (SceneName::Page, calm),
        (SceneName::Beats2To1, SceneName::Beats2To1.first_settings()),
    ] {
        for speed in SPEEDS {
            let [mut late, mut early] =
                [(); 2].map(|()| Show::new(name, &settings).expect("good settings"));
            let set_speed = Command::Set {
                field: Field::Speed,
                value: speed,
            };
            for tick in 0..PATIENCE {
                while early.player.look_ahead() {}
                for show in [&mut late, &mut early] {
                    // A pause of 10 ticks begins before every 50th tick, as by a button.
                    let command = match tick % 50 {
                        0 => Command::Pause(true),
                        10 => Command::Pause(false),
                        _ => set_speed,
                    };
                    assert_eq!(show.player.execute(command), Ok(false));
                    show.tick();
                }
                assert_eq!(
                    early.report(),
                    late.report(),
                    "{}, speed {speed}, tick {tick}",
                    name.name()
                );
            }
            assert_eq!(early.news, late.news);
        }
    }
}

/// A paused scene is still, and plans nothing in advance. A scene that plays does, and one piece
/// does not spend the budget of a tick.
#[test]
fn a_paused_scene_plans_nothing_in_advance() {
    let mut show = Show::new(SceneName::Page, &Settings::default()).expect("good settings");
    for _ in 0..=SETTLED_TICKS {
        show.tick();
    }
    for paused in [false, true, false] {
        assert_eq!(show.player.execute(Command::Pause(paused)), Ok(false));
        assert_eq!(
            (show.player.is_still(), show.player.look_ahead()),
            (paused, !paused)
        );
    }
}

/// A scene whose pendulum hangs at rest has nothing to plan: its frames are always accurate.
#[test]
fn a_pendulum_at_rest_is_always_accurate() {
    let mut show =
        Show::new(SceneName::Beats2To1, &Settings::equal_rods(1.0, 0.0)).expect("good settings");
    assert_eq!(show.report().horizon, Horizon::Always);
    show.tick();
    assert_eq!(show.report().horizon, Horizon::Always);
}

/// A planner without a task plans nothing. After the last result is found, one tick reports it, and
/// nothing more is done until a new motion starts, which has no result and no horizon yet. The
/// initial stepping keeps the horizon that the search has verified.
#[test]
fn nothing_is_planned_without_a_motion_or_after_the_plan() {
    let mut still = Planner::new(CORTEX_M3);
    assert!(still.tick().is_none() && !still.work_ahead() && !still.is_searching());
    still.start(&Settings::default(), None, None, false);
    assert!(still.tick().is_none() && !still.work_ahead() && !still.is_searching());

    // Plan a motion until its last result is found.
    let mut planner = planner(STM32F405, &Settings::default());
    while planner.is_searching() {
        planner.tick();
    }
    let found = planner.planned().and_then(|answer| answer.found);
    let plan = found.expect("a result").expect("a plan");
    assert!(
        !planner.work_ahead() && planner.tick().is_some(),
        "the result has a tick of its own"
    );
    assert!(!planner.work_ahead() && planner.tick().is_none());
    assert!(plan.stepping() != LASTING && planner.horizon(LASTING) >= plan.horizon);

    // A new motion must not inherit the result of the one before.
    planner.start(
        &Settings::equal_rods(1.0, 30.0),
        Some(HEIGHT),
        Some(LASTING),
        false,
    );
    assert_eq!(
        (
            planner.planned().map(|answer| answer.found),
            planner.horizon(LASTING)
        ),
        (Some(None), 0.0),
        "the new motion has no result yet"
    );
}

/// Steps in 64 bits with at least as many steps per frame as the reference, four here, are accurate
/// for as long as any other stepping. Longer steps are accurate only for the time that they have
/// been verified themselves.
#[test]
fn only_steps_as_fine_as_the_reference_inherit_its_horizon() {
    let in_32_bits = |planner: &Planner| {
        let steppings = [1, 2, 4, 8, 16].map(|steps| Stepping {
            method: Method::Rk4Fixed32,
            steps,
        });
        steppings
            .map(|stepping| planner.horizon(stepping))
            .into_iter()
            .fold(0.0, f64::max)
    };

    // Two steps are coarser than the reference, four are not.
    for (steps, is_right) in [(2, false), (4, true)] {
        let initial = Stepping {
            method: Method::Extrapolation10Fixed64,
            steps,
        };
        let mut planner = Planner::new(CORTEX_M3);
        planner.start(
            &Settings::equal_rods(2.75, 171.0),
            Some(HEIGHT),
            Some(initial),
            false,
        );

        // The planner has verified some method in 32 bits.
        while in_32_bits(&planner) < 1.0 {
            assert!(planner.tick().is_none());
        }
        assert_eq!(planner.horizon(initial) > 0.0, is_right, "{initial:?}");
    }
}

/// Following a result takes time, so nothing else is done until it is reported. The horizon of a
/// motion that is accurate for the whole planned time is then extended, always by the same time
/// ahead.
#[test]
fn a_calm_motion_is_verified_while_it_is_played() {
    let mut planner = planner(STM32F405, &Settings::equal_rods(1.0, 20.0));
    let mut ticks = 1;
    while planner
        .planned()
        .is_some_and(|answer| answer.found.is_none())
    {
        assert!(planner.tick().is_none());
        ticks += 1;
    }

    // The plan is complete, and reported one tick later.
    assert!(!planner.work_ahead() && planner.horizon(LASTING) == PLANNED);
    assert!(matches!(planner.tick(), Some(Ok(plan)) if plan.limit == Limit::End));

    assert!(planner.work_ahead());
    for tick in ticks + 1..3600_u64 {
        planner.tick();
        if tick > 600 {
            let ahead = planner.horizon(LASTING) - tick as f64 / 60.0;
            assert!(
                planner.is_searching() && (ahead - PLANNED).abs() < 0.1,
                "tick {tick}: {ahead}"
            );
        }
    }
}

/// The initial stepping of a scene with two results: of a preliminary plan, and a final one.
const REPLACED: Stepping = Stepping {
    method: Method::Rk4F32Direction,
    steps: 4,
};

/// Returns both results of a scene that begins with [`REPLACED`], each with the tick of its report,
/// and the planner after them.
fn two_results(processor: Processor, settings: &Settings) -> ([(u64, Plan); 2], Planner) {
    let mut planner = Planner::new(processor);
    planner.start(settings, Some(HEIGHT), Some(REPLACED), false);
    let results: Vec<_> = (1..60 * PATIENCE)
        .filter_map(|tick| Some((tick, planner.tick()?.ok()?)))
        .take(2)
        .collect();
    (results.try_into().expect("two results"), planner)
}

/// A preliminary plan that can catch up before its horizon is followed from its report on. The
/// final horizon, here of 18 minutes, is about the same method, although a start of that method in
/// the tick of the final result would come too late.
#[test]
fn final_result_is_about_the_plan_that_is_followed() {
    let settings = Settings::equal_rods(3.0, 38.0);
    let (results, planner) = two_results(CORTEX_M3, &settings);
    let [(early, preliminary), (late, last)] = results;
    assert_eq!(preliminary.stepping(), last.stepping(), "{results:?}");
    assert!(last.horizon > PLANNED && planner.horizon(last.stepping()) == last.horizon);

    // Only the tick of the first report is in time.
    let arrival = |tick| CatchingUp::arrival(&settings, last.stepping(), &CORTEX_M3, tick);
    assert!(
        arrival(early) <= preliminary.horizon && last.horizon < arrival(late),
        "{results:?}"
    );
}

/// A preliminary plan that would catch up only after its horizon is not followed. If its final
/// horizon comes too late as well, the result is the horizon of the initial method.
#[test]
fn final_result_is_about_the_initial_method_if_the_plan_is_too_late() {
    let settings = Settings {
        degrees: [81.0, 64.0],
        ..Settings::equal_rods(0.17, 0.0)
    };
    let (results, planner) = two_results(CORTEX_M0PLUS, &settings);
    let [(early, preliminary), (_, last)] = results;
    let arrival = CatchingUp::arrival(&settings, preliminary.stepping(), &CORTEX_M0PLUS, early);
    assert!(arrival > preliminary.horizon, "{results:?}");
    assert_eq!(last.stepping(), REPLACED, "{results:?}");
    assert!(last.horizon > 0.0 && planner.horizon(REPLACED) == last.horizon);
}

/// A first plan that ends early, in steps that do not resolve the motion, is not followed, although
/// it could catch up in time. The result is the horizon of the initial method. Without an initial
/// method the plan is reported.
#[test]
fn a_plan_that_ends_early_and_does_not_resolve_the_motion_is_not_followed() {
    let processor = CORTEX_M4F;
    let settings = Settings::equal_rods(100.0, 105.0);
    let problem = settings.problem(HEIGHT);
    let initial = Stepping::initial(&problem, &processor.costs, processor.frame);
    let initial = initial.expect("good settings").expect("a method");
    assert_eq!(initial.resolves(&problem), Ok(true));
    // The first result, and the tick of its report.
    let first = |initial| {
        let mut planner = Planner::new(processor);
        planner.start(&settings, Some(HEIGHT), initial, false);
        let found = (0..PATIENCE).find_map(|_| planner.tick());
        (found.expect("a result").expect("a plan"), planner.ticks)
    };

    let (plan, tick) = first(None);
    assert!(plan.limit != Limit::End && plan.stepping().resolves(&problem) == Ok(false));
    assert!(CatchingUp::arrival(&settings, plan.stepping(), &processor, tick) <= plan.horizon);

    let (kept, _) = first(Some(initial));
    assert_eq!((kept.stepping(), kept.limit), (initial, Limit::Method));
}

/// A plan for the initial method itself is never too late, because nothing has to catch up. It is
/// the result, and the method is not searched again.
#[test]
fn a_late_plan_for_the_initial_method_is_the_result() {
    let initial = Stepping {
        method: Method::Extrapolation10Fixed64,
        steps: 2,
    };
    let mut planner = Planner::new(CORTEX_M0PLUS);
    planner.start(&Settings::default(), Some(HEIGHT), Some(initial), false);
    let found = (0..2 * PATIENCE).find_map(|_| planner.tick());
    let plan = found.expect("a result").expect("a plan");
    let arrival = CatchingUp::arrival(&Settings::default(), initial, &CORTEX_M0PLUS, planner.ticks);
    assert!(arrival > plan.horizon, "{plan:?}");
    assert_eq!((plan.stepping(), plan.limit), (initial, Limit::Growth));
}

/// After its horizon, a motion in 64 bits continues as it is. One in 32 bits continues by the
/// initial stepping if that is in 64 bits, or if its own steps do not resolve the motion.
#[test]
fn a_motion_changes_its_method_after_the_horizon_only_to_keep_its_energy() {
    let stepping = |method, steps| Stepping { method, steps };
    let in_64_bits = |steps| stepping(Method::Extrapolation10Fixed64, steps);
    let in_32_bits = |steps| stepping(Method::Rk4Fixed32, steps);
    for (initial, stepping, expected) in [
        (in_64_bits(3), in_64_bits(3), None),
        (in_64_bits(3), in_64_bits(4), None),
        (in_64_bits(3), in_32_bits(8), Some(in_64_bits(3))),
        (in_32_bits(4), in_64_bits(3), None),
        (in_32_bits(4), in_32_bits(8), None),
        (in_32_bits(4), in_32_bits(1), Some(in_32_bits(4))),
    ] {
        let mut planner = Planner::new(CORTEX_M3);
        planner.start(&Settings::default(), Some(HEIGHT), Some(initial), false);
        assert_eq!(
            planner.resolving(stepping),
            expected,
            "{stepping:?} after {initial:?}"
        );
    }
}

/// Settings with a mass ratio of NaN have one result in all ticks: the error.
#[test]
fn a_refused_motion_is_reported_once() {
    let mut planner = planner(CORTEX_M3, &Settings::equal_rods(f64::NAN, 20.0));
    let found: Vec<_> = (0..PATIENCE).filter_map(|_| planner.tick()).collect();
    assert!(
        matches!(found[..], [Err(PlanError::Refused(_))]),
        "{found:?}"
    );
}

/// A processor with 100 cycles for a frame can afford neither a step nor a closed form. The result
/// is `NoMethod`, and is kept with the problem and the budget.
#[test]
fn planner_reports_that_no_method_fits() {
    let mut planner = planner(
        Processor {
            frame: 100.0,
            ..CORTEX_M4F
        },
        &Settings::equal_rods(1.0, 120.0),
    );
    let found = (0..PATIENCE).find_map(|_| planner.tick());
    assert!(
        matches!(found, Some(Err(PlanError::NoMethod { .. }))),
        "{found:?}"
    );
    // The failure is kept, with the budget for which it was found.
    let answer = planner.planned().expect("a motion");
    assert_eq!(answer.found, found);
    assert_eq!(
        (answer.duration, answer.height, answer.frame),
        (PLANNED, HEIGHT, 100.0)
    );
}

/// The planner verifies only the requested method, even if it costs more than a frame allows, and
/// finds a horizon of 9.5 to 10.5 s. `cargo prove --scene page --method rk4-f32-direction --steps
/// 4` proves it accurate until 10.5 s.
#[test]
fn a_requested_stepping_is_kept() {
    let mut planner = Planner::new(STM32F405);
    let stepping = Stepping {
        method: Method::Rk4F32Direction,
        steps: 4,
    };
    planner.start(&Settings::default(), Some(HEIGHT), Some(stepping), true);
    let found = (0..PATIENCE).find_map(|_| planner.tick());
    let Some(Ok(plan)) = found else {
        panic!("{found:?}")
    };
    assert_eq!(
        (plan.method, plan.steps, plan.limit),
        (Method::Rk4F32Direction, 4, Limit::Method)
    );
    assert!((10.4..=11.4).contains(&plan.horizon), "{plan:?}");
}

/// A requested method may cost the whole budget of a frame, but not more.
#[test]
fn a_requested_method_may_cost_the_budget_of_a_frame() {
    let method = Method::Rk4Fixed32;
    let settings = Settings::default();
    let stepping = Stepping::of(&settings.problem(HEIGHT), method).expect("good settings");
    let cost = CORTEX_M3.costs.of_frame(stepping);
    for (frame, is_affordable) in [(cost, true), (cost - 1.0, false)] {
        let resources = Resources {
            format: Format::OLED,
            processor: Processor { frame, ..CORTEX_M3 },
            method: Some(method),
        };
        let simulation = Simulation::new(&settings, &resources);
        assert_eq!(simulation.is_ok(), is_affordable, "{frame} of {cost}");
    }
}

/// The code of a class of processors on the link is its index in [`PROCESSORS`].
#[test]
fn the_code_of_every_processor_is_its_place() {
    assert!(
        (0..)
            .zip(PROCESSORS)
            .all(|(place, processor)| processor.code == place)
    );
}

/// A floating-point unit is recognised by the prices: with one, a step in `f32` costs less than one
/// in fixed point.
#[test]
fn equal_prices_count_as_without_a_floating_point_unit() {
    assert_eq!(
        PROCESSORS.map(|processor| processor.has_float()),
        [false, true, true, false]
    );

    let mut equal = CORTEX_M4F;
    equal.costs.direction_plain = equal.costs.fixed32;
    assert!(!equal.has_float());
}

/// A frame of 1/60 s has the budget of a tick, to the bit. At another rate a second has the same
/// budgets, so that no processor is faster at a higher rate.
#[test]
fn a_second_has_the_same_budgets_at_every_rate() {
    let usual = Settings::default().problem(HEIGHT);
    for processor in PROCESSORS {
        let whole = processor.budget(&usual);
        let Budget { frame, planning } = whole;
        assert_eq!(u32::from(usual.rate), TICK_RATE);
        assert_eq!(frame.to_bits(), processor.frame.to_bits());
        let ticks = usual.frames() as f32;
        assert_eq!(planning.to_bits(), (processor.look_ahead * ticks).to_bits());

        for rate in [1, 24, 30, 120, 2500, u16::MAX] {
            let part = processor.budget(&Problem { rate, ..usual });
            let is_near = |one: f32, other: f32| (one / other - 1.0).abs() < 1e-6;
            let second = f32::from(rate) * part.frame;
            assert!(is_near(second, 60.0 * frame), "{rate}: {second}");
            assert!(is_near(part.planning, planning), "{rate}: {part:?}");
        }
    }
}
