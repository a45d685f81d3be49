//! What a command is doing and that it is alive: a spinner or a bar on a terminal, elsewhere plain lines or nothing.

use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// How often a plain line says that work goes on.
const REMINDER: Duration = Duration::from_secs(15);
/// How fast the spinner turns.
const TURN: Duration = Duration::from_millis(120);
/// How much of a child's latest line the spinner shows.
const SHOWN: usize = 60;

/// A bar for work whose length is known; only on a terminal.
pub fn bar(doing: &str, length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{prefix} {elapsed} {wide_bar} {pos}/{len}, {eta} left {msg}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style).with_prefix(doing.to_owned())
}

/// One piece of work that is going on. Dropping it takes the spinner away.
#[derive(Debug)]
pub struct Progress {
    doing: String,
    started: Instant,
    reminded: Instant,
    spinner: Option<ProgressBar>,
}

impl Progress {
    /// Says what begins now.
    pub fn start(doing: &str) -> Self {
        let spinner = stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{spinner} {prefix} {elapsed} {msg:.dim}");
            let spinner = ProgressBar::new_spinner().with_prefix(doing.to_owned());
            spinner.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
            spinner.enable_steady_tick(TURN);
            spinner
        });
        if spinner.is_none() {
            eprintln!("{doing} ...");
        }
        let now = Instant::now();
        Self { doing: doing.to_owned(), started: now, reminded: now, spinner }
    }

    /// To be called often: with the latest line of the one who works, or with `None` while there is none.
    pub fn alive(&mut self, line: Option<&str>) {
        match &self.spinner {
            Some(spinner) => {
                if let Some(line) = line {
                    spinner.set_message(line.chars().take(SHOWN).collect::<String>());
                }
            }
            None if self.reminded.elapsed() >= REMINDER => {
                self.reminded = Instant::now();
                eprintln!("{} ... {} s", self.doing, self.started.elapsed().as_secs());
            }
            None => {}
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(spinner) = &self.spinner {
            spinner.finish_and_clear();
        }
    }
}
