//! `cargo demo`: the double pendulum on a board's panel, live in the terminal or recorded without one; the board is emulated,
//! or at a serial port.

pub(crate) mod comparison;
mod live;
mod numbers;
mod options;
mod panel;
mod plot;
mod readings;
pub(crate) mod record;
mod session;
mod source;
mod view;

pub use options::DemoOptions;
pub use record::played;

use std::io::{IsTerminal, stdin, stdout};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::ensure;
use record::Recording;
use session::Session;
use source::Source;

use crate::console::cli::{Refused, complain, say};
use crate::console::progress::Progress;
use crate::emulator::boards::PICO;
use crate::emulator::pico::PicoMachine;
use crate::emulator::qemu::{Clock, Machine, Settings};
use crate::emulator::toolchain;
use crate::link::Port;

/// How long a run without a terminal takes if nothing else is asked for.
const DEFAULT_SECONDS: f64 = 10.0;
/// The most time that an emulated board may take without a terminal: so much, and so much for each second of its time.
const LIMIT: (Duration, f64) = (Duration::from_secs(60), 20.0);
/// With one: no one watches longer.
const LIVE_LIMIT: Duration = Duration::from_secs(24 * 3600);

pub fn run(options: &DemoOptions) -> anyhow::Result<bool> {
    let is_live = !options.headless && stdout().is_terminal() && stdin().is_terminal();
    options.check()?;
    // Before the build, which takes its time.
    let port = options.port.as_deref().map(port).transpose()?;
    let source = port.map_or_else(|| emulated(options, is_live), |port| Ok(Source::Port(port)))?;
    let recording = options.record.as_deref().map(Recording::create).transpose();
    let session = Session::new(options, source, recording?, is_live);
    if is_live { live::run(options, session) } else { headless(options, session) }
}

pub(crate) fn port(name: &str) -> Result<Port, Refused> {
    Port::open(name).map_err(|reason| Refused::because(format_args!("--port {reason}")))
}

fn emulated(options: &DemoOptions, is_live: bool) -> anyhow::Result<Source<'_>> {
    let toolchain = toolchain::set_up()?;
    let (board, seconds) = (options.board, options.seconds.unwrap_or(DEFAULT_SECONDS));
    let limit = if is_live { LIVE_LIMIT } else { LIMIT.0 + Duration::from_secs_f64(LIMIT.1 * seconds) };
    if *board == PICO {
        let emulator = toolchain::set_up_pico()?;
        return Ok(Source::Pico(Box::new(PicoMachine::start(&emulator, &toolchain.build_for(board)?, limit)?)));
    }
    let elf = toolchain.build_for(board)?;
    let settings = Settings { qemu: &toolchain.qemu, board, elf: &elf, debugger: true, clock: Clock::Real, limit };
    if is_live {
        return Ok(Source::Live(Machine::start(&settings)?, board));
    }
    Ok(Source::Lockstep(Machine::halted(&settings)?, board))
}

const LOOK: Duration = Duration::from_millis(4);
/// A port from which no frame of the scene that was asked for comes for so long is given up.
const PATIENCE: Duration = Duration::from_secs(10);

/// How long an answer to the last question of the comparison is waited for, s of the board's time.
const ANSWER: f64 = 3.0;

/// Without a terminal: an emulated board frame by frame, repeatable bit for bit, or the board at a port; with a summary at the end.
fn headless(options: &DemoOptions, mut session: Session) -> anyhow::Result<bool> {
    let seconds = options.seconds.unwrap_or(DEFAULT_SECONDS);
    let name = session.source.name().to_owned();
    let progress = Progress::start(&format!("running {name} for {seconds} s of its time"));
    let (mut reached, mut since) = (0.0, Instant::now());
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
            if session.seconds() > reached {
                (reached, since) = (session.seconds(), Instant::now());
            }
            ensure!(since.elapsed() < PATIENCE, "{name}: no frame for {} s", PATIENCE.as_secs());
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
