//! The table and the chart of the READMEs: what a step costs on the chips and how far it is off after 10 s and 100 s.

use std::fs;

use anyhow::{Context, ensure};

use super::accuracy::{Error, error, usual_rate};
use super::c_peers::{Counted, RATE};
use super::compared;
use super::costs::Cost;
use super::scene::{LONG, SCENES, Scene};
use crate::commands::count::{ERROR_BAR, StepCost};
use crate::commands::table::{Table, small};
use crate::emulator::toolchain::workspace;

/// A regular motion for 10 s and for 100 s.
const FOLLOWED: [&Scene; 2] = [&SCENES[0], &LONG];

/// Where the READMEs' chart is kept, in the workspace.
const CHART: &str = "host-tests/pictures/report/speed-against-error.svg";
/// What stands before and after a README's table.
const MARKS: [&str; 2] = ["<!-- made by cargo write-report --readme -->\n", "<!-- so far -->\n"];
/// Whether a README shows a row of the table.
type Shows = fn(&str) -> bool;
/// The READMEs that show rows of the table: all of them, and those of the first page.
const READMES: [(&str, Shows); 2] = [("host-tests/README.md", |_| true), ("README.md", |row| TELLING.contains(&row))];
/// What exists, what the page prints, and what to take.
const TELLING: [&str; 5] = [
    "C textbook: CMSIS-DSP's arm_sin_f32 and arm_cos_f32",
    "textbook-f32",
    "rk4-f32-direction",
    "rk4-fixed32",
    "extrapolation12-fixed64",
];

/// Every method and every C program; `exact` is the exact motion of the scenes [`FOLLOWED`].
pub fn table(costs: &[Cost], counted: &[Counted], exact: [&[[f64; 2]]; 2]) -> Table {
    let mut rows = Vec::new();
    let mut push = |name: &str, rate: u32, step_on: &dyn Fn(&str) -> Option<StepCost>, errors: [Option<Error>; 2]| {
        let whole = |count: Option<f64>| count.map_or_else(String::new, |count| format!("{count:.0}"));
        let [m4, m3] = ["cortex-m4", "cortex-m3"].map(step_on);
        let mut row = vec![name.to_owned(), rate.to_string(), whole(m4.map(|step| step.cycles))];
        row.push(whole(m4.map(|step| step.instructions)));
        row.push(whole(m3.map(|step| step.cycles)));
        row.extend(errors.map(|error| error.map_or_else(String::new, |error| small(error.angle))));
        rows.push(row);
    };
    for one in counted.iter().filter(|one| one.board.cpu == "cortex-m4") {
        let step_on =
            |cpu: &str| Some(counted.iter().find(|other| other.name == one.name && other.board.cpu == cpu)?.step);
        push(one.name, RATE, &step_on, [one.error(), Some(one.long)]);
    }
    for method in compared() {
        let step_on = |cpu: &str| Some(costs.iter().find(|one| one.method == method && one.board.cpu == cpu)?.step);
        let errors = [0, 1].map(|index| error(method, FOLLOWED[index], usual_rate(method), exact[index]));
        push(method.name(), usual_rate(method), &step_on, errors);
    }
    Table {
        name: "headline",
        title: String::from("Cost and error of a step"),
        note: format!(
            "The regular scene, equal rods, one step of classical RK4 or of the order that the name says. Instructions are \
             counted in QEMU. {ERROR_BAR} The error is the largest of an angle until then, against the reference.",
        ),
        columns: vec![
            "method",
            "steps a second",
            "M4F cycles (estimated)",
            "M4F instructions",
            "M3 cycles (estimated)",
            "error in 10 s (rad)",
            "error in 100 s (rad)",
        ],
        rows,
    }
}

/// Whether the READMEs show this.
pub fn is_in_readmes(advice: &[String], table: &Table) -> anyhow::Result<bool> {
    for (file, shows) in READMES {
        let page = fs::read_to_string(workspace().join(file)).with_context(|| format!("no {file}"))?;
        if !page.contains(&section(advice, &rows(table, shows))) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Puts the advice, the table and the chart into the READMEs.
pub fn put_into_readmes(advice: &[String], table: &Table, chart: &str) -> anyhow::Result<()> {
    for (file, shows) in READMES {
        let path = workspace().join(file);
        let old = fs::read_to_string(&path).with_context(|| format!("no {file}"))?;
        fs::write(&path, with_section(&old, &section(advice, &rows(table, shows)))?)?;
    }
    let chart_path = workspace().join(CHART);
    chart_path.parent().map_or(Ok(()), fs::create_dir_all)?;
    Ok(fs::write(chart_path, chart)?)
}

/// The table with those rows alone whose first cell `shows` accepts.
fn rows(table: &Table, shows: fn(&str) -> bool) -> Table {
    let is_shown = |row: &&Vec<String>| row.first().is_some_and(|name| shows(name));
    Table { rows: table.rows.iter().filter(is_shown).cloned().collect(), ..table.clone() }
}

/// The advice as a list, and the table.
fn section(advice: &[String], table: &Table) -> String {
    let items: String = advice.iter().map(|sentence| format!("- {sentence}\n")).collect();
    format!("{items}\n{}", table.markdown_rows())
}

fn with_section(readme: &str, section: &str) -> anyhow::Result<String> {
    let places = MARKS.map(|mark| readme.find(mark));
    ensure!(
        matches!(places, [Some(start), Some(end)] if start < end),
        "a README has no place for the advice and the table"
    );
    let [start, end] = places.map(Option::unwrap_or_default);
    let (head, tail) = (&readme[..start + MARKS[0].len()], &readme[end..]);
    Ok(format!("{head}\n{section}\n{tail}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_replaces_the_one_between_the_marks() -> anyhow::Result<()> {
        let table = Table { columns: vec!["a", "b"], rows: vec![vec![String::from("1"); 2]], ..Table::default() };
        let section = section(&[String::from("take a")], &table);
        assert!(section.starts_with("- take a\n\n| a |"), "{section}");
        let old = format!("before\n{}old\n{}after\n", MARKS[0], MARKS[1]);
        let new = with_section(&old, &section)?;
        assert_eq!(new, format!("before\n{}\n{section}\n{}after\n", MARKS[0], MARKS[1]));
        assert_eq!(with_section(&new, &section)?, new);
        assert!(with_section("no marks", &section).is_err());
        Ok(())
    }
}
