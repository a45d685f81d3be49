//! Any panel that has a driver for [`embedded-graphics`](https://docs.rs/embedded-graphics): the whole frame, in its own colours.
//!
//! Such a driver keeps the processor busy until a frame is sent; those of this folder send what has changed.

use embedded_graphics_core::draw_target::DrawTarget;
use embedded_graphics_core::geometry::{Point, Size};
use embedded_graphics_core::pixelcolor::{Gray4, PixelColor};
use embedded_graphics_core::primitives::Rectangle;

use super::Display;
use crate::graphics::{Canvas, HEIGHT, WIDTH};

/// A driver's panel, where on it the frame's upper left corner is, and the colour of each grey: its own `from`, or another.
#[derive(Clone, Copy, Debug)]
pub struct AnyPanel<Target, Color> {
    pub target: Target,
    pub corner: Point,
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
