//! `cargo setup`: brings what the firmware needs, and says what was found and what was done.

use crate::console::cli::say;
use crate::emulator::toolchain;
use clap::Parser;

/// Finds or brings all that builds and runs the firmware: the ARM core library, QEMU, and rp2040js for the Pico.
#[derive(Debug, Parser)]
#[command(name = "cargo setup")]
pub struct SetupOptions {}

pub fn run(_: &SetupOptions) -> anyhow::Result<()> {
    let (toolchain, mut done) = toolchain::set_up()?;
    say(toolchain)?;
    let (emulator, more) = toolchain::set_up_pico()?;
    say(emulator)?;
    done.extend(more);
    if done.is_empty() {
        say("nothing had to be done")?;
    }
    Ok(done.iter().try_for_each(|step| say(format_args!("done: {step}")))?)
}
