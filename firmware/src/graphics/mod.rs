//! Drawing: a canvas of grey pixels, and all that draws on it.

pub mod bitmap;
pub mod brush;
pub mod canvas;
pub mod fade_layer;
pub mod font;
pub mod frame_buffers;
pub mod label;
pub mod plot;
pub mod text;
pub mod view;
