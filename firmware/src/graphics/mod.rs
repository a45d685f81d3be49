//! Drawing: a canvas of grey pixels, and the tools that draw on it.

mod bitmap;
mod brush;
mod canvas;
pub mod label;
pub mod plot;
pub mod text;
mod view;

pub use bitmap::{Bitmap, PAGES};
pub use brush::{Disc, SUBPIXELS, Spot, Stroke};
pub use canvas::{Canvas, FadeLayer, Fading, HEIGHT, Row, WIDTH};
pub use plot::Height;
pub use text::{Anchor, Glyph, LINE, LOWEST, glyph};
pub use view::{Place, RodDirections, TRACE_HALF_WIDTH, View};

/// The frame buffers of an application, which borrows them.
///
/// They are created at their final place, on a board in a static, so that their 8 KiB are neither
/// on the stack nor copied when a scene is created.
#[derive(Clone, Debug)]
pub struct FrameBuffers {
    /// The frame that is drawn and sent.
    pub canvas: Canvas,
    /// The traces of earlier frames.
    pub ink: FadeLayer,
}

impl FrameBuffers {
    /// Black buffers without traces.
    pub const BLANK: Self = Self {
        canvas: Canvas::BLACK,
        ink: FadeLayer::NONE,
    };
}
