//! `cargo bench --bench flips`: steps of the map of flips, in vectors and one by one, compared with
//! plain C, in one run and in turns.
//!
//! The C program, the page's equations in `f32` with the system's `sinf`, is compiled here by `cc
//! -O3`. Every way takes the same starts, step and limit; the fastest of its runs counts.

use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use boards::toolchain::workspace;
use double_pendulum::flips::Flip;
use double_pendulum::{Error, Parameters};
use exact::vectors::Search;
use host_tests::flips::map::Map;
use rayon::prelude::*;

const SIDE: usize = 128;
const LIMIT: f32 = 100.0;
const ROUNDS: usize = 30;
const PORTION: usize = 1024;

type Found = Result<Vec<Flip<f32>>, Error>;
/// The name, the function, and the goal on one thread, as a multiple of the speed of C: 280 million
/// steps a second in vectors of 8 numbers and 130 million in vectors of 4, where plain C made 11
/// million.
type Way = (&'static str, fn(&Search, &[[f32; 2]]) -> Found, Option<f64>);

const WAYS: [Way; 4] = [
    ("this kernel: one start after the other", one_by_one, None),
    (
        "24 side by side, any x86-64",
        exact::vectors::baseline,
        Some(130.0 / 11.0),
    ),
    (
        "24 side by side, vectors as this processor has them",
        exact::vectors::flips,
        Some(280.0 / 11.0),
    ),
    ("the same on all threads", threads, None),
];

fn one_by_one(search: &Search, starts: &[[f32; 2]]) -> Found {
    starts.iter().map(|&[a1, a2]| search.of(a1, a2)).collect()
}

fn threads(search: &Search, starts: &[[f32; 2]]) -> Found {
    let portions = starts
        .par_chunks(PORTION)
        .map(|portion| exact::vectors::flips(search, portion));
    Ok(portions.collect::<Result<Vec<_>, _>>()?.concat())
}

fn main() -> Result<()> {
    let map = Map::new(Parameters::equal_rods(1.0, 1.0, 1.0), LIMIT, [SIDE, SIDE])?;
    let starts = map.starts();
    let [search, _] = map.searches;

    let most = (f64::from(map.limit) / map.dt).ceil();
    let steps = |flip: &Flip<f32>| match *flip {
        Flip::Never => 0.0,
        Flip::After(time) => (f64::from(time) / map.dt).ceil(),
        Flip::Later => most,
    };

    let program = workspace().join("target/peers-c-flips");
    let mut cc = Command::new("cc");
    cc.current_dir(workspace().join("host-tests/peers/c"));
    cc.args([
        "-O3",
        "-DSIN=sinf",
        "-DCOS=cosf",
        "flips.c",
        "textbook.c",
        "-lm",
        "-o",
    ])
    .arg(&program);
    ensure!(
        cc.status().context("no C compiler")?.success(),
        "cc refuses flips.c"
    );

    let mut c = 0.0_f64;
    let mut rates = [0.0_f64; WAYS.len()];
    // C and all ways run in turns, because the speed of a machine drifts. The fastest run of each
    // is used.
    for _ in 0..ROUNDS {
        let output = Command::new(&program)
            .args([SIDE.to_string(), map.dt.to_string(), most.to_string()])
            .output()?;
        let text = String::from_utf8(output.stdout)?;
        let numbers: Vec<f64> = text
            .split_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        let [steps_of_c, nanoseconds] = numbers[..] else {
            anyhow::bail!("flips.c says {text:?}")
        };
        c = c.max(1e3 * steps_of_c / nanoseconds);
        let mut all = Vec::new();
        for ((_, find, _), best) in WAYS.iter().zip(&mut rates) {
            let start = Instant::now();
            let found = find(&search, &starts)?;
            let seconds = start.elapsed().as_secs_f64();
            *best = best.max(found.iter().map(steps).sum::<f64>() / seconds / 1e6);
            all.push(found);
        }
        ensure!(
            all.iter().all(|found| *found == all[0]),
            "not the same flips"
        );
    }

    let threads = rayon::current_num_threads();
    println!("map of {SIDE} x {SIDE} starts, limit {LIMIT} sqrt(l/g), {threads} threads");
    println!(
        "{:51} {:>9} {:>8} {:>10}",
        "", "M steps/s", "times C", "times one"
    );
    let row = |name: &str, rate: f64| {
        format!(
            "{name:51} {rate:9.1} {:8.1} {:10.2}",
            rate / c,
            rate / rates[0]
        )
    };
    println!("{}", row("plain C at -O3, the page's equations, sinf", c));
    for ((name, _, goal), rate) in WAYS.iter().zip(rates) {
        let verdict = |goal| {
            format!(
                "  {goal:.0} required: {}",
                if rate >= goal * c { "met" } else { "MISSED" }
            )
        };
        println!(
            "{}{}",
            row(name, rate),
            goal.map_or_else(String::new, verdict)
        );
    }
    Ok(())
}
