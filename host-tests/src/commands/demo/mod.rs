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

use crate::emulator::qemu::{QemuError, Window};
use crate::emulator::toolchain::{self, Toolchain};

/// Why the demonstration could not even begin.
#[derive(Debug)]
pub struct Unavailable(String);

impl std::fmt::Display for Unavailable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Unavailable {
    fn because(reason: impl ToString) -> Self {
        Self(reason.to_string())
    }
}

/// All that a run needs, ready.
struct Stage<'a> {
    options: &'a Options,
    toolchain: Toolchain,
    elf: PathBuf,
    window: Option<Window>,
}

/// Sets everything up and runs the demonstration; whether all was well.
pub fn run(options: &Options) -> Result<anyhow::Result<bool>, Unavailable> {
    let (toolchain, _) = toolchain::set_up().map_err(Unavailable::because)?;
    let window = options.window.then(|| Window::find(toolchain.qemu())).transpose();
    let window = window.map_err(|error| Unavailable(format!("error: --window: {error}")))?;
    let elf = toolchain.build_for(options.board).map_err(Unavailable::because)?;
    let recording = options.record.as_deref().map(Recording::create).transpose();
    let recording = recording.map_err(|error| Unavailable(format!("error: --record: {error:#}")))?;
    let stage = Stage { options, toolchain, elf, window };
    let on_terminal = stdout().is_terminal() && stdin().is_terminal();
    let run = if options.headless || !on_terminal { headless::run } else { live::run };
    Ok(run(&stage, recording))
}

/// What went wrong, as the demonstration says it.
fn broken(error: QemuError) -> anyhow::Error {
    anyhow::Error::msg(error.to_string())
}
