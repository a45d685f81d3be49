//! The canvas: two layers of 16 levels, and a record of the changes.
//!
//! A colour panel needs both layers. A panel of greys shows only the foreground, which begins there
//! as a copy of the ink: that takes half of the time of composing both.

use core::ops::Range;

use crate::graphics::row::{Pen, Row, nibbles, shift, shown};
use crate::graphics::{Format, Palette};

/// The frame buffers of a canvas: two layers of this number of words, and the rows. They are created
/// at their final place, on a board in a static.
#[derive(Clone, Debug)]
pub struct FrameBuffers<const WORDS: usize, const ROWS: usize> {
    layers: [[u32; WORDS]; 2],
    cells: [Cells; ROWS],
}

impl<const WORDS: usize, const ROWS: usize> FrameBuffers<WORDS, ROWS> {
    /// Black buffers.
    pub const BLANK: Self = Self {
        layers: [[0; WORDS]; 2],
        cells: [Cells::NONE; ROWS],
    };

    /// Returns a canvas of this format in these buffers. Pixels for which they have no room are
    /// not drawn.
    pub fn canvas(&mut self, format: Format) -> Canvas<'_> {
        let [ink, foreground] = &mut self.layers;
        Canvas::new(format, [ink, foreground], &mut self.cells)
    }
}

/// A bit for each cell of a row. An OLED has 16 cells, and its boards have little memory.
#[cfg(all(target_os = "none", not(lcd)))]
type Bits = u16;
#[cfg(not(all(target_os = "none", not(lcd))))]
type Bits = u32;

/// Returns the bits as a word. On an OLED's board they are shorter.
fn word(bits: impl Into<u32>) -> u32 {
    bits.into()
}

/// The cells of a row, one in each bit, from the left.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cells {
    /// The cells that the foreground covers.
    drawn: Bits,
    /// The cells that have changed since the panel took the row.
    changed: Bits,
}

impl Cells {
    /// No cells.
    pub const NONE: Self = Self {
        drawn: 0,
        changed: 0,
    };

    fn touch(&mut self, layer: Layer, touched: u32) {
        match layer {
            Layer::Ink => self.changed |= touched as Bits,
            Layer::Foreground => self.drawn |= touched as Bits,
        }
    }
}

/// The layer that is drawn on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layer {
    /// The traces of earlier frames. They stay, and may fade.
    Ink,
    /// The rest of the picture, drawn anew in each frame.
    Foreground,
}

/// The number 1 in every byte.
const BYTES: u32 = 0x0101_0101;

/// A picture of a [`Format`] in two layers. Drawing cannot fail: pixels outside are ignored.
///
/// A level is a grey from 0 (black) to 15. A panel of greys shows the foreground. On a colour panel,
/// the foreground covers the ink; its level 0 is transparent, and its level 1 is black. The panel
/// shows the colour of both levels in the [`Palette`](Palette::colours).
///
/// In each layer a byte has two pixels, the left one in the high nibble, and a word has eight.
///
/// Each row keeps a bit for every cell of 8 pixels (16 on panels wider than 256) that has changed,
/// so that a driver sends only those.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// The size of the picture and of its text.
    pub format: Format,
    /// The colours of the scene.
    pub palette: Palette,
    ink: &'a mut [u32],
    foreground: &'a mut [u32],
    cells: &'a mut [Cells],
    layer: Layer,
    /// The next row to fade.
    row: u16,
}

/// Canvases are equal if they show the same picture.
impl PartialEq for Canvas<'_> {
    fn eq(&self, other: &Self) -> bool {
        (self.format, self.palette) == (other.format, other.palette)
            && self.ink == other.ink
            && self.foreground == other.foreground
    }
}

impl<'a> Canvas<'a> {
    /// Creates a canvas in this memory, which is not cleared: the words of the ink and of the
    /// foreground, and the cells of the rows. Its first drawing is in the foreground, and counts as
    /// whole.
    pub fn new(
        format: Format,
        [ink, foreground]: [&'a mut [u32]; 2],
        cells: &'a mut [Cells],
    ) -> Self {
        let mut canvas = Self {
            format,
            palette: Palette::Trail,
            ink,
            foreground,
            cells,
            layer: Layer::Foreground,
            row: 0,
        };
        canvas.touch_all();
        canvas
    }

    /// Clears both layers for a new scene.
    pub fn blank(&mut self, palette: Palette) {
        self.ink.fill(0);
        self.foreground.fill(0);
        self.cells.fill(Cells::NONE);
        self.palette = palette;
        self.row = 0;
        self.touch_all();
    }

    /// Draws on the ink from now on.
    pub fn on_ink(&mut self) -> &mut Self {
        self.layer = Layer::Ink;
        self
    }

    /// Clears the foreground to the ink alone, and draws on it from now on.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn on_clear_foreground(&mut self) -> &mut Self {
        self.layer = Layer::Foreground;
        let is_apart = self.format.is_large();
        let shift = self.cell_shift() - 3;
        for (y, cells) in (0..self.format.bottom()).zip(&mut *self.cells) {
            let drawn = core::mem::take(&mut cells.drawn);
            cells.changed |= drawn;
            let ink = row_of(self.ink, self.format, y).unwrap_or_default();
            let words = row_of(self.foreground, self.format, y).unwrap_or_default();
            if !is_apart && cells.changed != 0 {
                // In half of the time of the library's `memcpy`.
                words.iter_mut().zip(ink).for_each(|(to, from)| *to = *from);
            } else if is_apart && drawn != 0 {
                let first = (drawn.trailing_zeros() << shift) as usize;
                let end = ((Bits::BITS - drawn.leading_zeros()) << shift) as usize;
                words.get_mut(first..end).unwrap_or_default().fill(0);
            }
        }
        self
    }

