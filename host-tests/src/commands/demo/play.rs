//! Reading an animation back, for tests.

use std::fs::File;
use std::path::Path;

use gif::{ColorOutput, DecodeOptions};

/// The greys that an animation shows, dot by dot, screenshot after screenshot, each with the hundredths of a second it stays.
pub fn played(path: &Path) -> anyhow::Result<Vec<(Vec<u8>, u16)>> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    let mut decoder = options.read_info(File::open(path)?)?;
    let width = usize::from(decoder.width());
    let mut shown = vec![0; width * usize::from(decoder.height())];
    let mut played = Vec::new();
    while let Some(frame) = decoder.read_next_frame()? {
        let (left, top) = (usize::from(frame.left), usize::from(frame.top));
        for (row, dots) in frame.buffer.chunks(frame.width.into()).enumerate() {
            let start = (top + row) * width + left;
            for (shown, &dot) in shown[start..].iter_mut().zip(dots) {
                if frame.transparent != Some(dot) {
                    *shown = dot;
                }
            }
        }
        played.push((shown.clone(), frame.delay));
    }
    Ok(played)
}
