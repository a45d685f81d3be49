//! `cargo demo`: the double pendulum on the emulated panel, live in the terminal or recorded without one.

mod headless;
mod live;
mod options;
mod panel;
mod play;
mod plot;
mod readings;
pub(crate) mod record;
mod summary;
mod taps;
mod tint;
mod view;

pub use options::Options;
pub use play::played;
pub use taps::Taps;

use std::io::{IsTerminal, stdin, stdout};
use std::path::PathBuf;

use record::Recording;

use crate::console::cli::Refused;
use crate::emulator::qemu::{QemuError, Window};
use crate::emulator::toolchain::{self, Toolchain};

/// All that a run needs, ready.
struct Stage<'a> {
    options: &'a Options,
    toolchain: Toolchain,
    elf: PathBuf,
    window: Option<Window>,
}

/// Sets everything up and runs the demonstration; whether all was well.
pub fn run(options: &Options) -> anyhow::Result<bool> {
    let (toolchain, _) = toolchain::set_up().map_err(Refused::because)?;
    let window = options.window.then(|| Window::find(toolchain.qemu())).transpose();
    let window = window.map_err(|error| Refused::because(format_args!("--window: {error}")))?;
    let elf = toolchain.build_for(options.board)?;
    let recording = options.record.as_deref().map(Recording::create).transpose();
    let recording = recording.map_err(|error| Refused::because(format_args!("--record: {error:#}")))?;
    let stage = Stage { options, toolchain, elf, window };
    let on_terminal = stdout().is_terminal() && stdin().is_terminal();
    let run = if options.headless || !on_terminal { headless::run } else { live::run };
    run(&stage, recording)
}

/// What went wrong, as the demonstration says it.
fn broken(error: QemuError) -> anyhow::Error {
    anyhow::Error::msg(error.to_string())
}
