//! The behaviour that all commands share: options, output, errors, and the exit code.

use std::env;
use std::ffi::OsString;
use std::fmt::{self, Display};
use std::io::{self, ErrorKind, Write, stderr, stdout};
use std::path::Path;
use std::process::{ExitCode, Termination};

use clap::Parser;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use double_pendulum::{Error, Parameter};

use super::number::Number;

pub const REFUSED: u8 = 2;

/// A request that cannot be served, with the reason: one line, or one for each missing tool. The
/// exit code is 2, that of any other error 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused(String);

impl Refused {
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

/// Runs a command with the options of the command line. The first argument is left out if it is the
/// name of the command without `cargo `, because cargo passes it. The reader of the output may stop
/// at any time (`| head`): the command then ends quietly and with success.
pub fn main<Options: Parser, Done: Termination>(
    run: impl FnOnce(&Options) -> anyhow::Result<Done>,
) -> ExitCode {
    let options = match parse() {
        Ok(options) => options,
        Err(code) => return code,
    };

    // A broken pipe to a child process is wrapped in another error.
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

pub fn verdict(well: bool) -> ExitCode {
    ExitCode::from(u8::from(!well))
}

/// Prints a line of the command's result.
pub fn say(line: impl Display) -> io::Result<()> {
    writeln!(stdout(), "{line}")
}

/// Prints an error, a warning or progress.
pub fn complain(line: impl Display) {
    let _ = writeln!(stderr(), "{line}");
}

pub fn unwritable(option: &str, path: &Path, error: &io::Error) -> Refused {
    Refused::because(format_args!(
        "{option}: cannot write {}: {error}",
        path.display()
    ))
}

/// Returns a parser that accepts the names of these choices, which the help lists.
pub fn choice<Choice>(
    choices: impl IntoIterator<Item = Choice>,
    name: impl Fn(Choice) -> &'static str,
) -> impl TypedValueParser<Value = Choice>
where
    Choice: Copy + Send + Sync + 'static,
{
    choice_with_aliases(choices, move |choice| vec![name(choice)])
}

/// Returns a parser like [`choice`]. The first name of a choice is listed; the others are aliases
/// that are not.
pub fn choice_with_aliases<Choice>(
    choices: impl IntoIterator<Item = Choice>,
    names: impl Fn(Choice) -> Vec<&'static str>,
) -> impl TypedValueParser<Value = Choice>
where
    Choice: Copy + Send + Sync + 'static,
{
    let named: Vec<_> = choices
        .into_iter()
        .map(|choice| (names(choice), choice))
        .collect();
    let values = named.iter().filter_map(|(names, _)| {
        let (first, aliases) = names.split_first()?;
        Some(PossibleValue::new(*first).aliases(aliases.to_vec()))
    });
    PossibleValuesParser::new(values.collect::<Vec<_>>()).try_map(move |text| {
        let is_first = |(names, _): &&(Vec<_>, Choice)| names.first() == Some(&&*text);
        let is_any = |(names, _): &&(Vec<_>, Choice)| names.contains(&&*text);
        let found = named
            .iter()
            .find(is_first)
            .or_else(|| named.iter().find(is_any));
        found.map(|(_, choice)| *choice).ok_or("unknown")
    })
}

fn parse<Options: Parser>() -> Result<Options, ExitCode> {
    // A negative number is also accepted as the value of an option. The option itself then reports
    // why the number is invalid.
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

    let words = env::args_os()
        .enumerate()
        .filter(|(place, word)| *place != 1 || word.to_str() != Some(own));
    let words: Vec<_> = words.map(|(_, word)| word).collect();
    if let Some(reason) = two_words(&words) {
        complain(format_args!("error: {reason}"));
        return Err(ExitCode::from(REFUSED));
    }
    let matches = command.try_get_matches_from(words);
    matches
        .and_then(|matches| Options::from_arg_matches(&matches))
        .map_err(|error| {
            if error.use_stderr() {
                complain(one_line(&error.to_string()));
                return ExitCode::from(REFUSED);
            }

            let _ = error.print();
            ExitCode::SUCCESS
        })
}

/// Returns the right form of the first option that is followed by two numbers in two words.
fn two_words(words: &[OsString]) -> Option<String> {
    let words: Vec<_> = words.iter().map(|word| word.to_str()).collect();
    words.windows(3).find_map(|words| {
        let &[Some(option), Some(first), Some(second)] = words else {
            return None;
        };
        let one = first.trim_end_matches(',');
        let is_pair = [one, second]
            .iter()
            .all(|word| word.parse::<Number>().is_ok());
        (option.starts_with("--") && is_pair).then(|| {
            format!(
                "{option} {first} {second}: write a comma and no space, {option} {one},{second}"
            )
        })
    })
}

/// Returns the first paragraph of clap's report. The others repeat the usage, which `--help`
/// prints.
fn one_line(report: &str) -> String {
    let first = report.lines().take_while(|line| !line.is_empty());
    let line = first.map(str::trim).collect::<Vec<_>>().join(" ");
    let tip = report
        .lines()
        .find_map(|line| line.trim().strip_prefix("tip: a similar "))
        .map_or(String::new(), |tip| format!("; a similar {tip}"));

    let line = line
        .replace(
            "one or more of the other specified arguments",
            "other options",
        )
        .replace(
            "the following required arguments were not provided:",
            "required, but missing:",
        )
        .replace("invalid digit found in string", "not a whole number")
        .replace("invalid float literal", "not a number");
    line + &tip
}

/// Returns the option that sets the refused parameter, or `otherwise`.
pub fn option_of(error: &Error, otherwise: &'static str) -> &'static str {
    match error.parameter() {
        _ if matches!(error, Error::Diverged { .. }) => otherwise,
        Parameter::M1 | Parameter::M2 => "--masses",
        Parameter::L1 | Parameter::L2 => "--lengths",
        Parameter::G => "--gravity",
        Parameter::A1 | Parameter::A2 => "--angles",
        Parameter::W1 | Parameter::W2 | Parameter::P1 | Parameter::P2 => "--velocities",
        Parameter::Tolerance => "--height",
        Parameter::Duration => "--seconds",
        Parameter::Rate => "--rate",
        _ => otherwise,
    }
}
