//! Drawing: the panels' formats, a canvas in two layers, and the tools that draw on it.

mod bitmap;
mod brush;
mod canvas;
mod format;
pub mod label;
mod palette;
mod panel;
pub mod plot;
mod row;
pub mod text;
mod view;

pub use bitmap::{Bitmap, PAGES};
pub use brush::{Disc, SUBPIXELS, Spot, Stroke};
pub use canvas::{Canvas, Cells, Fading, FrameBuffers};
pub use format::Format;
pub use palette::{Palette, rgb};
pub use panel::{PANEL, PanelName};
pub use plot::Height;
pub use row::Row;
pub use text::{Anchor, Glyph, glyph};
pub use view::{Place, RodDirections, TRACE_HALF_WIDTH, View};