    /// Returns the width of a cell, pixels.
    pub fn cell(&self) -> usize {
        1 << self.cell_shift()
    }

    /// Returns the pen, the words of the layer that is drawn on and of the layer that it covers, and
    /// the cells.
    fn parts(&mut self) -> (Pen, [&mut [u32]; 2], &mut [Cells]) {
        let pen = self.pen();
        let words = match self.layer {
            Layer::Ink => [&mut *self.ink, &mut []],
            Layer::Foreground if pen.is_apart => [&mut *self.foreground, &mut *self.ink],
            Layer::Foreground => [&mut *self.foreground, &mut []],
        };
        (pen, words, self.cells)
    }

    fn pen(&self) -> Pen {
        Pen {
            is_apart: self.layer == Layer::Foreground && self.format.is_large(),
        }
    }

    fn cell_shift(&self) -> u32 {
        if self.format.known().width <= 256 {
            3
        } else {
            4
        }
    }

    /// Returns the cells of row `y` that the panel may not show as they are, a bit each, the
    /// leftmost in bit 0. It is 0 outside the canvas.
    pub fn changed(&self, y: usize) -> u32 {
        let bits = |cells: &Cells| word(cells.changed | cells.drawn);
        self.cells.get(y).map_or(0, bits)
    }

    /// Returns the words of row `y` of the ink and of the foreground, none outside the canvas.
    pub fn row(&self, y: usize) -> [&[u32]; 2] {
        let range = self.format.row_range(y).unwrap_or_default();
        [&*self.ink, &*self.foreground].map(|layer| layer.get(range.clone()).unwrap_or_default())
    }

    /// Marks everything as shown by the panel.
    pub fn settle(&mut self) {
        self.cells.iter_mut().for_each(|cells| cells.changed = 0);
    }

    /// Marks everything as changed, because the panel may show anything.
    pub fn touch_all(&mut self) {
        let count = (u32::from(self.format.known().width) - 1) >> self.cell_shift();
        let all = u32::MAX >> (31 - count.min(31));
        self.cells
            .iter_mut()
            .for_each(|cells| cells.changed = all as Bits);
    }

    /// Returns the cells that these columns are in, a bit each.
    pub(super) fn cells_of(&self, columns: Range<i32>) -> u32 {
        let shift = self.cell_shift();
        let from = columns.start.max(0);
        let to = columns.end.min(self.format.right());
        if from >= to {
            return 0;
        }
        let last = ((to - 1) as u32 >> shift).min(31);
        (u32::MAX >> (31 - last)) & (u32::MAX << (from as u32 >> shift))
    }

