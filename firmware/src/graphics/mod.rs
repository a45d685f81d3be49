//! Drawing: a canvas of grey pixels, and all that draws on it.

pub mod bitmap;
pub mod brush;
pub mod canvas;
pub mod fade_layer;
mod font;
pub mod label;
pub mod plot;
pub mod text;
mod view;

pub use bitmap::{Bitmap, PAGES};
pub use brush::{Disc, SUBPIXELS, Spot, Stroke};
pub use canvas::{Canvas, HEIGHT, Row, WIDTH};
pub use fade_layer::{FadeLayer, Fading, FrameBuffers};
pub use font::{Glyph, glyph};
pub use plot::{Height, Strip};
pub use text::{Anchor, LINE, LOWEST};
pub use view::{Place, RodDirections, View};
