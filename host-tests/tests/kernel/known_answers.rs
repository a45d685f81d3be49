//! The table of known answers: the reference agrees with all its digits, and every method with each
//! row to within its tolerance.

use std::sync::LazyLock;

use double_pendulum::{Error, Method, Parameter, State};
use exact::known_answers::{KnownAnswer, table};
use exact::taylor::Reference;
use exact::tolerances;
use exact::trials::{self, exact_methods};
use exact::twofloat::TwoFloat;
use rayon::prelude::*;

/// The smallest number of rows of the table for which a method must have a tolerance below 1
/// ([`known_answer`]), so that the test is meaningful. The other rows are chaotic.
const KNOWN_ANSWERS_CLAIMED: tolerances::PerPrecision = tolerances::PerPrecision {
    single: 36.0,
    double: 45.0,
};

/// Returns the largest distance of a sine or cosine from the interval of the row's value.
fn distance(row: &KnownAnswer, directions: [TwoFloat; 4]) -> f64 {
    let off = |i: usize| f64::from(directions[i] - row.directions[i]).abs() - row.radius[i];
    (0..4)
        .map(off)
        .map(|off| if off.is_nan() { f64::INFINITY } else { off })
        .fold(0.0, f64::max)
}

/// The rows of the table, each with the reference at its time.
static ROWS: LazyLock<Vec<(KnownAnswer, Reference)>> = LazyLock::new(|| {
    let at_its_time = |row: KnownAnswer| {
        let mut reference = row.start.clone();
        reference.advance_to(row.time);
        (row, reference)
    };
    table()
        .expect("the table can be read")
        .into_par_iter()
        .map(at_its_time)
        .collect()
});

#[test]
fn reference_reaches_the_tables_digits() {
    for (row, reference) in &*ROWS {
        let distance = distance(row, reference.directions());
        let budget = tolerances::REFERENCE * row.growth;
        assert!(
            distance <= budget,
            "{} at {} s: {distance:e}, budget {budget:e}",
            row.scene,
            row.time
        );
    }
}

/// A budget above 1 asserts nothing. Scenes whose steps are too long for fixed point are left out.
fn keeps_its_budgets(rows: &[(KnownAnswer, Reference)], method: Method) {
    let steps_per_second = if method.order() == 4 { 4096 } else { 1024 };
    let mut tested = 0_u32;
    for scene in rows.chunk_by(|(one, _), (next, _)| one.scene == next.scene) {
        let (first, _) = &scene[0];
        let dt = 1.0 / f64::from(steps_per_second);
        let mut run = match trials::run(method, &first.parameters, &first.start.state(), dt) {
            Err(Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            }) if method.is_fixed_point() => continue,
            run => run.unwrap_or_else(|error| panic!("{method}, {}: {error}", first.scene)),
        };

        let mut made = 0;
        for (row, exact) in scene {
            let left = (row.time * f64::from(steps_per_second)) as u32 - made;
            made += left;
            let State { a1, a2, .. } = run
                .advance(left)
                // A motion that has diverged is infinitely wrong.
                .map_or([f64::NAN; 4].into(), |()| run.state());
            let distance = distance(
                row,
                [a1.sin(), a1.cos(), a2.sin(), a2.cos()].map(TwoFloat::from),
            );
            let budget = tolerances::known_answer(row, method, &exact.state());
            assert!(
                distance <= budget,
                "{method}, {} at {} s: {distance:e}, budget {budget:e}",
                row.scene,
                row.time
            );
            tested += u32::from(budget < 1.0);
        }
    }

    println!("{method}: {tested}");
    let claimed = KNOWN_ANSWERS_CLAIMED.by(method);
    assert!(
        f64::from(tested) >= claimed,
        "{method}: only {tested} rows of the table have a budget below 1"
    );
}

#[test]
fn every_method_keeps_its_tolerance_in_the_table() {
    // The rows are computed here first. A job that waited for them would block a thread of the jobs
    // that compute them.
    let rows = &*ROWS;
    exact_methods()
        .collect::<Vec<_>>()
        .into_par_iter()
        .for_each(|method| keeps_its_budgets(rows, method));
}
