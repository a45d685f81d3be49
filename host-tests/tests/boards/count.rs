//! The counter compared with a second way of counting, and with the price lists.

use std::ops::RangeInclusive;
use std::sync::OnceLock;

use anyhow::Result;

use crate::support::{targets, toolchain};
use double_pendulum::Method;
use double_pendulum::plan::{Costs, Stepping};
use firmware::job::Request;
use host_tests::count::{Minimal, MinimalPrices, prices, step_cost, table, table_in_readme};
use rayon::prelude::*;

/// The instructions in a tick at 12.5 MHz after reset, under `-icount`, where an instruction takes
/// 1 ns.
const INSTRUCTIONS_PER_TICK: f64 = 80.0;

fn request(method: Method, angle: f64, stride: u32) -> Request {
    Request {
        angles: [angle; 2],
        stride,
        samples: 1,
        ..Request::on_any_core(method)
    }
}

#[test]
fn the_log_counts_as_many_instructions_as_the_clock() -> Result<()> {
    let steps = 400;
    for target in targets().iter().filter(|target| target.board.cpu == M4F) {
        let request = |steps| request(Method::Rk4F32, 2.0, steps);
        let logged = step_cost(target, &request(steps))?.instructions;
        let [one, all] = [
            target.run(&request(1))?.1,
            target.run(&request(1 + steps))?.1,
        ];
        let clocked = (all - one) as f64 * INSTRUCTIONS_PER_TICK / f64::from(steps);

        // Each of the two readings of the clock may have an error of a tick.
        let tolerance = 2.0 * INSTRUCTIONS_PER_TICK / f64::from(steps);
        assert!(
            (logged - clocked).abs() <= tolerance,
            "{logged} logged, {clocked} by the clock"
        );
    }
    Ok(())
}

const M4F: &str = "cortex-m4";

/// The counted costs depend on the version of the compiler.
const PRICED: RangeInclusive<f32> = 0.97..=1.03;

#[test]
fn price_lists_equal_the_counted_costs() -> Result<()> {
    let mut wrong = Vec::new();
    for (board, counted) in prices(&toolchain())? {
        println!("{}: {counted:?}", board.name);
        let listed = board.processor().costs;
        let all = |costs: Costs| {
            let steps = Method::DRAWN
                .iter()
                .map(move |&method| costs.of_frame(Stepping { method, steps: 1 }));
            steps.chain([costs.fixed32_unlike, costs.preparation, costs.comparison])
        };
        let is_near = |(listed, counted): (f32, f32)| PRICED.contains(&(listed / counted));
        if !all(listed).zip(all(counted)).all(is_near) {
            wrong.push(format!(
                "{}: {listed:?} listed, {counted:?} counted",
                board.name
            ));
        }
    }

    assert!(
        wrong.is_empty(),
        "accept by cargo count --write-prices: {wrong:#?}"
    );
    Ok(())
}

fn minimal() -> &'static [MinimalPrices] {
    static COUNTED: OnceLock<Vec<MinimalPrices>> = OnceLock::new();
    COUNTED.get_or_init(|| {
        MinimalPrices::count_all(&toolchain()).unwrap_or_else(|error| panic!("{error:#}"))
    })
}

/// The same loop, compiled in two programs. In the one that never measures its truncation, the
/// compiler inlines a step of order 12 differently, and it takes 9 % longer.
const PUBLIC: RangeInclusive<f64> = 0.97..=1.1;

/// The methods are compared by the hidden function, on the Cortex-M4F. Only there the firmware is
/// compiled with flags of its own.
#[test]
fn a_crate_outside_pays_what_the_hidden_function_costs() -> Result<()> {
    let targets = targets();
    let pairs: Vec<_> = targets
        .iter()
        .filter(|target| target.board.cpu == M4F)
        .flat_map(|target| {
            let outside = minimal()
                .iter()
                .find(|outside| outside.board == target.board)
                .expect("one of each core");
            let prices = outside.prices.iter();
            prices
                .filter(|price| !price.program.counts_turns)
                .map(move |price| (target, price))
        })
        .collect();

    let hidden: Vec<_> = pairs
        .par_iter()
        .map(|(target, price)| {
            let request = request(price.program.method, 0.5, price.steps);
            Ok(step_cost(target, &request)?.cycles)
        })
        .collect::<Result<_>>()?;

    let mut wrong = Vec::new();
    for ((target, Minimal { program, step, .. }), hidden) in pairs.into_iter().zip(hidden) {
        let board = target.board.name;
        println!("{program} on {board}: {step:.1}, hidden {hidden:.1}");
        if !PUBLIC.contains(&(step / hidden)) {
            wrong.push(format!(
                "{program} on {board}: {step:.1} instead of {hidden:.1}"
            ));
        }
    }
    assert!(wrong.is_empty(), "cycles a step: {wrong:#?}");
    Ok(())
}

type Row<'a> = (&'a str, Vec<f32>);

fn rows(table: &str) -> Vec<Row<'_>> {
    let rows = table.lines().skip(2).filter_map(|row| {
        let (name, cells) = row.strip_prefix("| ")?.split_once(" |")?;
        let words = cells.split([' ', '|']).map(|word| word.replace(',', ""));
        Some((name, words.filter_map(|word| word.parse().ok()).collect()))
    });
    rows.collect()
}

fn is_near((name, row): &Row, (counted_name, counted): &Row) -> bool {
    name == counted_name
        && row.len() == counted.len()
        && row
            .iter()
            .zip(counted)
            .all(|(shown, counted)| PRICED.contains(&(shown / counted)))
}

#[test]
fn the_kernels_readme_shows_what_a_crate_outside_pays() -> Result<()> {
    let [shown, counted] = [table_in_readme()?, table(minimal())];
    let [all_shown, all_counted] = [&shown, &counted].map(|table| rows(table));
    let is_right = all_shown.len() == all_counted.len()
        && all_shown
            .iter()
            .zip(&all_counted)
            .all(|(shown, counted)| is_near(shown, counted));
    assert!(
        is_right && !all_shown.is_empty(),
        "shown:\n{shown}counted:\n{counted}accept by cargo count --minimal --readme"
    );
    Ok(())
}
