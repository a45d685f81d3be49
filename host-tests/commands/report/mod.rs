//! `cargo write-report`: the cost of every method on the target against its error, as CSV and
//! charts.
//!
//! The README of host-tests shows an extract: the recommended method for each core, the cost of a step and its
//! error, and a chart for each core.
//!
//! Costs are counted on the emulated targets. Errors are computed on the host, which is valid
//! because the bits are the same (test `identity`). No times are measured, so two runs write the
//! same files.

pub mod accuracy;
mod c_peers;
mod chart;
pub mod join;

use std::fs;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use double_pendulum::Method;
use firmware::config::HALF_PIXEL;

use crate::count::Target;
use crate::table::{Table, between, small};
use accuracy::{LONG, ReportedMotion, SCENES};
use boards::console::cli::{say, unwritable};
use boards::out_file::write;
use boards::toolchain::{self, workspace};
use boards::{BOARDS, Board};
use c_peers::PROGRAMS;
use join::Point;

/// Measures the cost of every method on three kinds of core, and its error, and writes both as CSV
/// and charts. Takes a few minutes.
#[derive(Debug, Parser)]
#[command(
    name = "cargo write-report",
    after_help = "Example: cargo write-report --out /tmp/report"
)]
pub struct ReportOptions {
    /// Also put the recommendations, the main table and the charts into the README of host-tests
    #[arg(long)]
    readme: bool,
    /// The folder to write to [default: host-tests/report]
    #[arg(long, alias = "folder", value_name = "FOLDER")]
    out: Option<PathBuf>,
}

/// Measures, writes the table and the charts into the folder of the options, and prints the advice.
/// The README is not changed if a program in C could not be built.
pub fn run(options: &ReportOptions) -> Result<()> {
    let toolchain = toolchain::set_up()?;
    let folder = options
        .out
        .clone()
        .unwrap_or_else(|| workspace().join("host-tests/report"));
    fs::create_dir_all(&folder).map_err(|error| unwritable("--out", &folder, &error))?;

    let targets = Target::build_all(&toolchain)?;
    let (points, absent) = join::join(&toolchain, &targets)?;
    write(
        "--out",
        &folder.join("speed-against-error.csv"),
        join::table(&points).csv(),
    )?;

    let is_shown = options.readme && absent.is_empty();

    for (scene, target) in SCENES
        .iter()
        .flat_map(|scene| targets.iter().map(move |target| (scene, target)))
    {
        let svg = chart::speed_against_error(&points, scene, target.board)?;
        let name = format!("{}-{}.svg", scene.name, target.board.cpu);
        write("--out", &folder.join(&name), &svg)?;
        if is_shown && scene == &SCENES[0] {
            write("--readme", &workspace().join(CHARTS).join(&name), &svg)?;
        }
    }

    // The advice is always printed. It is written into the README only on request.
    let advice = advice(&points);
    absent.iter().chain(&advice).try_for_each(say)?;
    let (path, [page, made]) = page(&advice, &points)?;

    if options.readme {
        ensure!(
            absent.is_empty(),
            "the README was not changed, because some figures are missing, see above"
        );
        write("--readme", &path, &made)?;
    } else if page != made {
        say("the README shows other figures; cargo write-report --readme updates it")?;
    }

    Ok(say(format_args!("wrote {}", folder.display()))?)
}

const CHARTS: &str = "host-tests/pictures/report";
const MARKS: [&str; 2] = [
    "<!-- made by cargo write-report --readme -->\n",
    "<!-- end of the generated part -->\n",
];
const README: &str = "host-tests/README.md";
/// The existing alternatives, the page's own equations, and the recommended methods.
const ROWS: [&str; 8] = [
    PROGRAMS[1].0,
    Method::TextbookF32.name(),
    Method::Rk4F32Direction.name(),
    Method::Rk4Fixed32.name(),
    Method::Extrapolation12Fixed64.name(),
    PROGRAMS[0].0,
    Method::Rk4F32DirectionPlain.name(),
    Method::Extrapolation16Fixed64.name(),
];

