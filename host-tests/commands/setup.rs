//! `cargo setup`: fetches the tools.

use clap::Parser;

use boards::console::cli::say;
use boards::toolchain;

/// Finds or fetches everything that builds and runs the firmware: Rust's core library, QEMU, and
/// Node.js with rp2040js for the Pico.
#[derive(Debug, Parser)]
#[command(
    name = "cargo setup",
    after_help = "Everything goes into target, host-tests/boards/rp2040 and rustup's own folder. Nothing is
installed on the system."
)]
pub struct SetupOptions {}

pub fn run(_: &SetupOptions) -> anyhow::Result<()> {
    let is_ready = toolchain::ready().is_ok() && toolchain::ready_for_pico().is_ok();
    say(toolchain::set_up()?)?;
    say(format_args!(
        "Raspberry Pi Pico: rp2040js under {}",
        toolchain::set_up_pico()?.display()
    ))?;
    if is_ready {
        say("everything was ready")?;
    }
    Ok(())
}
