//! What the commands do, one room each.

pub mod count;
pub mod demo;
pub mod figures;
pub mod flash_f4;
pub mod flips;
pub mod fw;
pub mod pico;
pub mod plan;
pub mod prove;
pub mod report;
pub mod setup;
pub mod simulate;
pub mod table;
pub mod verify;
pub mod verify_board;
