//! The frame: 128 x 64 pixels of 16 greys, in the layout the panel itself uses.

use core::convert::Infallible;

use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Size};
use embedded_graphics::pixelcolor::{Gray4, GrayColor};

/// Pixels across.
pub const WIDTH: usize = 128;
/// Pixels down.
pub const HEIGHT: usize = 64;
/// Bytes of the frame: two pixels each.
pub const BYTES: usize = WIDTH / 2 * HEIGHT;

/// A framebuffer. Drawing cannot fail: what lies outside is not drawn.
///
/// Rows from the top, within a row from the left; of the two pixels in a byte the high nibble is the left one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Canvas {
    bytes: [u8; BYTES],
}

impl Default for Canvas {
    fn default() -> Self {
        Self::BLACK
    }
}

impl Canvas {
    /// Every pixel black.
    pub const BLACK: Self = Self { bytes: [0; BYTES] };

    /// Makes every pixel black.
    pub fn clear(&mut self) {
        self.bytes.fill(0);
    }

    /// The bytes as the panel takes them.
    pub fn bytes(&self) -> &[u8; BYTES] {
        &self.bytes
    }

    /// The pixels of a row from the left, two in a byte; none outside.
    pub fn row_mut(&mut self, y: usize) -> &mut [u8] {
        const ROW: usize = WIDTH / 2;
        self.bytes.chunks_exact_mut(ROW).nth(y).unwrap_or_default()
    }

    /// The grey of a pixel, 0 to 15; `None` outside.
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        let byte = self.bytes.get(index(x, y)?)?;
        Some((byte >> shift(x)) & 0x0F)
    }

    /// Replaces the grey of a pixel by a function of it; of the result only the low four bits count.
    #[inline]
    pub fn update(&mut self, x: i32, y: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(byte) = index(x, y).and_then(|index| self.bytes.get_mut(index)) {
            let shift = shift(x);
            let old = (*byte >> shift) & 0x0F;
            *byte = (*byte & !(0x0F << shift)) | ((new(old) & 0x0F) << shift);
        }
    }
}

/// The byte that holds a pixel; `None` outside the frame.
#[inline]
fn index(x: i32, y: i32) -> Option<usize> {
    let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
    (x < WIDTH && y < HEIGHT).then_some(y * (WIDTH / 2) + x / 2)
}

/// How far left in its byte a pixel's nibble lies.
#[inline]
fn shift(x: i32) -> u32 {
    if x & 1 == 0 { 4 } else { 0 }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(WIDTH as u32, HEIGHT as u32)
    }
}

impl DrawTarget for Canvas {
    type Color = Gray4;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Gray4>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(point, grey) in pixels {
            self.update(point.x, point.y, |_| grey.luma());
        }
        Ok(())
    }
}
