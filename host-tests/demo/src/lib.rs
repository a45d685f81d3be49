//! `cargo demo`: the double pendulum on a board's panel, live in the terminal or recorded without a
//! terminal. The board is emulated, or connected to a serial port.

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod comparison;
mod help;
mod live;
mod motion;
mod numbers;
mod options;
mod panel;
mod readings;
mod session;
#[cfg(test)]
#[path = "../../tests/support/snapshot.rs"]
pub mod snapshot;
mod view;

pub use options::DemoOptions;
pub use options::{KEYS, scene_key, shows};
pub use panel::palette;
pub use panel::played;
pub use session::SPEEDS;

use std::env;
use std::io::{IsTerminal, stdin, stdout};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::ensure;
use options::MOST_SECONDS;
use panel::{Recording, png};
use session::{Session, Source};

use firmware::config::{CORTEX_M0PLUS, TICK_RATE};
use firmware::graphics::PanelName;
use firmware::scenes::SceneName;

use boards::console::cli::{Refused, complain, say};
use boards::console::progress::Progress;
use boards::host::Show;
use boards::link::Port;
use boards::out_file::OutFile;
use boards::pico::PicoMachine;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::toolchain;
use boards::{Board, PICO};

const DEFAULT_SECONDS: f64 = 10.0;
const NO_TERMINAL: &str = "no terminal: running headless; --record FILE.gif or --screenshot \
                           FILE.png saves what the panel shows";
/// The time limit of an emulated board: a constant part, and a part for each second of its time.
const LIMIT: [f64; 2] = [60.0, 20.0];

/// Draws an animation of a scene as a Pico with this panel shows it, by the host's own code.
pub fn animate(
    scene: SceneName,
    panel: PanelName,
    seconds: u32,
    scale: usize,
    file: OutFile,
) -> anyhow::Result<()> {
    let format = panel.format();
    let mut recording = Recording::begin(file, format, scale)?;
    let mut show = Show::in_format(format, CORTEX_M0PLUS, scene, &scene.first_settings())
        .map_err(|error| anyhow::anyhow!("{}: {error}", scene.name()))?;
    for tick in 0..i64::from(seconds * TICK_RATE) {
        show.tick();
        if recording.is_due(tick) {
            recording.add(&show.frame(), tick)?;
        }
    }
    recording.finish().map(drop)
}

/// Shows the board in the terminal, or runs it without one, and prints a summary. Returns true if
/// no compared bit differs from the host's and if, on an emulated board that is run frame by frame,
/// nothing else went wrong. Without a terminal, a frame must have been compared.
pub fn run(options: &DemoOptions) -> anyhow::Result<bool> {
    let is_dumb = env::var_os("TERM").is_some_and(|name| name == "dumb");
    let is_terminal = stdout().is_terminal() && stdin().is_terminal() && !is_dumb;
    let is_live = !options.headless && is_terminal;
    options.check()?;
    let [record, screenshot] = [
        ("--record", &options.record),
        ("--screenshot", &options.screenshot),
    ]
    .map(|(option, path)| path.as_deref().map(|path| OutFile::create(option, path)));
    let record = record.transpose()?;
    let screenshot = screenshot.transpose()?;
    let seconds = options.seconds.unwrap_or(if is_live {
        f64::INFINITY
    } else {
        DEFAULT_SECONDS
    });
    let source = match &options.port {
        Some(name) => Source::Port(port(name)?),
        None => emulated(&options.board(), seconds, is_live)?,
    };

    let format = options.board().panel.format();
    let recording = record.map(|file| Recording::begin(file, format, options.scale()));
    let recording = recording.transpose()?;
    if !is_live && !options.headless {
        complain(NO_TERMINAL);
    }

    let mut session = Session::new(options, source, recording);
    if is_live {
        live::watch(&mut session, seconds)?
    } else {
        headless(&mut session, seconds)?
    }
    finish(options, session, screenshot, is_live)
}

pub fn port(name: &str) -> Result<Port, Refused> {
    Port::open(name).map_err(|reason| Refused::because(format_args!("--port {reason}")))
}