    /// Returns row `y` for drawing in these columns, which count as changed; `None` outside the
    /// canvas.
    #[inline]
    pub fn row_mut(&mut self, y: i32, columns: Range<i32>) -> Option<Row<'_>> {
        self.row_in(y, self.cells_of(columns))
    }

    /// Returns row `y` for drawing in these cells, as [`row_mut`](Self::row_mut). Several rows then
    /// need [`cells_of`](Self::cells_of) only once.
    #[inline]
    pub(super) fn row_in(&mut self, y: i32, touched: u32) -> Option<Row<'_>> {
        let format = self.format;
        let layer = self.layer;
        let (pen, [words, covered], cells) = self.parts();
        cells.get_mut(y as usize)?.touch(layer, touched);
        Some(Row {
            words: row_of(words, format, y)?,
            covered: row_of(covered, format, y).unwrap_or_default(),
            pen,
        })
    }

    /// Returns the grey that a pixel shows, 0 to 15; `None` outside the canvas.
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        let pixel = self.pixel(x, y)?;
        Some(if self.format.is_large() {
            shown(pixel >> 4, pixel & 15)
        } else {
            pixel & 15
        })
    }

    /// Writes the greys that row `y` shows to `greys`, from the left.
    ///
    /// Host programs read thousands of frames. This crate is optimised in their debug builds and
    /// they are not, so a call of [`get`](Self::get) for each pixel would take longer.
    pub fn read_row(&self, y: i32, greys: &mut [u8]) {
        for (x, grey) in (0..).zip(greys) {
            *grey = self.get(x, y).unwrap_or_default();
        }
    }

    /// Returns both layers of a pixel, the ink in the high nibble; `None` outside the canvas.
    pub fn pixel(&self, x: i32, y: i32) -> Option<u8> {
        let [ink, foreground] = self.row(y as usize);
        let level = |words: &[u32]| Some(words.get((x >> 3) as usize)? >> shift(x) & 15);
        Some((level(ink)? << 4 | level(foreground)?) as u8)
    }

    /// Replaces the grey of a pixel by a function of it. The function is not called for a pixel
    /// outside the canvas.
    pub fn update(&mut self, x: i32, y: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(mut row) = self.row_mut(y, x..x.saturating_add(1)) {
            row.update(x, new);
        }
    }

    /// Sets a rectangle to a grey, except pixels that are brighter.
    pub fn lighten(&mut self, columns: Range<i32>, rows: Range<i32>, grey: u8) {
        let touched = self.cells_of(columns.clone());
        for y in rows {
            if let Some(mut row) = self.row_in(y, touched) {
                columns.clone().for_each(|x| row.lighten(x, grey));
            }
        }
    }

    /// Counts a rectangle as changed.
    pub(super) fn touch(&mut self, columns: Range<i32>, rows: Range<i32>) {
        let touched = self.cells_of(columns);
        for y in rows {
            if let Some(cells) = self.cells.get_mut(y as usize) {
                cells.touch(self.layer, touched);
            }
        }
    }

    /// Sets pixels to one grey, brighter ones, too: the squares of a unit whose bits are set, of
    /// the 8 x 8 to the right of column `x` and below row `y`. The first row is in the highest
    /// byte, and the leftmost square of a row is in its highest bit. A unit is at most 3 pixels.
    pub fn stamp(&mut self, x: i32, y: i32, bits: u64, grey: u8) {
        let size = self.format.line();
        self.touch(x..x.saturating_add(size), y..y.saturating_add(size));
        self.stamp_touched(x, y, bits, grey);
    }

    /// As [`stamp`](Self::stamp), where the caller has touched the pixels.
    pub(super) fn stamp_touched(&mut self, x: i32, y: i32, bits: u64, grey: u8) {
        let unit = self.format.units(1);
        let greys = self.pen().greys(grey);
        let length = self.format.row_words();
        let (_, [words, _], _) = self.parts();
        let mut rest = bits;
        // Negative numbers become words far beyond the end.
        let mut start = (y as usize).wrapping_mul(length);
        while rest != 0 {
            let pixels = stretched((rest >> 56) as u8, unit) >> (x & 7);
            for _ in 0..unit {
                let end = start.wrapping_add(length);
                let row = words.get_mut(start..end).unwrap_or_default();
                start = end;
                let mut pixels = pixels;
                let mut place = (x >> 3) as usize;
                while pixels != 0 {
                    if let Some(word) = row.get_mut(place) {
                        *word ^= (*word ^ greys) & nibbles(pixels >> 24);
                    }
                    pixels <<= 8;
                    place = place.wrapping_add(1);
                }
            }
            rest <<= 8;
        }
    }

    /// Sets the pixels of column `x` in these rows to the greys that `grey` returns, except those
    /// that are brighter.
    pub(super) fn lighten_down(
        &mut self,
        x: i32,
        rows: Range<i32>,
        mut grey: impl FnMut(i32) -> u8,
    ) {
        let touched = self.cells_of(x..x.saturating_add(1));
        if touched == 0 {
            return;
        }
        let rows = rows.start.max(0)..rows.end.min(self.format.bottom());
        let length = self.format.row_words();
        let mut place = rows.start as usize * length + (x >> 3) as usize;
        let layer = self.layer;
        let (pen, [words, covered], cells) = self.parts();
        for y in rows {
            let (Some(word), Some(cells)) = (words.get_mut(place), cells.get_mut(y as usize))
            else {
                return;
            };
            cells.touch(layer, touched);
            pen.lighten(word, covered.get(place), x, grey(y));
            place += length;
        }
    }

    /// Moves the ink to the left by one column. The last column becomes black, and so does column
    /// `left - 1`, where the moving part ends. Columns before it must be black.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn scroll(&mut self, left: i32) {
        self.on_ink();
        let shift = self.cell_shift() - 3;
        let length = self.format.row_words();
        let edge = left - 1;
        let first = (edge.max(0) >> 3) as usize;
        let edge_cell = self.cells_of(edge..left);
        let edge_bit = if edge < 0 { 0 } else { 0x80 >> (edge & 7) };
        let edge_pixel = nibbles(edge_bit);
        for (y, cells) in (0..self.format.bottom()).zip(&mut *self.cells) {
            let words = row_of(self.ink, self.format, y).and_then(|row| row.get_mut(first..));
            let Some(words) = words else {
                return;
            };
            let mut touched = 0;
            let mut from_right = 0;
            let mut place = length;
            for word in words.iter_mut().rev() {
                place -= 1;
                // Most of a plot is black.
                if *word | from_right == 0 {
                    continue;
                }
                let ink = u32::from_be(*word);
                *word = (ink << 4 | from_right).to_be();
                from_right = ink >> 28;
                touched |= 1 << (place >> shift);
            }
            if touched != 0
                && let Some(word) = words.first_mut()
            {
                *word &= !edge_pixel;
                cells.touch(Layer::Ink, touched | edge_cell);
            }
        }
    }

    /// Clears the ink.
    pub fn clear_ink(&mut self) {
        self.on_ink();
        if self.ink.iter().any(|word| *word != 0) {
            self.ink.fill(0);
            self.touch_all();
        }
    }

    /// Makes the columns of the present layer black.
    pub fn clear_columns(&mut self, columns: Range<i32>) {
        for y in 0..self.format.bottom() {
            if let Some(mut row) = self.row_mut(y, columns.clone()) {
                row.fill(columns.clone(), 0);
            }
        }
    }

    /// Fades the next rows by one level each, after the lowest row the top one again; to be called
    /// once a tick of the scene. Ink at or below the level `last` is unchanged.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn fade(&mut self, Fading { rows, last }: Fading) {
        let room = u32::from(15_u8.saturating_sub(last)) * BYTES;
        let shift = self.cell_shift() - 3;
        let rows = (u32::from(rows) * u32::from(self.format.known().height) + 32) / 64;

        // A level above `last` carries out of its nibble, and then loses 1.
        for _ in 0..rows {
            let y = self.row;
            self.row += 1;
            if self.row >= self.format.known().height {
                self.row = 0;
            }
            let row = row_of(self.ink, self.format, y.into());
            let (Some(row), Some(cells)) = (row, self.cells.get_mut(usize::from(y))) else {
                continue;
            };
            for (place, word) in row.iter_mut().enumerate() {
                if *word != 0 {
                    let lost = carried(*word, room) | carried(*word >> 4, room) << 4;
                    if lost != 0 {
                        *word -= lost;
                        cells.touch(Layer::Ink, 1 << (place >> shift));
                    }
                }
            }
        }
    }
}

