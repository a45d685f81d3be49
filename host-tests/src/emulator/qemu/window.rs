//! QEMU's own window, where one can be had.

use std::env;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use crate::emulator::process::{self, ProcessError};

/// How long QEMU may take to list its displays.
const LIMIT: Duration = Duration::from_secs(10);

/// A kind of window that this QEMU can open here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window(&'static str);

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum NoWindow {
    /// Nothing to show it on.
    #[error("no window: neither DISPLAY nor WAYLAND_DISPLAY is set; the terminal view works without (omit --window)")]
    NoDesktop,
    /// QEMU was built without, or its package is missing.
    #[error("no window: this QEMU has neither gtk nor sdl (Debian: apt-get install qemu-system-gui)")]
    NotBuiltIn,
    /// QEMU could not be asked.
    #[error(transparent)]
    Process(#[from] ProcessError),
}

impl Window {
    /// The window that can be had.
    pub fn find(qemu: &Path) -> Result<Self, NoWindow> {
        if ["DISPLAY", "WAYLAND_DISPLAY"].iter().all(|name| env::var_os(name).is_none_or(|value| value.is_empty())) {
            return Err(NoWindow::NoDesktop);
        }
        let listed = process::run(Command::new(qemu).args(["-display", "help"]), LIMIT)?.stdout;
        let kind = ["gtk", "sdl"].into_iter().find(|kind| listed.lines().any(|line| line.trim() == *kind));
        kind.map(Self).ok_or(NoWindow::NotBuiltIn)
    }

    /// QEMU's name for it.
    pub(super) fn name(self) -> &'static str {
        self.0
    }
}
