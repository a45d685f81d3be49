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

pub use board::on_board;
pub use list::list;
pub use number::Number;
pub use options::{Place, SimulateOptions};
pub use request::{Plan, plan};
pub use start::{Pair, StartOptions, option_of};
pub use table::{COLUMNS, Column, header, row};
pub use tolerance::{Choice, choose};
