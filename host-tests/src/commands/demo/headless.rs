//! Without a terminal: an emulated board frame by frame, repeatable bit for bit, or the board at a port; with a summary at
//! the end.

use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::ensure;

use super::DemoOptions;
use super::session::Session;
use crate::console::cli::{complain, say};
use crate::console::progress::Progress;

pub const DEFAULT_SECONDS: f64 = 10.0;
const LOOK: Duration = Duration::from_millis(4);
/// A port from which no frame comes for so long is given up.
const PATIENCE: Duration = Duration::from_secs(10);

/// How long an answer to the last question of the comparison is waited for, s of the board's time.
const ANSWER: f64 = 3.0;

pub fn run(options: &DemoOptions, mut session: Session) -> anyhow::Result<bool> {
    let seconds = options.seconds.unwrap_or(DEFAULT_SECONDS);
    let name = session.source.name().to_owned();
    let progress = Progress::start(&format!("running {name} for {seconds} s of its time"));
    let start = Instant::now();
    let is_over = |session: &Session| {
        let is_settled = session.readings.comparison.is_settled() || session.seconds() > seconds + ANSWER;
        session.seconds() >= seconds && is_settled
    };
    while !is_over(&session) {
        session.hear()?;
        if session.is_recording_due() {
            session.look()?;
        }
        if session.source.is_port() {
            session.readings.lines.drain(..).for_each(|line| complain(line.text));
            let last = session.readings.arrivals.last().unwrap_or(&start);
            ensure!(last.elapsed() < PATIENCE, "{name}: no frame for {} s", PATIENCE.as_secs());
            sleep(LOOK);
        }
        progress.alive(None);
    }
    drop(progress);
    session.look()?;
    session.finish()?;
    session.readings.lines.extend(session.source.lines());
    let faults = session.faults();
    faults.iter().for_each(|fault| complain(format_args!("not well: {fault}")));
    let said = say(format_args!("board                 {name}\n{}", session.readings.report()));
    // A fault is one even if no one reads the summary.
    if faults.is_empty() {
        said?;
    }
    Ok(faults.is_empty())
}
