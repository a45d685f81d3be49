//! The table of known answers: the reference to its last digits, the kernel within each row's budget.

use double_pendulum::{Pendulum, Real, State};
use host_tests::oracle::known_answers::{KnownAnswer, table};
use host_tests::oracle::tolerances;
use reference::taylor::Reference;
use reference::twofloat::TwoFloat;

const STEPS_PER_SECOND: u32 = 4096;

/// How far the directions are from all that they may be.
fn distance(row: &KnownAnswer, directions: [TwoFloat; 4]) -> f64 {
    let off = |i: usize| f64::from(directions[i] - row.directions[i]).abs() - row.radius[i];
    (0..4).map(off).map(|off| if off.is_nan() { f64::INFINITY } else { off }).fold(0.0, f64::max)
}

/// Runs through the table's rows: `start` makes a scene, `advance` moves it to a row's time and tells its directions.
fn each_row<S>(
    start: impl Fn(&KnownAnswer) -> S,
    advance: impl Fn(&mut S, &KnownAnswer) -> [TwoFloat; 4],
    mut check: impl FnMut(&KnownAnswer, &S, f64),
) {
    let table = table().expect("the table can be read");
    for scene in table.chunk_by(|one, next| one.scene == next.scene) {
        let mut system = start(&scene[0]);
        for row in scene {
            let directions = advance(&mut system, row);
            check(row, &system, distance(row, directions));
        }
    }
}

#[test]
fn reference_reaches_the_tables_digits() {
    let directions = |reference: &mut Reference, row: &KnownAnswer| {
        reference.advance_to(row.time);
        reference.directions()
    };
    each_row(KnownAnswer::reference, directions, |row, _, distance| {
        let budget = tolerances::REFERENCE * row.growth;
        assert!(distance <= budget, "{} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
    });
}

/// A scene in the kernel and the steps done.
struct Run<R> {
    pendulum: Pendulum<R>,
    state: State<R>,
    steps: u32,
    exact: Reference,
}

fn kernel_keeps_its_budgets<R: Real>() {
    let start = |row: &KnownAnswer| {
        let pendulum = Pendulum::new(&row.parameters().cast()).expect("the table's parameters are valid");
        Run { pendulum, state: pendulum.to_state(&row.start().cast()), steps: 0, exact: row.reference() }
    };
    let directions = |run: &mut Run<R>, row: &KnownAnswer| {
        while f64::from(run.steps) < row.time * f64::from(STEPS_PER_SECOND) {
            run.state = run.pendulum.step(&run.state, R::from_f64(1.0 / f64::from(STEPS_PER_SECOND)));
            run.steps += 1;
        }
        run.exact.advance_to(row.time);
        let State { a1, a2, .. } = run.state.cast::<f64>();
        [a1.sin(), a1.cos(), a2.sin(), a2.cos()].map(TwoFloat::from)
    };
    let mut tested = 0_u32;
    each_row(start, directions, |row, run, distance| {
        let budget = tolerances::known_answer::<R>(row, f64::from(STEPS_PER_SECOND), &run.exact.state());
        assert!(distance <= budget, "{} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
        tested += u32::from(budget < 1.0);
    });
    let claimed = tolerances::KNOWN_ANSWERS_CLAIMED.of::<R>();
    assert!(f64::from(tested) >= claimed, "only {tested} rows of the table have a budget below 1");
}

#[test]
fn the_kernel_keeps_its_budgets_in_either_precision() {
    kernel_keeps_its_budgets::<f32>();
    kernel_keeps_its_budgets::<f64>();
}