type Purpose = (&'static str, fn(&Point) -> bool);
const PURPOSES: [Purpose; 3] = [
    ("draws at 60 fps", |point| {
        point.rate >= 60 && point.error.pixels <= f64::from(HALF_PIXEL)
    }),
    ("keeps 1e-9 rad", |point| point.error.angle <= 1e-9),
    ("keeps 1e-12 rad", |point| point.error.angle <= 1e-12),
];

/// Returns the README's path, its current text, and the text that contains the new block: the
/// advice as a list, and the table.
fn page(advice: &[String], points: &[Point]) -> Result<(PathBuf, [String; 2])> {
    let items: String = advice
        .iter()
        .map(|sentence| format!("- {sentence}\n"))
        .collect();
    let path = workspace().join(README);
    let page = fs::read_to_string(&path).with_context(|| format!("no {README}"))?;
    let block = format!("\n{items}\n{}\n", table(points, &ROWS).markdown());
    let made = between(&page, MARKS, &block);
    let made = made.with_context(|| format!("{README} has no place for it"))?;
    Ok((path, [page, made]))
}

fn advice(points: &[Point]) -> Vec<String> {
    let boards = BOARDS
        .iter()
        .filter(|board| points.iter().any(|point| point.board == *board));
    let sentence = |board: &Board, scene: &ReportedMotion| {
        let of = points
            .iter()
            .filter(|point| point.scene == scene && point.board == board);
        let parts = PURPOSES.map(|(words, serves)| {
            let cheapest = of
                .clone()
                .filter(|point| serves(point))
                .min_by(|a, b| a.cycles().total_cmp(&b.cycles()));
            match cheapest {
                Some(point) => {
                    format!("`{}` {words} for {}", point.name, thousands(point.cycles()))
                }
                None => format!("nothing {words}"),
            }
        });
        format!(
            "{}, {} motion, cycles a second: {}.",
            board.core().name(),
            scene.name,
            parts.join("; ")
        )
    };
    boards
        .flat_map(|board| [&SCENES[0], &SCENES[1]].map(|scene| sentence(board, scene)))
        .collect()
}

fn thousands(cycles: f64) -> String {
    match cycles / 1e3 {
        kilo @ ..10.0 => format!("{kilo:.1}k"),
        kilo @ ..1000.0 => format!("{kilo:.0}k"),
        kilo => format!("{:.1}M", kilo / 1e3),
    }
}

fn table(points: &[Point], names: &[&str]) -> Table {
    // A method has a row only if it was counted and compared in the long scene.
    let row = |&name: &&str| {
        let long = points
            .iter()
            .find(|point| point.name == name && point.scene == &LONG)?;
        let same = points
            .iter()
            .filter(|point| point.name == name && point.rate == long.rate);
        let short = same.clone().find(|point| point.scene == &SCENES[0])?;
        let on = |cpu: &str| {
            same.clone()
                .find(|point| point.board.cpu == cpu && point.scene == &SCENES[0])
        };
        let cycles = ["cortex-m4", "cortex-m3", "cortex-m0"].map(|cpu| {
            on(cpu).map_or_else(String::new, |point| format!("{:.0}", point.step.cycles))
        });
        let errors = [short, long].map(|point| small(point.error.angle));
        Some(
            [
                vec![name.to_owned(), long.rate.to_string()],
                cycles.to_vec(),
                errors.to_vec(),
            ]
            .concat(),
        )
    };
    const COLUMNS: &str = "method,steps a second,M4F cycles a step,M3 cycles,M0+ cycles,error in \
                           10 s (rad),error in 100 s (rad)";
    Table {
        columns: COLUMNS.split(',').collect(),
        rows: names.iter().filter_map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::join::tests::point;
    use super::*;

    #[test]
    fn a_sentence_has_25_words_at_most_and_names_the_cheapest() {
        let points = [
            point("rk4-fixed32", 4.4e4, 1e-4),
            point("rk4-f64", 1e6, 1e-4),
            point("extrapolation12-fixed64", 2e6, 1e-13),
        ];
        let advice = advice(&points);
        assert!(
            advice
                .iter()
                .all(|sentence| sentence.split_whitespace().count() <= 25),
            "{advice:?}"
        );
        let expected = "`rk4-fixed32` draws at 60 fps for 44k; `extrapolation12-fixed64` keeps \
                        1e-9 rad for 2.0M;";
        assert!(advice[0].contains(expected), "{advice:?}");
    }
}
