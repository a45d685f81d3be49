//! The panel's screenshot, read from QEMU's screen dump.

use anyhow::{Context, ensure};
use firmware::graphics::{Canvas, Format, rgb};

pub const WIDTH: usize = Format::OLED.width as usize;
pub const HEIGHT: usize = Format::OLED.height as usize;

const MAGNIFIED: usize = 4;
/// The beginning of the dump: colour, the magnified size, 255 levels.
const HEADER: &[u8] = b"P6\n512 256\n255\n";
/// QEMU shows grey g of 0 to 15 as 17 g of 255.
const GREY_UNIT: u8 = 17;

#[derive(Clone, PartialEq, Eq)]
pub struct Screenshot {
    pub format: Format,
    pub greys: Vec<u8>,
    /// The colours of a colour panel: five bits of red, six of green, five of blue.
    pub colours: Option<Vec<u16>>,
}

impl std::fmt::Debug for Screenshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for row in self.greys.chunks(self.format.width.into()) {
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
    pub fn black() -> Self {
        Self::drawn(|_, _| 0)
    }

    fn drawn(grey: impl Fn(usize, usize) -> u8) -> Self {
        Self {
            format: Format::OLED,
            greys: (0..WIDTH * HEIGHT)
                .map(|index| grey(index % WIDTH, index / WIDTH))
                .collect(),
            colours: None,
        }
    }

    /// The colours have two bytes each, the low one first. Pixels without a colour are black.
    pub fn from_colours(format: Format, bytes: &[u8]) -> Self {
        let mut colours: Vec<_> = bytes
            .chunks_exact(2)
            .map(|two| u16::from_le_bytes([two[0], two[1]]))
            .collect();
        colours.resize(usize::from(format.width) * usize::from(format.height), 0);
        let brightness = |colour: &u16| {
            let [red, green, blue] = rgb(*colour).map(u32::from);
            ((2 * red + 5 * green + blue) / 8 / 17) as u8
        };
        Self {
            format,
            greys: colours.iter().map(brightness).collect(),
            colours: Some(colours),
        }
    }

    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        let is_inside = (0..self.format.right()).contains(&x) && y >= 0;
        let place = y as usize * usize::from(self.format.width) + x as usize;
        self.greys.get(place).filter(|_| is_inside).copied()
    }

    /// `of_grey` are the colours of an OLED.
    pub fn rgb(&self, of_grey: impl Fn(u8) -> [u8; 3]) -> Vec<[u8; 3]> {
        match &self.colours {
            Some(colours) => colours.iter().map(|colour| rgb(*colour)).collect(),
            None => self.greys.iter().map(|grey| of_grey(*grey)).collect(),
        }
    }

    pub(super) fn from_ppm(file: &[u8]) -> anyhow::Result<Self> {
        let pixels = file
            .strip_prefix(HEADER)
            .context("the panel's screenshot is no PPM file of 512 x 256 pixels")?;
        let index =
            |x: usize, y: usize| 3 * ((MAGNIFIED * y + 1) * MAGNIFIED * WIDTH + MAGNIFIED * x + 1);
        ensure!(
            index(WIDTH - 1, HEIGHT - 1) < pixels.len(),
            "the panel's screenshot is cut short"
        );
        Ok(Self::drawn(|x, y| pixels[index(x, y)] / GREY_UNIT))
    }

    /// The memory of a one-colour panel has eight pages of eight rows, with a byte for each column.
    /// The top row of a page is bit 0.
    pub fn from_pages(memory: &[u8]) -> Self {
        let is_lit = |x: usize, y: usize| {
            memory
                .get(y / 8 * WIDTH + x)
                .is_some_and(|byte| byte >> (y % 8) & 1 != 0)
        };
        Self::drawn(|x, y| if is_lit(x, y) { 15 } else { 0 })
    }
}

impl From<&Canvas<'_>> for Screenshot {
    fn from(canvas: &Canvas<'_>) -> Self {
        let format = canvas.format;
        let [width, height] = [format.width, format.height].map(usize::from);
        let mut greys = vec![0; width * height];
        for (y, row) in (0..).zip(greys.chunks_mut(width)) {
            canvas.read_row(y, row);
        }

        let table = canvas.palette.colours();
        let pixel = |i: usize| canvas.pixel((i % width) as i32, (i / width) as i32);
        let colour = |i| table[usize::from(pixel(i).unwrap_or_default())];
        Self {
            format,
            greys,
            colours: format
                .is_large()
                .then(|| (0..width * height).map(colour).collect()),
        }
    }
}

#[test]
fn a_dump_of_another_size_or_cut_short_is_refused() {
    let whole = [HEADER, &[0xFF; 3 * 512 * 256]].concat();
    assert!(
        Screenshot::from_ppm(&whole).is_ok_and(|panel| panel.greys.iter().all(|grey| *grey == 15))
    );
    let cut_short = Screenshot::from_ppm(&whole[..whole.len() - 4 * 512 * 3]);
    assert!(cut_short.is_err() && Screenshot::from_ppm(b"P6\n720 400\n255\n").is_err());
}
