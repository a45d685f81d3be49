//! What the host's commands and tests share.

pub mod board;
pub mod budget;
pub mod cli;
pub mod count;
pub mod demo;
pub mod figures;
pub mod firmware_run;
pub mod fuzz;
pub mod hard_case;
pub mod known_answers;
pub mod page;
pub mod planning;
pub mod process;
pub mod progress;
pub mod qemu;
pub mod random;
pub mod reference;
pub mod report;
pub mod show;
pub mod simulate;
pub mod snapshot;
pub mod soak;
pub mod stream;
pub mod tolerance;
pub mod toolchain;
pub mod trial;
