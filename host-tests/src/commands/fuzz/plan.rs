//! The planner on any bit patterns: a plan that keeps its promises of form, or a refusal by name.

use double_pendulum::plan::{Budget, Limit, Method, PlanError, Problem, Search};
use double_pendulum::{Motion, Parameters};
use firmware::config::CORTEX_M4F;
use firmware::protocol::limit_code;

use super::Outcome;
use super::input::Input;
use super::motion::refusal;

/// Pieces of a search at most, so that an execution stays short.
const MOST_PIECES: u32 = 60;

/// A scene, a budget and what is asked for.
pub fn plan(input: &[u8]) -> Outcome {
    let mut input = Input(input);
    let ([m1, m2, l1, l2, g], [a1, a2, w1, w2]) = (input.numbers(), input.numbers());
    let ([tolerance, duration], rate) = (input.numbers(), u16::from_le_bytes([input.byte(), input.byte()]));
    let [frame, planning] = input.numbers().map(|number: f64| number as f32);
    let (asked, steps, piece) = (input.byte(), input.byte().into(), input.number() as f32);
    let (pendulum, start) = (Parameters { m1, m2, l1, l2, g }, Motion { a1, a2, w1, w2 });
    let scene = Problem { pendulum, start, tolerance, duration, rate };
    let (costs, budget) = (CORTEX_M4F.costs, Budget { frame, planning });
    let method = Method::ALL.get(usize::from(asked & 7)).copied();
    let search = match method {
        Some(method) => Search::of(method, steps, &scene, &costs, &budget),
        None => Search::new(&scene, &costs, &budget),
    };
    let asked = u32::from(asked & 7) * 0x10000;
    let mut search = match search {
        Ok(search) => search,
        Err(error) => return asked + refused(&error),
    };
    for _ in 0..MOST_PIECES {
        let plan = match search.advance(piece) {
            Ok(Some(plan)) => plan,
            Ok(None) => continue,
            Err(error) => return asked + 0x8000 + refused(&error),
        };
        assert!((0.0..=duration.max(scene.time(1))).contains(&plan.horizon), "{plan:?} for {scene:?}");
        assert!(plan.spent <= planning && plan.cost > 0.0 && plan.error <= 1.0, "{plan:?} for {scene:?}");
        assert!(method.is_some() || plan.cost <= frame && plan.horizon > 0.0, "{plan:?} for {scene:?}");
        assert!(plan.dt.is_finite() && plan.dt >= 0.0, "{plan:?} for {scene:?}");
        assert!((plan.limit == Limit::End) <= (plan.horizon >= duration), "{plan:?} for {scene:?}");
        assert!(method.is_none_or(|method| method == plan.method), "{plan:?} for {method:?} {scene:?}");
        return asked + 0x10 + u32::from(limit_code(plan.limit)) + 8 * u32::from(plan.horizon > 0.0);
    }
    asked + 1
}

/// As [`refusal`], of a search.
fn refused(error: &PlanError) -> Outcome {
    assert!(!error.to_string().is_empty());
    match *error {
        PlanError::Motion(error) => refusal(&error),
        PlanError::NotPositive { quantity, .. } => 0x1000 + quantity as u32,
        PlanError::TooLarge { quantity, .. } => 0x1100 + quantity as u32,
        PlanError::NothingHolds { limit, .. } => 0x1200 + u32::from(limit_code(limit)),
        _ => 0x1300,
    }
}

/// Good ones, for every method and for the cheapest.
pub fn seeds() -> Vec<Vec<u8>> {
    let bytes = |numbers: &[f64]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let head = bytes(&[1.0, 1.0, 1.0, 1.0, 9.81, 2.0, -1.0, 0.5, -0.25, 64.0, 0.1]);
    let scene = |asked: u8, steps: u8, budget: [f64; 2], cycles: f64| {
        [head.clone(), vec![60, 0], bytes(&budget), vec![asked, steps], bytes(&[cycles])].concat()
    };
    let of = (0..6).map(|asked| scene(asked, 2, [1e6, 1e9], f64::INFINITY));
    let frugal =
        [scene(7, 0, [1e6, 1e4], f64::INFINITY), scene(7, 0, [1e2, 1e9], f64::INFINITY), scene(2, 4, [1e6, 1e9], 1.0)];
    of.chain(frugal).collect()
}
