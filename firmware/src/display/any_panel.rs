//! Any panel that has a driver for [`embedded-graphics`](https://docs.rs/embedded-graphics): the whole frame, in its own colours.
//!
//! Such a driver keeps the processor busy until a frame is sent; those of this folder send what has changed.

use embedded_graphics_core::draw_target::DrawTarget;
use embedded_graphics_core::geometry::{Point, Size};
use embedded_graphics_core::pixelcolor::{BinaryColor, Gray4, PixelColor, Rgb565};
use embedded_graphics_core::primitives::Rectangle;

use super::Display;
use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// A driver's panel, where on it the frame's upper left corner is, and the colour of each grey from 0 to 15.
#[derive(Clone, Copy, Debug)]
pub struct AnyPanel<Target, Color> {
    /// The driver.
    pub target: Target,
    /// The corner.
    pub corner: Point,
    /// The map of colours.
    pub colour: fn(u8) -> Color,
}

impl<Color: PixelColor, Target: DrawTarget<Color = Color>> Display for AnyPanel<Target, Color> {
    type Error = Target::Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Target::Error> {
        let area = Rectangle::new(self.corner, Size::new(WIDTH as u32, HEIGHT as u32));
        let greys = canvas.bytes().flat_map(|pair| [pair >> 4, pair & 0x0F]);
        self.target.fill_contiguous(&area, greys.map(self.colour))
    }
}

/// White at grey 15.
pub fn rgb565(grey: u8) -> Rgb565 {
    Rgb565::new(grey << 1 | grey >> 3, grey << 2 | grey >> 2, grey << 1 | grey >> 3)
}

/// The same greys.
pub fn gray4(grey: u8) -> Gray4 {
    Gray4::new(grey)
}

/// On in the upper half of the greys.
pub fn binary(grey: u8) -> BinaryColor {
    (grey > 7).into()
}
