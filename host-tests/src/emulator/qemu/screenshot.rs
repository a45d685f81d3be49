//! The panel's screenshot, out of QEMU's screen dump.

use anyhow::Context;
use firmware::graphics::Canvas;
pub use firmware::graphics::{HEIGHT, WIDTH};

/// QEMU shows each of the panel's pixels as a square of this many by as many.
const MAGNIFIED: usize = 4;
/// How the dump begins: colour, the magnified size, 255 levels.
const HEADER: &[u8] = b"P6\n512 256\n255\n";
/// QEMU shows grey g of 0 to 15 as g times 17 of 255.
const GREY_UNIT: u8 = 17;

/// What the panel shows: 4-bit greys, row by row from the top left.
#[derive(Clone, PartialEq, Eq)]
pub struct Screenshot {
    greys: Vec<u8>,
}

impl std::fmt::Debug for Screenshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for row in self.greys.chunks(WIDTH) {
            let line: String = row.iter().map(|&grey| b" .:-=+*#%@"[usize::from(grey) * 9 / 15] as char).collect();
            writeln!(f, "|{line}|")?;
        }
        Ok(())
    }
}

impl Screenshot {
    pub(super) fn from_ppm(file: &[u8]) -> anyhow::Result<Self> {
        let pixels = file.strip_prefix(HEADER).context("the panel's screenshot is no PPM file of 512 x 256 pixels")?;
        let at = |x: usize, y: usize| {
            let index = 3 * ((MAGNIFIED * y + 1) * MAGNIFIED * WIDTH + MAGNIFIED * x + 1);
            pixels.get(index).map(|level| level / GREY_UNIT)
        };
        let greys = (0..WIDTH * HEIGHT).map(|index| at(index % WIDTH, index / WIDTH)).collect::<Option<_>>();
        Ok(Self { greys: greys.context("the panel's screenshot is cut short")? })
    }

    pub fn blank() -> Self {
        Self { greys: vec![0; WIDTH * HEIGHT] }
    }

    /// Out of the memory of a one-colour panel, pages of eight rows from the top, a byte for every column of each; black where
    /// there is none.
    pub fn from_pages(memory: &[u8]) -> Self {
        let is_lit = |x: usize, y: usize| memory.get(y / 8 * WIDTH + x).is_some_and(|byte| byte >> (y % 8) & 1 != 0);
        let grey = |index: usize| if is_lit(index % WIDTH, index / WIDTH) { 15 } else { 0 };
        Self { greys: (0..WIDTH * HEIGHT).map(grey).collect() }
    }

    /// The grey, 0 to 15, of the pixel `x` from the left and `y` from the top; 0 outside the panel.
    pub fn grey(&self, x: usize, y: usize) -> u8 {
        if x < WIDTH { self.greys.get(y * WIDTH + x).copied().unwrap_or_default() } else { 0 }
    }

    pub fn greys(&self) -> &[u8] {
        &self.greys
    }
}

/// What the panel shows of a screenshot drawn here.
impl From<&Canvas> for Screenshot {
    fn from(canvas: &Canvas) -> Self {
        let grey = |index: usize| canvas.get((index % WIDTH) as i32, (index / WIDTH) as i32).unwrap_or_default();
        Self { greys: (0..WIDTH * HEIGHT).map(grey).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dump_is_sampled_inside_each_magnified_pixel() {
        let mut dump = HEADER.to_vec();
        for y in 0..4 * HEIGHT {
            for x in 0..4 * WIDTH {
                dump.extend([(((x / 4) + (y / 4)) % 16) as u8 * GREY_UNIT; 3]);
            }
        }
        let screenshot = Screenshot::from_ppm(&dump).expect("a whole dump");
        for (x, y) in [(0, 0), (127, 0), (0, 63), (127, 63), (64, 32), (5, 60)] {
            assert_eq!(usize::from(screenshot.grey(x, y)), (x + y) % 16, "at {x}, {y}");
        }
        dump.truncate(dump.len() - 4 * 512 * 3);
        assert!(Screenshot::from_ppm(&dump).is_err(), "cut short");
        assert!(Screenshot::from_ppm(b"P6\n720 400\n255\n").is_err(), "another display");
    }
}
