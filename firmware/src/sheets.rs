//! The pictures an application works on: nearly all of its memory.

use crate::canvas::Canvas;
use crate::ink::Ink;

/// An application borrows them. They are made where they stay, on a board in a static: 8 KiB that neither stand on the
/// stack nor are copied when a scene is made.
#[derive(Clone, Debug)]
pub struct Sheets {
    /// What the panel shall show.
    pub canvas: Canvas,
    /// What stays of the pictures before.
    pub ink: Ink,
}

impl Sheets {
    /// Both black.
    pub const BLANK: Self = Self { canvas: Canvas::BLACK, ink: Ink::NONE };
}

impl Default for Sheets {
    fn default() -> Self {
        Self::BLANK
    }
}
