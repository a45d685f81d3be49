//! What can go wrong between the host and an emulated board.

use std::io;
use std::path::PathBuf;

use crate::emulator::process::ProcessError;

#[derive(Debug, thiserror::Error)]
pub enum QemuError {
    /// QEMU did not start, or its time limit passed.
    #[error(transparent)]
    Process(#[from] ProcessError),
    #[error("QEMU ended ({how}){said}")]
    Ended {
        how: String,
        /// The last of what it and the firmware said, after a colon; empty if nothing.
        said: String,
    },
    #[error("the connection to QEMU's {name} broke: {source}")]
    Connection { name: &'static str, source: io::Error },
    #[error("QEMU refuses {command}: {reason}")]
    Refused { command: &'static str, reason: String },
    #[error("the screenshot of the panel is not usable: {0}")]
    Screenshot(&'static str),
    /// The firmware's file cannot be read or has no usable log table.
    #[error("{}: {reason}", path.display())]
    Firmware { path: PathBuf, reason: String },
    #[error("the board sends no frames")]
    NoFrame,
}

impl QemuError {
    /// For `map_err` on the connection called `name`.
    pub(super) fn connection(name: &'static str) -> impl Fn(io::Error) -> Self {
        move |source| Self::Connection { name, source }
    }
}