fn emulated(board: &Board, seconds: f64, is_live: bool) -> anyhow::Result<Source> {
    let (toolchain, elf) = toolchain::set_up_and_build(board)?;
    let limit = Duration::from_secs_f64(LIMIT[0] + LIMIT[1] * seconds.min(MOST_SECONDS));

    if board.binary == PICO.binary {
        let emulator = toolchain::set_up_pico()?;
        return Ok(Source::Pico(Box::new(PicoMachine::start(
            &emulator,
            &elf,
            board.panel,
            limit,
        )?)));
    }
    let settings = MachineSettings {
        qemu: &toolchain.qemu,
        board,
        elf: &elf,
        debugger: true,
        clock: Clock::Real,
        limit,
    };
    if is_live {
        Machine::start(&settings).map(Source::Live)
    } else {
        Machine::halted(&settings).map(Source::Lockstep)
    }
}

const LOOK: Duration = Duration::from_millis(4);
const PATIENCE: Duration = Duration::from_secs(10);

/// The time to wait for an answer to the last question of the comparison, by the board's clock, s.
const ANSWER: f64 = 3.0;

fn headless(session: &mut Session, seconds: f64) -> anyhow::Result<()> {
    let name = session.name().to_owned();
    let progress = Progress::start(&format!("running {name} for {seconds} s of its time"));
    let mut reached = 0.0;
    let mut since = Instant::now();
    let is_over = |session: &Session| {
        let is_settled =
            session.readings.comparison.is_settled() || session.seconds() > seconds + ANSWER;
        session.seconds() >= seconds && is_settled
    };

    while !is_over(session) {
        session.hear()?;
        if session.is_recording_due() {
            session.look()?;
        }

        if session.source.is_port() {
            session
                .readings
                .lines
                .drain(..)
                .for_each(|line| complain(line.text));
            if session.seconds() > reached {
                reached = session.seconds();
                since = Instant::now();
            }
            ensure!(
                since.elapsed() < PATIENCE,
                "{name}: no frame for {} s; is the board powered and connected?",
                PATIENCE.as_secs()
            );
            sleep(LOOK);
        }
        progress.alive(None);
    }

    session.look()
}

const NOT_COMPARED: &str = "no frame was compared: the host computes the scene from its start, and \
                            has not reached the board's frames; choose a --scene, which starts it \
                            again, or a longer --seconds";

/// Completes the files and prints the summary. A board with a real clock may drop frames, and a
/// cable may corrupt bits: neither is a fault.
fn finish(
    options: &DemoOptions,
    mut session: Session,
    screenshot: Option<OutFile>,
    is_live: bool,
) -> anyhow::Result<bool> {
    let is_silent = session.readings.frame.is_none();
    ensure!(
        !is_silent,
        "{}: ended before the first frame",
        session.name()
    );

    let saved = save_files(options, &mut session, screenshot)?;
    session
        .readings
        .lines
        .extend(session.source.log_and_counts().0);
    let (
        name,
        Session {
            readings, source, ..
        },
    ) = (session.name(), &session);

    let is_repeatable = matches!(source, Source::Lockstep(_) | Source::Pico(_));
    let mut faults = if is_repeatable {
        readings.faults()
    } else {
        Vec::new()
    };
    faults.extend(readings.comparison.difference().map(str::to_owned));
    // In a terminal the user sees that the host has not caught up.
    if !is_live && readings.comparison.is_void() {
        faults.push(NOT_COMPARED.to_owned());
    }
    faults
        .iter()
        .for_each(|fault| complain(format_args!("problem: {fault}")));
    let said = say(format_args!(
        "board                 {name}\n{}{saved}",
        readings.report()
    ));

    // A fault is reported even if the reader of the summary has stopped.
    if faults.is_empty() {
        said?;
    }
    Ok(faults.is_empty())
}

fn save_files(
    options: &DemoOptions,
    session: &mut Session,
    screenshot: Option<OutFile>,
) -> anyhow::Result<String> {
    let source = if session.has_panel() {
        ""
    } else {
        ", the panel redrawn here from the board's numbers"
    };

    let mut saved = String::new();
    if let Some(recording) = session.take_recording() {
        let (path, pictures) = recording.finish()?;
        saved += &format!(
            "\nsaved                 {}, {pictures} pictures{source}",
            path.display()
        );
    }
    if let Some(file) = screenshot {
        saved += &format!("\nsaved                 {}{source}", file.path().display());
        file.write_whole(&png(&session.screenshot, options.scale())?)?;
    }
    Ok(saved)
}
