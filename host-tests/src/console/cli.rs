//! What every command does alike: one clear line for a wrong option, exit code 2.

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;

/// The exit code for a request that cannot be served as asked: wrong options, missing tools.
pub const REFUSED: u8 = 2;

/// The options of this run; if they are wrong, or help is asked for, the exit code after saying so.
pub fn parse<Options: Parser>() -> Result<Options, ExitCode> {
    Options::try_parse().map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed output is no failure of ours.
            let _ = error.print();
            ExitCode::SUCCESS
        }
        _ => refuse(one_line(&error.to_string())),
    })
}

/// Says why, in one line, and gives the exit code.
pub fn refuse(reason: impl std::fmt::Display) -> ExitCode {
    eprintln!("{reason}");
    ExitCode::from(REFUSED)
}

/// The first paragraph of clap's report as one line; the usage that follows is left to `--help`.
fn one_line(report: &str) -> String {
    report.lines().take_while(|line| !line.is_empty()).map(str::trim).collect::<Vec<_>>().join(" ")
}
