//! Panels: they take a finished frame, and only that can fail.

use core::convert::Infallible;

use crate::graphics::canvas::Canvas;

#[cfg(feature = "colour-panel")]
mod any_panel;
pub mod controller;
pub mod i2c_recovery;
pub mod outbox;
mod ssd0323;
mod ssd1306;

#[cfg(feature = "colour-panel")]
pub use any_panel::{AnyPanel, binary, gray4, rgb565};
pub use ssd0323::{PanelError, Ssd0323};
pub use ssd1306::{Ssd1306, Ssd1306Error};

/// A panel.
pub trait Display {
    /// Why a frame did not reach the panel.
    type Error;

    /// Sends the frame.
    fn flush(&mut self, canvas: &Canvas) -> Result<(), Self::Error>;

    /// Which panel was found since this was last asked.
    fn found(&mut self) -> Option<controller::Found> {
        None
    }
}

/// For a board without a panel.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoDisplay;

impl Display for NoDisplay {
    type Error = Infallible;

    fn flush(&mut self, _: &Canvas) -> Result<(), Infallible> {
        Ok(())
    }
}
