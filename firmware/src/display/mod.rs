//! Panel drivers. A panel takes a finished frame; only that can fail. Panels on I2C look alike, but
//! may have different controllers.
//!
//! To add a controller of the family SSD1306:
//!
//! 1. Add a variant of [`Controller`], the last one, because its place is its number on the link,
//!    and its name in `Controller::named`. The compiler asks for a `Profile` in `oled_i2c.rs`. If
//!    reading the memory back identifies it, add it to `with_memory` there.
//! 2. In `host-tests/tests/firmware/oled_i2c/`, add a `Kind` in the model of a module, `bus.rs`,
//!    with the answers of the data sheet, and a row of `MODULES` in `mod.rs`. Then `cargo test -p
//!    host-tests --test firmware -- oled_i2c:: link::`, with `BLESS=1` for its number.
//!
//! A controller of another family implements [`Display`], as `ssd0323.rs` does with the test of that
//! name, and is the type `Panel` in the `mod.rs` of its board. On a Pico it also needs a
//! [`PanelName`], and its wires in `board/pico/lcd.rs`.

use core::convert::Infallible;

use embedded_hal::i2c::ErrorKind;
use serde::{Deserialize, Serialize};

use crate::graphics::{Canvas, PanelName};

mod bus;
mod oled_i2c;
mod ssd0323;
mod st7789;

pub use bus::{OutByte, Outbox, PanelBus, SILENCE, Sent, free_bus};
pub use oled_i2c::{OledError, OledI2c};
pub use ssd0323::{Memory, Ssd0323};
pub use st7789::{PixelBus, St7789};

/// The driver of a panel. It takes a frame in each tick.
pub trait Display {
    /// The reason why a frame does not reach the panel.
    type Error;

    /// Sends a frame to the panel, or prepares its transfer.
    ///
    /// Returns an error if this frame has failed, or if the panel at present does not show the
    /// frames, or not all of them. The next frame may be sent all the same.
    fn flush(&mut self, canvas: &Canvas) -> Result<(), Self::Error>;

    /// Sends the last frame, which is the canvas, if it is still waiting for the bus. It is called
    /// in the time left until the next frame. Returns true while the frame waits; false if none
    /// does, as by default. An error is returned by a later [`flush`](Self::flush).
    fn catch_up(&mut self, _: &Canvas) -> bool {
        false
    }

    /// Returns the panel that was found since the last call, the last of several; `None` if none
    /// was, or if the driver does not search.
    fn found(&mut self) -> Option<Found> {
        None
    }

    /// Returns the state of the panel for the host. The default is [`PanelState::Unknown`].
    fn report(&self) -> PanelReport {
        PanelReport::default()
    }

    /// Drives the panel as chosen, from the next frame on. Returns false, and does nothing, if the
    /// panel has no such options, as by default. With a wrong controller the picture may be wrong.
    fn choose(&mut self, _: PanelOptions) -> bool {
        false
    }

    /// Dims the panel, or makes it bright, from the next frame on. A panel that cannot be dimmed
    /// stays as it is.
    fn dim(&mut self, _: bool) {}
}

/// The panel of a board without one: it accepts every frame and shows nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoDisplay;

impl Display for NoDisplay {
    type Error = Infallible;

    fn flush(&mut self, _: &Canvas) -> Result<(), Infallible> {
        Ok(())
    }
}

choice! {
    /// The controller of a one-colour OLED panel on I2C.
    Controller {
        /// The controller of most panels of 0.96 inches. The SSD1309 takes the same commands.
        Ssd1306 = "ssd1306";
        /// The controller of most panels of 1.3 inches.
        Sh1106 = "sh1106";
        /// The controller of panels of 128 x 128 and 64 x 128. The driver assumes 128 x 128.
        Sh1107 = "sh1107";
    }
}

choice! {
    /// The method of identifying a controller.
    By {
        /// The panel returned the bytes that were written into its memory (SH1106, SH1107), or
        /// other bytes (SSD1306).
        Memory = "by reading its memory back";
        /// The panel acknowledges no read and is taken for the most common controller.
        Silence = "assumed, because it answers no read";
        /// The host, or the build variable `PANEL`, named the controller.
        Choice = "as chosen";
    }
}

choice! {
    /// An error of the bus that makes a panel absent.
    BusFault {
        /// No panel acknowledges at either address, or the panel acknowledges no longer.
        NoAnswer = "no answer at 0x3C and 0x3D";
        /// Another device drove the data line, so that the bus lost its arbitration.
        Disturbed = "the data line was driven by another device";
        /// A transfer did not end, or failed in any other way.
        Stuck = "the bus hangs";
    }
}

impl From<ErrorKind> for BusFault {
    fn from(error: ErrorKind) -> Self {
        match error {
            ErrorKind::NoAcknowledge(_) => Self::NoAnswer,
            ErrorKind::ArbitrationLoss => Self::Disturbed,
            _ => Self::Stuck,
        }
    }
}

/// A panel that answers, and how its controller is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Found {
    /// The controller that the driver drives it as.
    pub controller: Controller,
    /// The way in which the controller was identified.
    pub by: By,
    /// The status byte, read with the display off, so that bit 6 should be 1; `None` if the panel
    /// acknowledges no read.
    pub status: Option<u8>,
}

/// The state of the search for a panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PanelState {
    /// The board has no panel, or a panel that cannot be read.
    #[default]
    Unknown,
    /// The board looks for a panel, identifies it or sends the first picture.
    Starting,
    /// The bus failed with this error; the panel is tried again once a second.
    Absent(BusFault),
    /// The panel shows the frames, or as many as the bus carries ([`PanelReport::shown`]).
    Shown(Found),
}

/// The choices of the user for a panel. They outlast every reset that leaves memory powered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PanelOptions {
    /// The controller, chosen by a command or by [`BUILT_FOR`]; `None` identifies it.
    pub controller: Option<Controller>,
    /// The picture is turned by 180 degrees.
    pub is_turned: bool,
    /// The panel is not dimmed without keys.
    pub stays_bright: bool,
}

/// The state of the panel for the host.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PanelReport {
    /// The panel that the program was built for.
    pub name: PanelName,
    /// The state of the search.
    pub state: PanelState,
    /// The choices of the user.
    pub chosen: PanelOptions,
    /// The number of frames of the last whole second that were sent to the panel. A frame without a
    /// change counts as sent. It is 0 until the panel has taken frames for a second, and if the
    /// driver does not count them.
    pub shown: u8,
}

impl Controller {
    /// Returns the controller with this [`name`](Self::name); `None` if no controller has it.
    pub const fn named(name: &str) -> Option<Self> {
        match name.as_bytes() {
            b"ssd1306" => Some(Self::Ssd1306),
            b"sh1106" => Some(Self::Sh1106),
            b"sh1107" => Some(Self::Sh1107),
            _ => None,
        }
    }
}

/// The controller that the build variable `PANEL` names: `ssd1306`, also for an SSD1309, `sh1106`
/// or `sh1107`. It is `None` without the variable, and then the controller is identified. The
/// host's choice has precedence, also after a reset that leaves memory powered, unless a program
/// with another value made it.
pub const BUILT_FOR: Option<Controller> = match option_env!("PANEL") {
    None => None,
    Some(name) => match (Controller::named(name), PanelName::named(name)) {
        (None, None) => panic!("PANEL names neither a panel nor a controller"),
        (controller, _) => controller,
    },
};
