//! The boards and the link to them: emulated boards, the host in the place of a board, the serial
//! link, and the tools that build and run the firmware.

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod boards;
pub mod budgets;
pub mod flash;
#[cfg(feature = "boards")]
pub mod host;
pub mod link;
pub mod out_file;
#[cfg(feature = "boards")]
pub mod pico;
pub mod process;
#[cfg(feature = "boards")]
pub mod qemu;
pub mod scratch;
pub mod stream;
pub mod toolchain;

#[cfg(feature = "boards")]
use {anyhow::bail, firmware::protocol::ToHost};

#[cfg(feature = "boards")]
fn up_to_frame(
    often: u32,
    mut next: impl FnMut() -> anyhow::Result<Vec<ToHost>>,
) -> anyhow::Result<Vec<ToHost>> {
    let mut messages = Vec::new();
    for _ in 0..often {
        let new = next()?;
        let is_last = new.iter().any(|message| message.frame().is_some());
        messages.extend(new);
        if is_last {
            return Ok(messages);
        }
    }
    bail!("the board sends no frames")
}
