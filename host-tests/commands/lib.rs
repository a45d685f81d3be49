//! The commands. A command is a function of its options, which [`boards::console::cli::main`]
//! parses. It prints its result to stdout. An error is returned and not printed; that function
//! prints it.
//!
//! A package, and a module of this one, imports only from those below it in this table. A package
//! is compiled apart because it is optimised, or because a command does not wait for the others.
//!
//! | package or module | content |
//! |---|---|
//! | `tests`, `peers` | the tests, grouped by the thing they test, and the benchmarks |
//! | `commands/main.rs` | the program: runs the command that is named |
//! | this package's modules | the commands: simulate, plan, prove, flips, count, report, figures, ... |
//! | [`table`] | formats the tables of the commands |
//! | [`demo`] | the package of `cargo demo`, which does not wait for the other commands |
//! | [`boards`] | emulated and connected boards, the tools that build for them; `cargo pico` |
//! | [`boards::console`] | the interface of all commands: options, numbers, errors, progress |
//! | [`cycles`] | the cost of a program on a Cortex-M, from QEMU's log |
//! | [`exact`](mod@exact) | the exact motion, known answers, tolerances; the map of flips |

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod count;
pub mod figures;
pub mod flips;
pub mod fw;
pub mod plan;
pub mod prove;
pub mod release;
pub mod report;
pub mod setup;
pub mod simulate;
pub mod table;
pub mod verify;
pub mod verify_board;
pub mod web;
