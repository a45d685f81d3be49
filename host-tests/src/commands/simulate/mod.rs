//! `cargo simulate`: any motion as a table, computed here or by the firmware on a board.

mod board;
mod list;
mod number;
mod options;
mod price;
mod request;
mod start;
mod table;
mod tolerance;

use std::io;

use firmware::job::Reading;

pub use board::on_board;
pub use list::list;
pub use number::Number;
pub use options::{Place, SimulateOptions};
pub use request::{Plan, plan};
pub use start::{Pair, StartOptions};
pub use table::{COLUMNS, Column, CsvRows};
pub use tolerance::{Choice, choose};

/// Computes the motion on the host and gives each reading to `row`.
pub fn on_host(plan: &Plan, mut row: impl FnMut(&Reading) -> io::Result<()>) -> anyhow::Result<()> {
    plan.request.readings(|reading| Ok(row(reading)?))
}
