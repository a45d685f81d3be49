//! The program of all commands. `.cargo/config.toml` runs each with its name as the first argument.
//! Without a name, or with another first argument, it is the demo.

use std::ffi::OsStr;
use std::process::ExitCode;

use boards::console::cli::{main as run, verdict};
use host_tests::{
    count, figures, flips, fw, plan, prove, release, report, setup, simulate, verify, verify_board,
    web,
};

fn main() -> ExitCode {
    // A name that is not UTF-8 is none of these.
    let name = std::env::args_os().nth(1);
    match name.as_deref().and_then(OsStr::to_str) {
        Some("count") => run(count::run),
        Some("figures") => run(figures::run),
        Some("flash-f4") => run(boards::flash::stm32f405),
        Some("flips") => run(flips::run),
        Some("fw") => run(fw::run),
        Some("pico") => run(boards::flash::pico),
        Some("plan") => run(plan::run),
        Some("prove") => run(prove::run),
        Some("release-files") => run(release::run),
        Some("setup") => run(setup::run),
        Some("simulate") => run(simulate::run),
        Some("verify") => run(verify::run),
        Some("verify-board") => run(|options| verify_board::run(options).map(verdict)),
        Some("web") => run(web::run),
        Some("write-report") => run(report::run),
        _ => run(|options| demo::run(options).map(verdict)),
    }
}
