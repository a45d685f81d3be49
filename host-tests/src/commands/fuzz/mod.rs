//! Random input for everything that takes input from outside: nothing may panic, hang or break its promise.
//!
//! A target takes any bytes, and says by a small number what they came to. An input that comes to something new joins the
//! corpus and is varied further, so that the rare ways through a target are found and tried more often. Budgets are
//! counted in executions and every run has the same seed, so a run can be repeated to the bit. The corpus is kept in
//! `host-tests/corpus/`, a file for each target; test `fuzz` runs it whole.

mod corpus;
mod flips;
mod input;
mod link;
mod motion;
mod plan;
mod search;
mod text;

pub use flips::{Flips, ThrottledCounter};
pub use search::{Found, Search};

/// What an input came to. Inputs with the same number took the same way, as far as the target can tell.
pub type Outcome = u32;

/// Something that takes input from outside.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// What the user types, and the name of its corpus.
    pub name: &'static str,
    /// Runs it; panics if a promise is broken.
    pub run: fn(&[u8]) -> Outcome,
    /// What a run begins with, beside the corpus.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All of them. A new one is a new row.
pub const TARGETS: [Target; 8] = [
    Target { name: "decoder", run: link::decoder, seeds: link::wires },
    Target { name: "commands", run: link::commands, seeds: link::commands_seeds },
    Target { name: "parameters", run: motion::parameters, seeds: motion::seeds },
    Target { name: "steppers", run: motion::steppers, seeds: motion::seeds },
    Target { name: "plans", run: plan::plan, seeds: plan::seeds },
    Target { name: "requests", run: link::requests, seeds: link::request_seeds },
    Target { name: "numbers", run: text::numbers, seeds: text::number_seeds },
    Target { name: "options", run: text::options, seeds: text::option_seeds },
];