/// The speed of fading. Every row loses one level in 64/`rows` ticks of the scene, whatever the
/// height of the canvas; with 0 rows nothing fades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fading {
    /// The number of rows, of 64, that lose a level in a tick.
    pub rows: u8,
    /// The final level of faded ink, 0 to 15. Darker ink does not change. From 15 on, nothing
    /// fades.
    pub last: u8,
}

impl Fading {
    /// The traces stay as they are.
    pub const NEVER: Self = Self { rows: 0, last: 15 };
    /// The fading of a trace that remains visible. It loses a level in about a second, down to 4.
    pub const TRACE: Self = Self { rows: 1, last: 4 };
}

/// Returns row `y` of the words of a layer; `None` outside the canvas.
#[inline]
fn row_of(words: &mut [u32], format: Format, y: i32) -> Option<&mut [u32]> {
    // A negative number becomes a row far beyond the end.
    if y as u32 >= format.known().height.into() {
        return None;
    }
    let length = format.row_words();
    let rest = words.get_mut(y as usize * length..)?;
    rest.get_mut(..length)
}

/// Returns the carries of the levels in the low nibbles of the four bytes of `greys`: bit 0 of a
/// byte is 1 if the level plus the summand in the same byte of `room`, 0 to 15, is at least 16. All
/// other bits are 0. The high nibbles are ignored.
pub(super) fn carried(greys: u32, room: u32) -> u32 {
    (((greys & (15 * BYTES)) + room) >> 4) & BYTES
}

/// Returns the squares of a row as pixels, the left one in the highest bit.
fn stretched(squares: u8, unit: i32) -> u32 {
    if unit == 1 {
        return u32::from(squares) << 24;
    }
    widened(squares, unit as u32)
}

#[inline(never)] // Inlined, it takes registers from the stamps of a small panel.
fn widened(squares: u8, unit: u32) -> u32 {
    let square = !(u32::MAX >> unit);
    (0..8)
        .filter(|place| squares << place & 0x80 != 0)
        .fold(0, |pixels, place| pixels | square >> (unit * place))
}
