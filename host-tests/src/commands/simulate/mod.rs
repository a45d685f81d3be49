//! `cargo simulate`: any motion as a table, computed here or by the firmware on a board.

mod board;
mod number;
mod options;
mod order8;
mod request;
mod start;
mod table;

use std::io;

use firmware::job::{Job, Reading};

pub use board::on_board;
pub use number::{Number, NumberError};
pub use options::{Method, Options, Place};
pub use request::{Plan, plan};
pub use start::Start;
pub use table::Table;

/// Computes the motion on the host and gives each reading to `row`.
pub fn on_host(plan: &Plan, mut row: impl FnMut(&Reading) -> io::Result<()>) -> anyhow::Result<()> {
    if plan.method == Method::Order8 {
        return order8::run(plan, row);
    }
    let mut job = Job::new(&plan.request)?;
    while !job.is_finished() {
        if let Some(reading) = job.advance()? {
            row(&reading)?;
        }
    }
    Ok(())
}
