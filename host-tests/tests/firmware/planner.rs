//! The planner of a scene: its work in a tick, its results, and their format in messages.

use boards::host::Show;
use double_pendulum::Method;
use double_pendulum::plan::{Budget, Limit, PlanError, Problem, Stepping};
use firmware::config::{
    CORTEX_M3, CORTEX_M4F, PLANNED, PROCESSORS, Processor, SETTLED_TICKS, STM32F405, TICK_RATE,
};
use firmware::graphics::Format;
use firmware::motion::{Horizon, PlanResult, Planner, Resources, Settings, Simulation};
use firmware::protocol::{Command, Field};
use firmware::scenes::SceneName;

/// The height of the planned display, pixels.
const HEIGHT: f32 = 57.0;
/// The number of ticks until all results here are found.
const PATIENCE: u64 = 1200;

/// Returns a planner that has just started.
fn planner(processor: Processor, settings: &Settings) -> Planner {
    let mut planner = Planner::new(processor);
    planner.start(settings, Some(HEIGHT), None);
    planner
}

/// Returns the method and step count that the scene starts with.
fn initial(processor: Processor, settings: &Settings) -> Stepping {
    let problem = settings.problem(HEIGHT);
    let initial = Stepping::initial(&problem, &processor.costs, processor.frame);
    initial.expect("good settings").expect("a method")
}

/// Returns the first result, and the tick of its report, of a planner whose scene plays.
fn first(planner: &mut Planner) -> (PlanResult, u64) {
    let found = (1..2 * PATIENCE).find_map(|tick| Some((planner.tick(tick)?, tick)));
    found.expect("a result")
}

/// In the first [`SETTLED_TICKS`] ticks a planner does no work, not even in advance, and has no
/// horizon. Then it begins. So a held button restarts the scene before any planning.
#[test]
fn nothing_is_planned_before_the_start_has_settled() {
    let settings = Settings::default();
    let initial = initial(CORTEX_M3, &settings);
    let mut planner = planner(CORTEX_M3, &settings);
    for tick in 0..SETTLED_TICKS {
        assert!(!planner.work_ahead());
        assert_eq!((planner.tick(tick), planner.horizon(initial)), (None, 0.0));
    }
    let found = |planner: &Planner| planner.planned().map(|answer| answer.found);
    assert_eq!(found(&planner), Some(None));
    assert!((SETTLED_TICKS..PATIENCE).any(|tick| {
        assert_eq!(planner.tick(tick), None);
        planner.horizon(initial) > 0.0
    }));
}

/// A tick that pays for exactly one preparation is enough to begin: a preparation may use the whole
/// budget of a tick that has not spent anything yet.
#[test]
fn a_preparation_may_use_the_whole_budget_of_a_tick() {
    let processor = Processor {
        look_ahead: CORTEX_M3.costs.preparation,
        ..CORTEX_M3
    };
    let settings = Settings::default();
    let initial = initial(processor, &settings);
    let mut planner = planner(processor, &settings);
    assert!(
        (0..PATIENCE).any(|tick| planner.tick(tick).is_some() || planner.horizon(initial) > 0.0)
    );
}

/// The results do not depend on whether all or some of the planning is done before its tick.
#[test]
fn results_of_a_tick_do_not_depend_on_when_the_work_is_done() {
    for settings in [Settings::default(), Settings::equal_rods(1.0, 20.0)] {
        let initial = initial(CORTEX_M4F, &settings);
        let [mut late, mut early, mut uneven] = [(); 3].map(|()| planner(CORTEX_M4F, &settings));
        // All work in its tick, all work in advance, and some of it in advance.
        for tick in 0..PATIENCE {
            while early.work_ahead() {}
            for _ in 0..tick % 7 {
                uneven.work_ahead();
            }
            let found = late.tick(tick);
            let others = [early.tick(tick), uneven.tick(tick)];
            assert_eq!(others, [found; 2], "tick {tick}");
            let horizons = [&early, &uneven].map(|planner| planner.horizon(initial));
            assert_eq!(horizons, [late.horizon(initial); 2], "tick {tick}");
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
    assert!(still.tick(1).is_none() && !still.work_ahead());
    still.start(&Settings::default(), None, None);
    assert!(still.tick(1).is_none() && !still.work_ahead());

    let settings = Settings::default();
    let mut planner = planner(STM32F405, &settings);
    let found = |planner: &Planner| planner.planned().and_then(|answer| answer.found);
    let mut ticks = 0..;
    while found(&planner).is_none() {
        planner.tick(ticks.next().expect("no end"));
    }
    let plan = found(&planner).expect("a result").expect("a plan");
    assert!(!planner.work_ahead() && planner.tick(0).is_some() && planner.is_settled());
    assert!(!planner.work_ahead() && planner.tick(0).is_none());
    assert_eq!(planner.horizon(plan.stepping()), plan.horizon);
    assert!(planner.horizon(initial(STM32F405, &settings)) > 0.0);

    // A new motion must not inherit the result of the one before.
    planner.start(&Settings::equal_rods(1.0, 30.0), Some(HEIGHT), None);
    assert_eq!(
        (found(&planner), planner.horizon(plan.stepping())),
        (None, 0.0)
    );
}

/// Following a result takes time, so nothing else is done until it is reported. The horizon of a
/// motion that is accurate for the whole planned time is then extended, always by the same time
/// ahead.
#[test]
fn a_calm_motion_is_verified_while_it_is_played() {
    let mut planner = planner(STM32F405, &Settings::equal_rods(1.0, 20.0));
    let (found, ticks) = first(&mut planner);
    let plan = found.expect("a plan");
    assert_eq!((plan.limit, plan.horizon), (Limit::End, PLANNED));

    assert!(planner.work_ahead());
    for tick in ticks + 1..3600 {
        planner.tick(tick);
        if tick > 600 {
            let ahead = planner.horizon(plan.stepping()) - tick as f64 / 60.0;
            assert!(
                !planner.is_settled() && (ahead - PLANNED).abs() < 0.1,
                "tick {tick}: {ahead}"
            );
        }
    }
}

/// Settings with a mass ratio of NaN have one result in all ticks: the error.
#[test]
fn a_refused_motion_is_reported_once() {
    let mut planner = planner(CORTEX_M3, &Settings::equal_rods(f64::NAN, 20.0));
    let found: Vec<_> = (0..PATIENCE)
        .filter_map(|tick| planner.tick(tick))
        .collect();
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
    let (found, _) = first(&mut planner);
    assert!(
        matches!(found, Err(PlanError::NoMethod { .. })),
        "{found:?}"
    );
    // The failure is kept, with the budget for which it was found.
    let answer = planner.planned().expect("a motion");
    assert_eq!(answer.found, Some(found));
    assert_eq!(
        (answer.duration, answer.height, answer.frame),
        (PLANNED, HEIGHT, 100.0)
    );
}

/// The planner verifies only the requested method, even if it costs more than a frame allows.
/// `cargo prove --scene page --method rk4-f32-direction --steps 4` proves the frames until 10.9 s.
#[test]
fn a_requested_stepping_is_kept() {
    let mut planner = Planner::new(STM32F405);
    let stepping = Stepping {
        method: Method::Rk4F32Direction,
        steps: 4,
    };
    planner.start(&Settings::default(), Some(HEIGHT), Some(stepping));
    let (found, _) = first(&mut planner);
    let plan = found.expect("a plan");
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
