//! Other integrators on the host: executed instructions per step, where valgrind is installed.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context, bail};

use super::table::Table;
use crate::process;
use crate::toolchain::workspace;

/// For a build of the libraries from nothing.
const LIMIT: Duration = Duration::from_secs(900);
/// Steps of the shorter run; the longer has twice as many.
const STEPS: u32 = 2_000;
/// As `benches/peers` calls them, this kernel first.
const PEERS: [&str; 5] = [
    "double-pendulum",
    "ode_solvers, the book's equations",
    "ode_solvers, this kernel's equations",
    "differential-equations, the book's equations",
    "differential-equations, this kernel's",
];
/// How many runs [`table`] makes.
pub const RUNS: usize = 2 * PEERS.len();

/// Instructions per step of classical RK4 in f64 on this host; `wanted` says whether to count at all.
pub fn table(wanted: bool, tick: &dyn Fn()) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    let installed = process::run(Command::new("valgrind").arg("--version"), LIMIT).is_ok();
    if wanted && installed {
        for name in PEERS {
            let count = |steps| {
                let count = instructions(name, steps);
                tick();
                count
            };
            let per_step = (count(2 * STEPS)?.saturating_sub(count(STEPS)?)) as f64 / f64::from(STEPS);
            rows.push((name, per_step));
        }
    }
    let first = rows.first().map_or(f64::NAN, |(_, first)| *first);
    let row = |(name, count): &(&str, f64)| {
        vec![name.replace(',', ":"), format!("{count:.0}"), format!("{:.2}", count / first)]
    };
    let note = if !wanted {
        "Not counted in a quick report. For times, as ratios: `cargo bench --bench peers`."
    } else if installed {
        "Executed x86-64 instructions per step of classical RK4 in f64, regular scene, counted by valgrind: a longer run \
         less a shorter one. The standard library's sine comes from this system. For times, as ratios: \
         `cargo bench --bench peers`."
    } else {
        "Not counted: valgrind is not installed. For times, as ratios: `cargo bench --bench peers`."
    };
    Ok(Table {
        name: "host-peers",
        title: String::from("Other integrators on the host"),
        note: String::from(note),
        columns: vec!["integrator", "instructions", "relative"],
        rows: rows.iter().map(row).collect(),
    })
}

/// Instructions of a whole run.
fn instructions(name: &str, steps: u32) -> anyhow::Result<u64> {
    let mut command = Command::new("cargo");
    let runner = r#"target.'cfg(all())'.runner=["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]"#;
    command.args(["--config", runner, "bench", "--quiet", "--package", "host-tests", "--bench", "peers"]);
    command.args(["--", "--count", name, &steps.to_string()]).current_dir(workspace());
    let output = process::run(&mut command, LIMIT)?;
    if !output.status.success() {
        bail!("{name}: {}", output.stderr.trim());
    }
    let line = output.stderr.lines().find_map(|line| line.split_once("Collected : "));
    let (_, count) = line.with_context(|| format!("{name}: valgrind gave no count"))?;
    count.trim().parse().with_context(|| format!("{name}: not a count: {count}"))
}
