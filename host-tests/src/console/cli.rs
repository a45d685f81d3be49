//! What every command does alike: its options, what it says, one clear line for an error, and the exit code.

use std::env;
use std::fmt::{self, Display};
use std::io::{self, ErrorKind, Write, stderr, stdout};
use std::path::Path;
use std::process::{ExitCode, Termination};

use clap::Parser;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// The exit code for a request that cannot be served as asked: wrong options, missing tools.
pub const REFUSED: u8 = 2;

/// A request that cannot be served as asked, and why, in one line: exit code 2. Any other error is exit code 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused(String);

impl Refused {
    /// With the reason that is printed after `error: `.
    pub fn because(reason: impl Display) -> Self {
        Self(reason.to_string())
    }
}

impl std::error::Error for Refused {}

impl Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Runs a command with the options of this run, and gives its exit code after saying what went wrong.
///
/// Who reads its output may stop at any time (`| head`): the command then ends quietly and with success.
pub fn main<Options: Parser, Done: Termination>(
    run: impl FnOnce(&Options) -> anyhow::Result<Done>,
) -> ExitCode {
    let options = match parse() {
        Ok(options) => options,
        Err(code) => return code,
    };
    // The reader of our output has seen enough. (A broken pipe to a child comes wrapped in an error of its own.)
    let is_closed = |error: &io::Error| error.kind() == ErrorKind::BrokenPipe;
    match run(&options) {
        Ok(done) => done.report(),
        Err(error) if error.downcast_ref().is_some_and(is_closed) => ExitCode::SUCCESS,
        Err(error) => {
            complain(format_args!("error: {error:#}"));
            if error.is::<Refused>() {
                ExitCode::from(REFUSED)
            } else {
                ExitCode::FAILURE
            }
        }
    }
}

/// The exit code of a command that has looked for faults: whether all was well.
pub fn verdict(well: bool) -> ExitCode {
    ExitCode::from(u8::from(!well))
}

/// Prints a line of the command's result. A closed output is an error that [`main`] takes for a quiet end.
pub fn say(line: impl Display) -> io::Result<()> {
    writeln!(stdout(), "{line}")
}

/// Prints a line beside the result: an error, a warning, progress. That it cannot be read is no failure.
pub fn complain(line: impl Display) {
    let _ = writeln!(stderr(), "{line}");
}

/// The refusal of a file that cannot be written.
pub fn unwritable(option: &str, path: &Path, error: &io::Error) -> Refused {
    Refused::because(format_args!(
        "{option}: cannot write {}: {error}",
        path.display()
    ))
}

pub fn choice<Choice>(
    choices: impl IntoIterator<Item = Choice>,
    name: impl Fn(Choice) -> &'static str,
) -> impl TypedValueParser<Value = Choice>
where
    Choice: Copy + Send + Sync + 'static,
{
    let named: Vec<_> = choices
        .into_iter()
        .map(|choice| (name(choice), choice))
        .collect();
    PossibleValuesParser::new(named.iter().map(|(name, _)| *name).collect::<Vec<_>>()).try_map(
        move |text| {
            named
                .iter()
                .find(|(name, _)| *name == text)
                .map(|(_, choice)| *choice)
                .ok_or("unknown")
        },
    )
}

/// The options of this run; if they are wrong, or help is asked for, the exit code after saying so.
fn parse<Options: Parser>() -> Result<Options, ExitCode> {
    // A number is the value of its option with a sign, too: what is wrong with it, the option says.
    let command = Options::command();
    let name = command.get_name().to_owned();
    let own = name.trim_start_matches("cargo ");
    let command = command.bin_name(&name).mut_args(|option| {
        if option.get_action().takes_values() {
            option.allow_negative_numbers(true)
        } else {
            option
        }
    });
    // Its name comes first.
    let words = env::args_os()
        .enumerate()
        .filter(|(place, word)| *place != 1 || word.to_str() != Some(own));
    let matches = command.try_get_matches_from(words.map(|(_, word)| word));
    matches
        .and_then(|matches| Options::from_arg_matches(&matches))
        .map_err(|error| {
            if error.use_stderr() {
                complain(one_line(&error.to_string()));
                return ExitCode::from(REFUSED);
            }
            // Help was asked for. A closed output is no failure of ours.
            let _ = error.print();
            ExitCode::SUCCESS
        })
}

/// The first paragraph of clap's report as one line, and its tip; the usage that follows is left to
/// `--help`.
fn one_line(report: &str) -> String {
    let first = report.lines().take_while(|line| !line.is_empty());
    let line = first.map(str::trim).collect::<Vec<_>>().join(" ");
    let tip = report
        .lines()
        .find_map(|line| line.trim().strip_prefix("tip: a similar "))
        .map_or(String::new(), |tip| format!("; a similar {tip}"));
    // The standard library's words for a number that is none.
    let line = line
        .replace("invalid digit found in string", "not a whole number")
        .replace("invalid float literal", "not a number");
    line + &tip
}
