//! Any panel with a driver for [`embedded-graphics`](https://docs.rs/embedded-graphics). The whole
//! frame is drawn in the panel's own colours.
//!
//! Such a driver occupies the processor until a frame is sent. The other drivers of this module
//! send only the changes.

use embedded_graphics_core::draw_target::DrawTarget;
use embedded_graphics_core::geometry::{Point, Size};
use embedded_graphics_core::pixelcolor::{Gray4, PixelColor};
use embedded_graphics_core::primitives::Rectangle;

use super::Display;
use crate::graphics::{Canvas, HEIGHT, WIDTH};

/// The panel of a driver, the position of the frame's upper left corner on it, and the colour of
/// each grey. The colour can be the panel's own `from`, or any other function.
///
/// Each frame of 128 x 64 pixels is sent whole, row by row, and blocks for a time that depends on
/// the driver. The driver must have set the panel up before the first frame, and must ignore pixels
/// outside the panel. The error of a frame is the driver's own; the next frame is not affected.
#[derive(Clone, Copy, Debug)]
pub struct AnyPanel<Target, Color> {
    /// The driver.
    pub target: Target,
    /// The upper left corner of the frame on the panel, pixels.
    pub corner: Point,
    /// The colour of each grey from 0, black, to 15.
    pub colour: fn(Gray4) -> Color,
}

impl<Color: PixelColor, Target: DrawTarget<Color = Color>> Display for AnyPanel<Target, Color> {
    type Error = Target::Error;

    fn flush(&mut self, canvas: &Canvas) -> Result<(), Target::Error> {
        let area = Rectangle::new(self.corner, Size::new(WIDTH as u32, HEIGHT as u32));
        let greys = canvas
            .bytes()
            .flat_map(|pair| [pair >> 4, pair & 0x0F].map(Gray4::new));
        self.target.fill_contiguous(&area, greys.map(self.colour))
    }
}
