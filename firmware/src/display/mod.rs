//! Panels: they take a finished frame, and only that can fail. Those on I2C look alike, but may have different controllers.

use core::convert::Infallible;

use crate::graphics::Canvas;

#[cfg(feature = "colour-panel")]
mod any_panel;
mod bus;
mod ssd0323;
mod ssd1306;

#[cfg(feature = "colour-panel")]
pub use any_panel::AnyPanel;
pub use bus::{OutByte, Outbox, PanelBus, SILENCE, Sent, free_bus};
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Controller {
    /// Most panels of 0.96 inches have it; the SSD1309 takes the same commands.
    Ssd1306,
    /// Most panels of 1.3 inches have it.
    Sh1106,
    /// Of square panels: not driven.
    Sh1107,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// By the status byte, which the panel was asked for.
    Status(u8),
    /// The panel does not tell: it is taken for what most are.
    Silence,
    /// The program was built for it, with `PANEL=ssd1306` or `PANEL=sh1106`; the panel was not asked.
    Build,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    pub controller: Controller,
    pub by: By,
}

impl Found {
    pub const SILENT: Self = Self {
        controller: Controller::Ssd1306,
        by: By::Silence,
    };

    /// A panel of this status: what the lower half says, for the upper one says whether it is on.
    ///
    /// Source: the rule of L. Bank's OLED libraries (`ss_oled`); no data sheet promises it.
    pub fn told(status: u8) -> Self {
        let controller = match status & 0x0F {
            0x08 => Controller::Sh1106,
            0x07 | 0x0F => Controller::Sh1107,
            _ => Controller::Ssd1306, // 3 or 6, and who knows what of an imitation
        };
        Self {
            controller,
            by: By::Status(status),
        }
    }
}

/// The controller that the build variable `PANEL` names; it overrides the status byte.
pub const BUILT_FOR: Option<Controller> = match option_env!("PANEL") {
    None => None,
    Some(name) => match name.as_bytes() {
        b"ssd1306" => Some(Controller::Ssd1306),
        b"sh1106" => Some(Controller::Sh1106),
        _ => panic!("PANEL is neither ssd1306 nor sh1106"),
    },
};
