//! Every command: `.cargo/config.toml` calls each by its name, which comes first; without one it is the demo.

use std::process::ExitCode;

use host_tests::commands::{
    count, demo, figures, flash_f4, flips, fw, pico, plan, prove, report, setup, simulate, verify, verify_board,
};
use host_tests::console::cli::{main as run, verdict};

fn main() -> ExitCode {
    match std::env::args().nth(1).as_deref() {
        Some("count") => run(count::run),
        Some("figures") => run(figures::run),
        Some("flash-f4") => run(flash_f4::run),
        Some("flips") => run(flips::run),
        Some("fw") => run(fw::run),
        Some("pico") => run(pico::run),
        Some("plan") => run(plan::run),
        Some("prove") => run(prove::run),
        Some("setup") => run(setup::run),
        Some("simulate") => run(simulate::run),
        Some("verify") => run(verify::run),
        Some("verify-board") => run(|options| verify_board::run(options).map(verdict)),
        Some("write-report") => run(report::run),
        _ => run(|options| demo::run(options).map(verdict)),
    }
}
