//! The panel's screenshot, read from QEMU's screen dump.

use anyhow::{Context, ensure};
use firmware::graphics::Canvas;
pub use firmware::graphics::{HEIGHT, WIDTH};

/// The width and height, in pixels of the dump, of the square that shows one pixel of the panel.
const MAGNIFIED: usize = 4;
/// The beginning of the dump: colour, the magnified size, 255 levels.
const HEADER: &[u8] = b"P6\n512 256\n255\n";
/// The factor of greys: QEMU shows grey g of 0 to 15 as 17 g of 255.
const GREY_UNIT: u8 = 17;

/// The picture on the panel: 4-bit greys, row by row from the top left.
#[derive(Clone, PartialEq, Eq)]
pub struct Screenshot {
    /// The grey of each pixel: 0 is black, 15 is white. There are [`WIDTH`] x [`HEIGHT`] of them,
    /// 128 x 64.
    pub greys: Vec<u8>,
}

impl std::fmt::Debug for Screenshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for row in self.greys.chunks(WIDTH) {
            let line: String = row
                .iter()
                .map(|&grey| b" .:-=+*#%@"[usize::from(grey) * 9 / 15] as char)
                .collect();
            writeln!(f, "|{line}|")?;
        }
        Ok(())
    }
}

impl Screenshot {
    /// Makes a screenshot from the grey of each pixel, `x` from the left and `y` from the top.
    fn drawn(grey: impl Fn(usize, usize) -> u8) -> Self {
        Self {
            greys: (0..WIDTH * HEIGHT)
                .map(|index| grey(index % WIDTH, index / WIDTH))
                .collect(),
        }
    }

    /// Reads QEMU's dump. It is an error if the dump has another size or is cut short.
    pub(super) fn from_ppm(file: &[u8]) -> anyhow::Result<Self> {
        let pixels = file
            .strip_prefix(HEADER)
            .context("the panel's screenshot is no PPM file of 512 x 256 pixels")?;
        // The middle of the square that shows a pixel of the panel.
        let index =
            |x: usize, y: usize| 3 * ((MAGNIFIED * y + 1) * MAGNIFIED * WIDTH + MAGNIFIED * x + 1);
        ensure!(
            index(WIDTH - 1, HEIGHT - 1) < pixels.len(),
            "the panel's screenshot is cut short"
        );
        Ok(Self::drawn(|x, y| pixels[index(x, y)] / GREY_UNIT))
    }

    /// Makes a screenshot from the memory of a one-colour panel. The memory contains eight pages of
    /// eight rows from the top, with a byte for each of the 128 columns from the left. The top row
    /// of a page is bit 0; a set bit is white (15). Pixels beyond the memory are black, and bytes
    /// beyond the eight pages are ignored.
    pub fn from_pages(memory: &[u8]) -> Self {
        let is_lit = |x: usize, y: usize| {
            memory
                .get(y / 8 * WIDTH + x)
                .is_some_and(|byte| byte >> (y % 8) & 1 != 0)
        };
        Self::drawn(|x, y| if is_lit(x, y) { 15 } else { 0 })
    }
}

/// The picture that the panel would show of a canvas.
impl From<&Canvas> for Screenshot {
    fn from(canvas: &Canvas) -> Self {
        Self::drawn(|x, y| canvas.get(x as i32, y as i32).unwrap_or_default())
    }
}

/// A white dump of the right size has white pixels only. A dump without the last row of the panel,
/// or with another size in its header, is an error.
#[test]
fn a_dump_of_another_size_or_cut_short_is_refused() {
    let whole = [HEADER, &[0xFF; 3 * 512 * 256]].concat();
    assert!(
        Screenshot::from_ppm(&whole).is_ok_and(|panel| panel.greys.iter().all(|grey| *grey == 15))
    );
    let cut_short = Screenshot::from_ppm(&whole[..whole.len() - 4 * 512 * 3]);
    assert!(cut_short.is_err() && Screenshot::from_ppm(b"P6\n720 400\n255\n").is_err());
}
