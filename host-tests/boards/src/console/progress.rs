//! The progress of a command: a spinner or a bar on a terminal, elsewhere a plain line from time to
//! time.

use std::fmt::{Display, Write};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{HumanCount, MultiProgress, ProgressBar, ProgressState, ProgressStyle};

use super::cli::complain;

const FIRST: u64 = 5;
const REMINDER: u64 = 15;
const TURN: Duration = Duration::from_millis(120);
const SHOWN: usize = 60;

static BARS: OnceLock<MultiProgress> = OnceLock::new();

/// Prints a line above the progress that a terminal shows.
pub fn complain_above(line: impl Display) {
    match BARS.get() {
        Some(bars) => bars.suspend(|| complain(line)),
        None => complain(line),
    }
}

/// Work in progress: a spinner, a bar, or lines.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    reminders: AtomicU64,
}

impl Progress {
    /// Begins work of unknown length: a spinner on a terminal, elsewhere a line, repeated from time
    /// to time.
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

    /// Begins work with a known number of pieces: a bar on a terminal, elsewhere a line from time
    /// to time.
    pub fn of(doing: &str, length: u64) -> Self {
        let style = "{prefix} {elapsed} {wide_bar} {pos}/{len}, {rate}/s, {eta} left";
        Self::new(doing, ProgressBar::new(length), style)
    }

    fn new(doing: &str, bar: ProgressBar, style: &str) -> Self {
        let rate = |state: &ProgressState, text: &mut dyn Write| {
            _ = write!(text, "{}", HumanCount(state.per_sec() as u64));
        };
        let style = ProgressStyle::with_template(style)
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key("rate", rate);
        let bar = BARS.get_or_init(MultiProgress::new).add(bar);
        Self {
            bar: bar.with_style(style).with_prefix(doing.to_owned()),
            reminders: AtomicU64::new(0),
        }
    }

    pub fn advance(&self, pieces: u64) {
        self.bar.inc(pieces);
        self.remind();
    }

    /// Shows that the work continues, with the last line of a child process, if there is a new one.
    pub fn alive(&self, line: Option<&str>) {
        if let Some(line) = line {
            self.bar
                .set_message(line.chars().take(SHOWN).collect::<String>());
        }
        self.remind();
    }

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
