//! The program of `cargo demo` alone, which is compiled without the other commands.

use std::process::ExitCode;

use boards::console::cli::{main as run, verdict};

fn main() -> ExitCode {
    run(|options| demo::run(options).map(verdict))
}
