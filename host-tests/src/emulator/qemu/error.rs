//! What can go wrong between the host and an emulated board.

use std::io;
use std::path::PathBuf;

use crate::emulator::process::ProcessError;

/// Why an emulated board could not be used.
#[derive(Debug, thiserror::Error)]
pub enum QemuError {
    /// QEMU did not start, or its time limit passed.
    #[error(transparent)]
    Process(#[from] ProcessError),
    /// QEMU ended although it was still needed.
    #[error("QEMU ended ({how}){said}")]
    Ended {
        /// Its exit status.
        how: String,
        /// The last of what it and the firmware said, after a colon; empty if nothing.
        said: String,
    },
    /// A connection to QEMU broke.
    #[error("the connection to QEMU's {name} broke: {source}")]
    Connection {
        /// Which one.
        name: &'static str,
        /// The system's reason.
        source: io::Error,
    },
    /// QEMU refused a command.
    #[error("QEMU refuses {command}: {reason}")]
    Refused {
        /// The command.
        command: &'static str,
        /// QEMU's words.
        reason: String,
    },
    /// The panel's screenshot is not what the panel of this board looks like.
    #[error("the screenshot of the panel is not usable: {0}")]
    Screenshot(&'static str),
    /// The firmware's file cannot be read or has no usable log table.
    #[error("{}: {reason}", path.display())]
    Firmware {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The board sleeps and sleeps and sends nothing.
    #[error("the board sends no frames")]
    NoFrame,
}

impl QemuError {
    /// For `map_err` on the connection called `name`.
    pub(super) fn connection(name: &'static str) -> impl Fn(io::Error) -> Self {
        move |source| Self::Connection { name, source }
    }
}
