//! The Raspberry Pi Pico in rp2040js, as an instrument: its serial link, log, panel and buttons.

mod machine;
mod talk;

pub use machine::PicoMachine;
