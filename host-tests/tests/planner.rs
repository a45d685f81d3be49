//! The planner between the frames: when it may work, what it finds, and how that is written on the wire.

use double_pendulum::plan::{Limit, Method};
use firmware::config::PLANNING_PIECE;
use firmware::motion::planner::{Finding, Planner, Shown};
use firmware::motion::settings::Settings;
use firmware::protocol::{NO_METHOD, limit_code, method_code};

/// Cycles in a tick of a Cortex-M3 at 50 MHz, and the quarter that is never planned away.
const TICK: u32 = 833_333;
const RESERVE: u32 = TICK / 4;
/// Cycles that a piece must find free: a quarter more than what it takes, none of the first steps costing more.
const PIECE: u32 = (1.25 * PLANNING_PIECE) as u32;

/// A tick so short that a piece needs more than its quarter.
const QUICK_TICK: u32 = 80_000;

const SHOWN: Shown = Shown { method: Method::Direction, steps: 4, height: 57.0 };

fn planner(tick: u32, settings: &Settings) -> Planner {
    let mut planner = Planner::default();
    planner.set_tick(tick);
    planner.start(settings, Some(SHOWN));
    planner
}

/// To the end of the search; what is found.
fn findings(mut planner: Planner) -> Vec<Finding> {
    let pieces = std::iter::from_fn(|| Some(planner.work(u32::MAX)).filter(|(worked, _)| *worked));
    pieces.filter_map(|(_, finding)| finding).collect()
}

#[test]
fn a_quarter_of_the_tick_is_left_alone() {
    let mut planner = planner(TICK, &Settings::default());
    assert_eq!(planner.work(RESERVE - 1), (false, None));
    assert_eq!(planner.work(RESERVE), (true, None), "the search is made");
    assert_eq!(planner.work(RESERVE - 1), (false, None));
    assert_eq!(planner.work(RESERVE), (true, None), "and goes on");
}

#[test]
fn a_piece_is_begun_only_where_it_fits_in_with_a_margin() {
    let mut planner = planner(QUICK_TICK, &Settings::default());
    assert_eq!(planner.work(QUICK_TICK / 4), (true, None), "no piece to do yet: the search is made");
    assert_eq!(planner.work(PIECE - 1), (false, None));
    assert_eq!(planner.work(PIECE), (true, None));
}

#[test]
fn there_is_nothing_to_do_without_a_motion_or_when_all_is_found() {
    assert_eq!(Planner::default().work(u32::MAX), (false, None));
    let mut still = planner(TICK, &Settings::default());
    still.start(&Settings::default(), None);
    assert_eq!(still.work(u32::MAX), (false, None));

    let mut planner = planner(TICK, &Settings::equal_rods(1.0, 20.0));
    while planner.work(u32::MAX).0 {}
    assert_eq!(planner.answer(1).found, 3);
    assert_eq!(planner.work(u32::MAX), (false, None));
    planner.start(&Settings::equal_rods(1.0, 30.0), Some(SHOWN));
    assert_eq!((planner.work(u32::MAX), planner.answer(1).found), ((true, None), 1), "it begins anew");
}

#[test]
fn a_refused_motion_is_told_once() {
    let settings = Settings::equal_rods(f32::NAN, 20.0);
    let found = findings(planner(TICK, &settings));
    assert!(matches!(found[..], [Finding::Refused(_)]), "{found:?}");
}

/// A processor with 2,000 cycles in a tick can afford neither a step nor a closed form; how long what is shown is right is
/// found all the same.
#[test]
fn where_nothing_holds_that_is_what_is_told() {
    let mut planner = planner(2_000, &Settings::equal_rods(1.0, 120.0));
    let mut found = Vec::new();
    while let (true, finding) = planner.work(u32::MAX) {
        found.extend(finding);
    }
    let [Finding::NothingHolds(limit), Finding::Shown { shown, plan: None }] = found[..] else { panic!("{found:?}") };
    let answer = planner.answer(9);
    assert_eq!((answer.request, answer.found, answer.method, answer.limit), (9, 3, NO_METHOD, limit_code(limit)));
    assert_eq!((answer.cycles, answer.horizon, answer.steps), (0.0, 0.0, 0));
    assert_eq!((answer.shown_method, answer.shown_horizon), (method_code(SHOWN.method), shown.horizon));
}

/// What hosts know: a code never changes its meaning, whatever becomes of the order of methods and limits.
#[test]
fn the_codes_on_the_wire_stay() {
    let methods = [Method::ClosedForm, Method::DirectionPlain, Method::Direction, Method::Angle, Method::Direction8];
    assert_eq!(methods.map(method_code), [0, 1, 2, 3, 4]);
    assert!(Method::ALL.iter().all(|&method| method_code(method) != NO_METHOD), "a method without a code");
    let limits = [Limit::End, Limit::Growth, Limit::Budget, Limit::Planning, Limit::Method];
    assert_eq!(limits.map(limit_code), [0, 1, 2, 3, 4]);
}
