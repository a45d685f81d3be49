//! `cargo flips`: the map of flips.

use std::process::ExitCode;

use host_tests::commands::flips::{Options, Outcome, run};
use host_tests::console::cli::{self, complain, say};
use host_tests::emulator::process::interrupted_by;

fn main() -> ExitCode {
    cli::main(|options: &Options| {
        let out = options.out.display();
        match run(options)? {
            Outcome::Done { all, doubtful } => {
                let percent = 100.0 * doubtful as f64 / all as f64;
                say(format_args!("{out}: {doubtful} of {all} starts in doubt ({percent:.3} %)"))?;
                Ok(ExitCode::SUCCESS)
            }
            Outcome::Interrupted { signal, share } => {
                complain(format_args!("interrupted: {out} has {:.1} %; --resume goes on", 100.0 * share));
                Ok(ExitCode::from(interrupted_by(signal) as u8))
            }
        }
    })
}
