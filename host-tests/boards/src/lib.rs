//! The boards and the link to them: emulated boards, the host in the place of a board, the serial
//! link, and the tools that build the firmware and transfer it. Also the [`console`] interface of all
//! commands.

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

mod board;
pub mod budgets;
pub mod console;
pub mod flash;
#[cfg(feature = "emulated")]
pub mod host;
pub mod link;
pub mod out_file;
#[cfg(feature = "emulated")]
pub mod pico;
pub mod process;
#[cfg(feature = "emulated")]
pub mod qemu;
pub mod scratch;
pub mod stream;
pub mod toolchain;

pub use board::{
    BOARDS, Board, LM3S6965EVB, LM3S6965EVB_M4, PICO, STM32F405, every_board, pico_with,
};

#[cfg(feature = "emulated")]
use {anyhow::bail, firmware::protocol::ToHost};

#[cfg(feature = "emulated")]
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
