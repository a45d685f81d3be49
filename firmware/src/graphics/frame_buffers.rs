//! The frames an application works on: nearly all of its memory.

use crate::graphics::canvas::Canvas;
use crate::graphics::fade_layer::FadeLayer;

/// An application borrows them. They are made where they stay, on a board in a static: 8 KiB that neither stand on the
/// stack nor are copied when a scene is made.
#[derive(Clone, Debug)]
pub struct FrameBuffers {
    /// What the panel is to show.
    pub canvas: Canvas,
    /// What stays of the frames before.
    pub ink: FadeLayer,
}

impl FrameBuffers {
    /// Both black.
    pub const BLANK: Self = Self { canvas: Canvas::BLACK, ink: FadeLayer::NONE };
}

impl Default for FrameBuffers {
    fn default() -> Self {
        Self::BLANK
    }
}
