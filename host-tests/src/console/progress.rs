//! What a command is doing and that it is alive: a spinner or a bar on a terminal, elsewhere a plain line now and then.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::cli::complain;

const REMINDER: Duration = Duration::from_secs(15);
const TURN: Duration = Duration::from_millis(120);
/// How much of a child's latest line the spinner shows.
const SHOWN: usize = 60;

/// Work whose length is known: a bar on a terminal. Dropping it takes the bar away.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    reminded: Mutex<Instant>,
}

impl Bar {
    /// Says what begins now, and how many pieces it has.
    pub fn start(doing: &str, length: u64) -> Self {
        let style =
            ProgressStyle::with_template("{prefix} {elapsed} {wide_bar} {pos}/{len}, {per_sec}, {eta} left {msg}");
        let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(length).with_style(style).with_prefix(doing.to_owned());
        Self { bar, reminded: Mutex::new(Instant::now()) }
    }

    /// The pieces that were done before.
    pub fn begin_at(&self, pieces: u64) {
        self.bar.set_position(pieces);
        self.bar.reset_eta();
    }

    pub fn advance(&self, pieces: u64) {
        self.bar.inc(pieces);
        if self.bar.is_hidden() && self.reminded.lock().is_ok_and(|mut last| is_due(&mut last)) {
            self.remind();
        }
    }

    /// What turns out to be its length.
    pub fn set_length(&self, length: u64) {
        self.bar.set_length(length);
    }

    /// Says which part of it begins now.
    pub fn say(&self, part: &'static str) {
        self.bar.set_message(part);
        if self.bar.is_hidden() {
            self.remind();
        }
    }

    fn remind(&self) {
        let Self { bar, .. } = self;
        let (length, seconds) = (bar.length().unwrap_or_default(), bar.elapsed().as_secs());
        let line = format!("{} ... {} of {length}, {seconds} s {}", bar.prefix(), bar.position(), bar.message());
        complain(line.trim_end());
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// One piece of work that is going on. Dropping it takes the spinner away.
#[derive(Debug)]
pub struct Progress {
    spinner: ProgressBar,
    reminded: Instant,
}

impl Progress {
    /// Says what begins now.
    pub fn start(doing: &str) -> Self {
        let style = ProgressStyle::with_template("{spinner} {prefix} {elapsed} {msg:.dim}");
        let spinner = ProgressBar::new_spinner().with_prefix(doing.to_owned());
        spinner.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        if spinner.is_hidden() {
            complain(format_args!("{doing} ..."));
        } else {
            spinner.enable_steady_tick(TURN);
        }
        Self { spinner, reminded: Instant::now() }
    }

    /// To be called often: with the latest line of the one who works, or with `None` while there is none.
    pub fn alive(&mut self, line: Option<&str>) {
        if let Some(line) = line {
            self.spinner.set_message(line.chars().take(SHOWN).collect::<String>());
        }
        if self.spinner.is_hidden() && is_due(&mut self.reminded) {
            complain(format_args!("{} ... {} s", self.spinner.prefix(), self.spinner.elapsed().as_secs()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.spinner.finish_and_clear();
    }
}

/// Whether a plain line is due again now, `last` being when one was.
fn is_due(last: &mut Instant) -> bool {
    let is_due = last.elapsed() >= REMINDER;
    if is_due {
        *last = Instant::now();
    }
    is_due
}
