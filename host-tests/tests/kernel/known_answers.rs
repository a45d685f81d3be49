//! The table of known answers: the reference to its last digits, every method within each row's budget.

use double_pendulum::{Error, Method, Parameter, State};
use firmware::job::AnyRun;
use host_tests::oracle::known_answers::{KnownAnswer, table};
use host_tests::oracle::tolerances;
use host_tests::oracle::trials::{self, exact_methods};
use rayon::prelude::*;
use reference::taylor::Reference;
use reference::twofloat::TwoFloat;

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

/// The reference at each row, and how far it is off there.
fn each_reference(check: impl FnMut(&KnownAnswer, &Reference, f64)) {
    let directions = |reference: &mut Reference, row: &KnownAnswer| {
        reference.advance_to(row.time);
        reference.directions()
    };
    each_row(KnownAnswer::reference, directions, check);
}

#[test]
fn reference_reaches_the_tables_digits() {
    each_reference(|row, _, distance| {
        let budget = tolerances::REFERENCE * row.growth;
        assert!(distance <= budget, "{} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
    });
}

/// A scene by a method of the kernel, if it takes it, and the steps done.
struct Run {
    run: Option<AnyRun>,
    steps: u32,
}

/// Of each row the exact state, too.
fn keeps_its_budgets(method: Method, exact: &[State<f64>]) {
    let steps_per_second = if method.order() == 4 { 4096 } else { 1024 };
    let start = |row: &KnownAnswer| {
        let (parameters, start) = (row.parameters(), row.reference().state());
        let run = match trials::run(method, &parameters, &start, 1.0 / f64::from(steps_per_second)) {
            Err(Error::TooLarge { parameter: Parameter::Dt, .. }) if method.is_fixed_point() => None,
            run => Some(run.unwrap_or_else(|error| panic!("{method}, {}: {error}", row.scene))),
        };
        Run { run, steps: 0 }
    };
    let directions = |Run { run, steps }: &mut Run, row: &KnownAnswer| {
        let left = (row.time * f64::from(steps_per_second)) as u32 - *steps;
        *steps += left;
        let Some(run) = run else { return row.directions };
        let State { a1, a2, .. } = run.advance(left).map_or([f64::NAN; 4].into(), |()| run.state());
        [a1.sin(), a1.cos(), a2.sin(), a2.cos()].map(TwoFloat::from)
    };
    let (mut tested, mut exact) = (0_u32, exact.iter());
    each_row(start, directions, |row, Run { run, .. }, distance| {
        let budget = tolerances::known_answer(row, method, exact.next().expect("one of each row"));
        assert!(distance <= budget, "{method}, {} at {} s: {distance:e}, budget {budget:e}", row.scene, row.time);
        tested += u32::from(run.is_some() && budget < 1.0);
    });
    println!("{method}: {tested}");
    let claimed = tolerances::KNOWN_ANSWERS_CLAIMED.by(method);
    assert!(f64::from(tested) >= claimed, "{method}: only {tested} rows of the table have a budget below 1");
}

#[test]
fn every_method_keeps_its_budgets() {
    let mut exact = Vec::new();
    each_reference(|_, reference, _| exact.push(reference.state()));
    exact_methods().collect::<Vec<_>>().into_par_iter().for_each(|method| keeps_its_budgets(method, &exact));
}
