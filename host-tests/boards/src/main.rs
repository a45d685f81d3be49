//! The program of `cargo pico` and `cargo flash-f4`.

use std::env::args_os;
use std::process::ExitCode;

use boards::console::cli::main as run;
use boards::flash;

fn main() -> ExitCode {
    if args_os().nth(1).is_some_and(|name| name == "flash-f4") {
        run(flash::stm32f405)
    } else {
        run(flash::pico)
    }
}
