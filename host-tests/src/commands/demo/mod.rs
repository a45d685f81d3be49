//! `cargo demo`: the double pendulum on a board's panel, live in the terminal or recorded without one; the board is emulated,
//! or at a serial port.

pub(crate) mod comparison;
mod headless;
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
use std::time::Duration;

use record::Recording;
use session::Session;
use source::Source;

use crate::console::cli::Refused;
use crate::emulator::boards::PICO;
use crate::emulator::pico::PicoMachine;
use crate::emulator::qemu::{Clock, Lockstep, Machine, Settings};
use crate::emulator::toolchain;
use crate::link::{Port, find};

/// The most time that an emulated board may take without a terminal: so much, and so much for each second of its time.
const LIMIT: (Duration, f64) = (Duration::from_secs(60), 20.0);
/// With one: no one watches longer.
const LIVE_LIMIT: Duration = Duration::from_secs(24 * 3600);

pub fn run(options: &DemoOptions) -> anyhow::Result<bool> {
    let headless = options.headless || !(stdout().is_terminal() && stdin().is_terminal());
    options.check()?;
    // Before the build, which takes its time.
    let port = options.port.as_deref().map(port).transpose()?;
    let source = port.map_or_else(|| emulated(options, headless), |port| Ok(Source::Port(port)))?;
    let recording = options.record.as_deref().map(Recording::create).transpose();
    let session = Session::new(options, source, recording?, !headless);
    if headless { headless::run(options, session) } else { live::run(options, session) }
}

pub(crate) fn port(name: &str) -> Result<Port, Refused> {
    let refused = |reason: String| Refused::because(format_args!("--port {reason}"));
    Port::open(&find(name).map_err(refused)?).map_err(refused)
}

fn emulated(options: &DemoOptions, headless: bool) -> anyhow::Result<Source<'_>> {
    let (toolchain, _) = toolchain::set_up()?;
    let (board, seconds) = (options.board, options.seconds.unwrap_or(headless::DEFAULT_SECONDS));
    let limit = if headless { LIMIT.0 + Duration::from_secs_f64(LIMIT.1 * seconds) } else { LIVE_LIMIT };
    if *board == PICO {
        let (emulator, _) = toolchain::set_up_pico()?;
        return Ok(Source::Pico(Box::new(PicoMachine::start(&emulator, &toolchain.build_for(board)?, limit)?)));
    }
    let elf = toolchain.build_for(board)?;
    let settings = Settings { qemu: toolchain.qemu(), board, elf: &elf, debugger: true, clock: Clock::Real, limit };
    if headless {
        return Ok(Source::Lockstep(Lockstep::start(&settings)?, board));
    }
    Ok(Source::Live(Machine::start(&settings)?, board))
}
