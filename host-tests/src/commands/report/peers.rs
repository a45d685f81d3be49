//! Other integrators on the host: executed instructions, where valgrind is installed.

use std::process::Command;
use std::time::Duration;

use anyhow::{Context, bail};

use crate::commands::table::{Table, small};
use crate::emulator::process;
use crate::emulator::toolchain::workspace;

/// For a build of the libraries from nothing.
const LIMIT: Duration = Duration::from_secs(900);
/// Contestants of classical RK4, as `benches/peers` calls them, this kernel first.
const CLASSICAL: [&str; 7] = [
    "double-pendulum",
    "double-pendulum, angle form",
    "double-pendulum, direction form",
    "ode_solvers, the book's equations",
    "ode_solvers, this kernel's equations",
    "differential-equations, the book's equations",
    "differential-equations, this kernel's",
];
/// Their steps: 256 a second through the regular scene, in eight parts.
const STEPS: u32 = 320;
/// Tight errors, rad, on each of the scenes.
const TIGHT: [(&str, f64); 4] = [("regular", 1e-9), ("regular", 1e-12), ("chaotic", 1e-9), ("chaotic", 1e-12)];
/// The contestants for those.
const TIGHT_CONTESTANTS: usize = 7;
/// How many contestants the tables count.
pub const RUNS: usize = CLASSICAL.len() + TIGHT.len() * TIGHT_CONTESTANTS;

const TIMES: &str = "For times, as ratios: `cargo bench --bench peers`.";

/// Instructions per step of classical RK4, and instructions that tight errors ask of RK4 and order 8, all in f64 on this
/// host; `wanted` says whether to count at all.
pub fn tables(wanted: bool, tick: &dyn Fn()) -> anyhow::Result<[Table; 2]> {
    let installed = process::run(Command::new("valgrind").arg("--version"), LIMIT).is_ok();
    let (mut classical, mut tight) = (Vec::new(), Vec::new());
    if wanted && installed {
        let mut first = None;
        for name in CLASSICAL {
            let per_step = instructions(name, "regular", STEPS)? as f64 / f64::from(8 * STEPS);
            let relative = per_step / *first.get_or_insert(per_step);
            classical.push(vec![name.replace(',', ":"), format!("{per_step:.0}"), format!("{relative:.2}")]);
            tick();
        }
        for (scene, error) in TIGHT {
            let mut first = None;
            for (name, effort, found) in efforts(scene, error)? {
                let count = instructions(&name, scene, effort)?;
                let relative = count as f64 / *first.get_or_insert(count as f64);
                let [asked, found] = [error, found].map(small);
                tight.push(vec![
                    name.replace(',', ":"),
                    scene.to_owned(),
                    asked,
                    found,
                    count.to_string(),
                    format!("{relative:.2}"),
                ]);
                tick();
            }
        }
    }
    let note = |what: &str| {
        if !wanted {
            format!("Not counted in a quick report. {TIMES}")
        } else if installed {
            format!(
                "{what}, counted by valgrind in f64: two runs less one. The standard library's sine comes from this system. {TIMES}"
            )
        } else {
            format!("Not counted: valgrind is not installed. {TIMES}")
        }
    };
    Ok([
        Table {
            name: "host-peers",
            title: String::from("Other integrators on the host"),
            note: note("Executed x86-64 instructions per step of classical RK4, regular scene"),
            columns: vec!["integrator", "instructions", "relative"],
            rows: classical,
        },
        Table {
            name: "host-order-8",
            title: String::from("Tight errors on the host: order 8 beside RK4 and other integrators"),
            note: note("Executed x86-64 instructions through a whole scene, in the fewest steps that keep the error"),
            columns: vec!["integrator", "scene", "error asked (rad)", "error (rad)", "instructions", "relative"],
            rows: tight,
        },
    ])
}

/// The effort and error (rad) of each contestant that can keep `error`.
fn efforts(scene: &str, error: f64) -> anyhow::Result<Vec<(String, u32, f64)>> {
    let output = bench(None, &["--efforts", scene, &error.to_string()])?;
    let entry = |line: &str| {
        let mut words = line.split('\t');
        let name = words.next()?.to_owned();
        Some((name, words.next()?.parse().ok()?, words.next()?.parse().ok()?))
    };
    let entries = output.stdout.lines().map(|line| entry(line).with_context(|| format!("not an effort: {line}")));
    entries.collect()
}

/// Instructions of one run through a scene.
fn instructions(name: &str, scene: &str, effort: u32) -> anyhow::Result<u64> {
    let count = |times: &str| {
        let output = bench(Some(VALGRIND), &["--count", name, scene, &effort.to_string(), times])?;
        let line = output.stderr.lines().find_map(|line| line.split_once("Collected : "));
        let (_, count) = line.with_context(|| format!("{name}: valgrind gave no count"))?;
        count.trim().parse::<u64>().with_context(|| format!("{name}: not a count: {count}"))
    };
    Ok(count("2")?.saturating_sub(count("1")?))
}

const VALGRIND: &str =
    r#"target.'cfg(all())'.runner=["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]"#;

/// Runs `benches/peers` under the given runner.
fn bench(runner: Option<&str>, arguments: &[&str]) -> anyhow::Result<process::Output> {
    let mut command = Command::new("cargo");
    if let Some(runner) = runner {
        command.args(["--config", runner]);
    }
    command.args(["bench", "--quiet", "--profile", "tools", "--package", "host-tests", "--bench", "peers", "--"]);
    let output = process::run(command.args(arguments).current_dir(workspace()), LIMIT)?;
    if !output.status.success() {
        bail!("{}: {}", arguments.join(" "), output.stderr.trim());
    }
    Ok(output)
}
