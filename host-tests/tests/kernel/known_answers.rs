//! The table of known answers: the reference to its last digits, the kernel within each row's budget.

use double_pendulum::{Pendulum, Real, State};
use host_tests::oracle::known_answers::{KnownAnswer, table};
use host_tests::oracle::reference::Reference;
use host_tests::oracle::tolerances;

const STEPS_PER_SECOND: u32 = 4096;

/// The largest difference of the four numbers from all that they may be, momenta relative to the greatest the energy allows.
fn distance(row: &KnownAnswer, differences: [f64; 4]) -> f64 {
    let pendulum = Pendulum::new(&row.parameters()).expect("the table's parameters are valid");
    let bounds = pendulum.bounds(&pendulum.to_state(&row.start()));
    let scale = [1.0, 1.0, bounds.p1, bounds.p2];
    (0..4).fold(0.0, |largest, i| ((differences[i].abs() - row.radius[i]) / scale[i]).max(largest))
}

/// Runs through the table's rows: `start` makes a scene, `advance` moves it to a row's time and tells its distance.
fn each_row<S>(
    start: impl Fn(&KnownAnswer) -> S,
    advance: impl Fn(&mut S, &KnownAnswer) -> [f64; 4],
    mut check: impl FnMut(&KnownAnswer, f64),
) {
    let table = table().expect("the table can be read");
    for scene in table.chunk_by(|one, next| one.scene == next.scene) {
        let mut system = start(&scene[0]);
        for row in scene {
            let differences = advance(&mut system, row);
            check(row, distance(row, differences));
        }
    }
}

#[test]
fn reference_reaches_the_tables_digits() {
    let differences = |reference: &mut Reference, row: &KnownAnswer| {
        reference.advance_to(row.time);
        let state = reference.exact_state();
        std::array::from_fn(|i| f64::from(state[i] - row.state[i]))
    };
    each_row(KnownAnswer::reference, differences, |row, distance| {
        let budget = tolerances::REFERENCE * row.growth;
        assert!(distance <= budget, "{} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
    });
}

/// A scene in the kernel and the steps done.
struct Run<R> {
    pendulum: Pendulum<R>,
    state: State<R>,
    steps: u32,
}

fn kernel_keeps_its_budgets<R: Real>() {
    let start = |row: &KnownAnswer| {
        let pendulum = Pendulum::new(&row.parameters().cast()).expect("the table's parameters are valid");
        Run { pendulum, state: pendulum.to_state(&row.start().cast()), steps: 0 }
    };
    let differences = |run: &mut Run<R>, row: &KnownAnswer| {
        while f64::from(run.steps) < row.time * f64::from(STEPS_PER_SECOND) {
            run.state = run.pendulum.step(&run.state, R::from_f64(1.0 / f64::from(STEPS_PER_SECOND)));
            run.steps += 1;
        }
        let [state, exact]: [[f64; 4]; 2] = [run.state.cast().into(), row.answer().into()];
        std::array::from_fn(|i| state[i] - exact[i])
    };
    let mut tested = 0_u32;
    each_row(start, differences, |row, distance| {
        let budget = tolerances::known_answer::<R>(row, f64::from(STEPS_PER_SECOND));
        assert!(distance <= budget, "{} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
        tested += u32::from(budget < 1.0);
    });
    let claimed = tolerances::KNOWN_ANSWERS_CLAIMED.of::<R>();
    assert!(f64::from(tested) >= claimed, "only {tested} rows of the table have a budget below 1");
}

#[test]
fn kernel_keeps_its_budgets_f32() {
    kernel_keeps_its_budgets::<f32>();
}

#[test]
fn kernel_keeps_its_budgets_f64() {
    kernel_keeps_its_budgets::<f64>();
}
