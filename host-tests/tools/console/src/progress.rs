//! The progress of a command: a spinner or a bar on a terminal, elsewhere a plain line from time to
//! time.

use std::fmt::Display;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use super::cli::complain;

/// The seconds before the first line, and between two lines.
const FIRST: u64 = 5;
const REMINDER: u64 = 15;
/// The time between two pictures of the spinner.
const TURN: Duration = Duration::from_millis(120);
/// The number of characters of a child's last line that the spinner shows.
const SHOWN: usize = 60;

/// All pieces of work that are shown. Concurrent ones each have a line of their own.
static BARS: OnceLock<MultiProgress> = OnceLock::new();

/// Prints a line to standard error as [`complain`] does, above the progress that a terminal shows.
pub fn complain_above(line: impl Display) {
    match BARS.get() {
        Some(bars) => bars.suspend(|| complain(line)),
        None => complain(line),
    }
}

/// Work in progress. It appears on standard error; several at once have a line each. A failure to
/// print is ignored. Dropping it removes the bar or spinner; a plain line stays.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// The number of lines that were already due.
    reminders: AtomicU64,
}

impl Progress {
    /// Begins work of unknown length and announces it at once; `doing` names it. If standard error
    /// is a terminal, it is a spinner that turns by itself. Elsewhere it is a line, which calls of
    /// [`Self::alive`] or [`Self::advance`] repeat with the time after 5 s, and then every 15 s.
    pub fn start(doing: &str) -> Self {
        let progress = Self::new(
            doing,
            ProgressBar::new_spinner(),
            "{spinner} {prefix} {elapsed} {wide_msg:.dim}",
        );
        if progress.bar.is_hidden() {
            complain(format_args!("{doing} ..."));
        } else {
            progress.bar.enable_steady_tick(TURN);
        }
        progress
    }

    /// Begins work with a known number of pieces, named `doing`. If standard error is a terminal,
    /// it is a bar. Elsewhere nothing is printed at first; calls of [`Self::advance`] or
    /// [`Self::alive`] print a line with the completed pieces and the time after 5 s, and then every
    /// 15 s.
    pub fn of(doing: &str, length: u64) -> Self {
        let style = "{prefix} {elapsed} {wide_bar} {pos}/{len}, {per_sec}, {eta} left";
        Self::new(doing, ProgressBar::new(length), style)
    }

    fn new(doing: &str, bar: ProgressBar, style: &str) -> Self {
        let style =
            ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = BARS.get_or_init(MultiProgress::new).add(bar);
        Self {
            bar: bar.with_style(style).with_prefix(doing.to_owned()),
            reminders: AtomicU64::new(0),
        }
    }

    /// Adds this number to the completed pieces. The sum is not checked against the length and is
    /// shown as it is. Several threads may call this.
    pub fn advance(&self, pieces: u64) {
        self.bar.inc(pieces);
        self.remind();
    }

    /// Shows that the work continues. It is called often, with the last line of a child process, or
    /// with `None` if there is no new line; the last one then stays. A spinner shows the first 60
    /// characters of the line; a bar and a plain line do not show it.
    pub fn alive(&self, line: Option<&str>) {
        if let Some(line) = line {
            self.bar
                .set_message(line.chars().take(SHOWN).collect::<String>());
        }
        self.remind();
    }

    /// Prints a line if there is no terminal and one is due.
    fn remind(&self) {
        let bar = &self.bar;
        let seconds = bar.elapsed().as_secs();
        let due = (seconds + REMINDER - FIRST) / REMINDER;

        // A hidden bar means that the output is no terminal. Its reminders are lines.
        if bar.is_hidden() && self.reminders.fetch_max(due, Ordering::Relaxed) < due {
            let pieces = bar.length().map_or(String::new(), |length| {
                format!("{} of {length}, ", bar.position())
            });
            complain(format_args!("{} ... {pieces}{seconds} s", bar.prefix()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
