//! The table and the chart of the READMEs: what a step costs on the chips and how far it is off after 10 s and 100 s.

use std::fs;

use anyhow::{Context, ensure};

use super::accuracy::{Error, error};
use super::c_peers::Counted;
use super::compared_rows;
use super::costs::{Cost, HALVINGS};
use super::scene::{LONG, SCENES, Scene};
use crate::commands::count::{ERROR_BAR, StepCost};
use crate::commands::table::{Table, small};
use crate::emulator::toolchain::workspace;

/// A regular motion for 10 s and for 100 s.
pub const FOLLOWED: [&Scene; 2] = [&SCENES[0], &LONG];

/// Where the READMEs' chart is kept, in the workspace.
const CHART: &str = "host-tests/pictures/report/speed-against-error.svg";
/// What stands before and after a README's table.
const MARKS: [&str; 2] = ["<!-- made by cargo write-report --readme -->\n", "<!-- so far -->\n"];
/// Whether a README shows a row of the table.
type Shows = fn(&str) -> bool;
/// The READMEs that show rows of the table: all of them, and those of the first page.
const READMES: [(&str, Shows); 2] = [("host-tests/README.md", |_| true), ("README.md", |row| TELLING.contains(&row))];
/// What exists, what the page prints, and what to take on a chip with a floating-point unit.
const TELLING: [&str; 3] =
    ["C textbook: CMSIS-DSP's arm_sin_f32 and arm_cos_f32", "f32-libm-textbook", "f32-compensated-direction"];

/// Every arithmetic and every C program; `exact` is the exact motion of the scenes [`FOLLOWED`].
pub fn table(costs: &[Cost], counted: &[Counted], exact: [&[[f64; 2]]; 2]) -> Table {
    let mut rows = Vec::new();
    let mut push = |name: &str, step_on: &dyn Fn(&str) -> Option<StepCost>, errors: [Option<Error>; 2]| {
        let whole = |count: Option<f64>| count.map_or_else(String::new, |count| format!("{count:.0}"));
        let [m4, m3] = ["cortex-m4", "cortex-m3"].map(step_on);
        let mut row = vec![name.to_owned(), whole(m4.map(|step| step.cycles))];
        row.push(whole(m4.map(|step| step.instructions)));
        row.push(whole(m3.map(|step| step.cycles)));
        row.extend(errors.map(|error| error.map_or_else(String::new, |error| small(error.angle))));
        rows.push(row);
    };
    for Counted { name, errors, .. } in counted.iter().filter(|one| one.board.cpu == "cortex-m4") {
        let step_on = |cpu: &str| Some(counted.iter().find(|one| one.name == *name && one.board.cpu == cpu)?.step);
        push(name, &step_on, errors.map(Some));
    }
    for row in compared_rows() {
        let step_on = |cpu: &str| Some(costs.iter().find(|one| one.row == row && one.board.cpu == cpu)?.step);
        let errors = [0, 1].map(|index| error(row, FOLLOWED[index], HALVINGS, exact[index]));
        push(&row.to_string(), &step_on, errors);
    }
    Table {
        name: "headline",
        title: String::from("Cost and error of a step of 1/256 s"),
        note: format!(
            "The regular scene, equal rods, one step of classical RK4 (of order 8 where the name says so). Instructions \
             are counted in QEMU. {ERROR_BAR} The error is the largest of an angle until then, against the reference.",
        ),
        columns: vec![
            "arithmetic",
            "M4F cycles (estimated)",
            "M4F instructions",
            "M3 cycles (estimated)",
            "error in 10 s (rad)",
            "error in 100 s (rad)",
        ],
        rows,
    }
}

/// Whether the READMEs show this table.
pub fn is_in_readmes(table: &Table) -> anyhow::Result<bool> {
    for (file, shows) in READMES {
        let page = fs::read_to_string(workspace().join(file)).with_context(|| format!("no {file}"))?;
        if !page.contains(&rows(table, shows).markdown_rows()) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Puts the table and the chart into the READMEs.
pub fn put_into_readmes(table: &Table, chart: &str) -> anyhow::Result<()> {
    for (file, shows) in READMES {
        let path = workspace().join(file);
        let old = fs::read_to_string(&path).with_context(|| format!("no {file}"))?;
        fs::write(&path, with_table(&old, &rows(table, shows))?)?;
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

fn with_table(readme: &str, table: &Table) -> anyhow::Result<String> {
    let places = MARKS.map(|mark| readme.find(mark));
    ensure!(matches!(places, [Some(start), Some(end)] if start < end), "a README has no place for the table");
    let [start, end] = places.map(Option::unwrap_or_default);
    let (head, tail) = (&readme[..start + MARKS[0].len()], &readme[end..]);
    Ok(format!("{head}\n{}\n{tail}", table.markdown_rows()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_replaces_the_one_between_the_marks() {
        let table = Table { columns: vec!["a", "b"], rows: vec![vec![String::from("1"); 2]], ..Table::default() };
        let old = format!("before\n{}old\n{}after\n", MARKS[0], MARKS[1]);
        let new = with_table(&old, &table).unwrap();
        assert_eq!(new, format!("before\n{}\n{}\n{}after\n", MARKS[0], table.markdown_rows(), MARKS[1]));
        assert_eq!(with_table(&new, &table).unwrap(), new);
        assert!(with_table("no marks", &table).is_err());
    }
}
