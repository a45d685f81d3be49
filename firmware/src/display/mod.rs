//! Panels: they take a finished frame, and only that can fail.

use core::convert::Infallible;

use crate::graphics::Canvas;

#[cfg(feature = "colour-panel")]
mod any_panel;
mod controller;
mod i2c_recovery;
mod outbox;
mod ssd0323;
mod ssd1306;

#[cfg(feature = "colour-panel")]
pub use any_panel::AnyPanel;
pub use controller::{BUILT_FOR, By, Controller, Found};
pub use i2c_recovery::{Lines, free_bus};
pub use outbox::{OutByte, Outbox, PanelBus, Sent};
pub use ssd0323::Ssd0323;
pub use ssd1306::{Ssd1306, Ssd1306Error};

pub trait Display {
    type Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Self::Error>;

    /// Which panel was found since this was last asked.
    fn found(&mut self) -> Option<Found> {
        None
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct NoDisplay;

impl Display for NoDisplay {
    type Error = Infallible;

    fn flush(&mut self, _: &Canvas) -> Result<(), Infallible> {
        Ok(())
    }
}
