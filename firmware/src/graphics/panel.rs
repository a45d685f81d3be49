//! The panels that a board can be built for.

use crate::graphics::Format;

choice! {
    /// A panel, as `--panel` names it.
    PanelName {
        /// An OLED of 128 x 64 pixels in one colour.
        Oled = "oled";
        /// Waveshare Pico-LCD-1.3.
        Lcd13 = "lcd-1.3";
        /// Waveshare Pico-LCD-2.
        Lcd2 = "lcd-2";
        /// Pimoroni Pico Display Pack 2.0 or 2.8.
        Display2 = "display-2";
        /// Pimoroni Pico Display Pack (1.14 inches).
        Display = "display";
    }
}

impl PanelName {
    /// Returns the panel with this name; `None` if no panel has it.
    pub const fn named(name: &str) -> Option<Self> {
        match name.as_bytes() {
            b"oled" => Some(Self::Oled),
            b"lcd-1.3" => Some(Self::Lcd13),
            b"lcd-2" => Some(Self::Lcd2),
            b"display-2" => Some(Self::Display2),
            b"display" => Some(Self::Display),
            _ => None,
        }
    }

    /// Returns the place of the panel's top left pixel in the memory of its controller.
    pub const fn offset(self) -> (usize, usize) {
        match self {
            Self::Display => (40, 53),
            _ => (0, 0),
        }
    }

    /// Returns the format of the panel.
    pub const fn format(self) -> Format {
        match self {
            Self::Oled => Format::OLED,
            Self::Lcd13 => Format::new(240, 240, 2),
            Self::Lcd2 | Self::Display2 => Format::new(320, 240, 2),
            Self::Display => Format::new(240, 135, 2),
        }
    }

    /// Returns the name under which the panel is sold, and its size.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Oled => "OLED, 128 x 64",
            Self::Lcd13 => "Waveshare Pico-LCD-1.3, 240 x 240",
            Self::Lcd2 => "Waveshare Pico-LCD-2, 320 x 240",
            Self::Display2 => "Pimoroni Pico Display Pack 2.0 or 2.8, 320 x 240",
            Self::Display => "Pimoroni Pico Display Pack, 240 x 135",
        }
    }
}

/// The panel that the build variable `PANEL` names. It is an OLED without the variable, and also if
/// that names a controller of an OLED.
pub const PANEL: PanelName = match option_env!("PANEL") {
    None => PanelName::Oled,
    Some(name) => match PanelName::named(name) {
        None => PanelName::Oled,
        Some(panel) => panel,
    },
};
