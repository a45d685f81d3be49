//! The canvas: two layers of 16 levels in one byte a pixel, and a record of what has changed.

use core::ops::Range;

use crate::graphics::{Format, Palette};

/// The frame buffers of a canvas of W4 words by H rows. They are created at their final place, on a
/// board in a static.
#[derive(Clone, Debug)]
pub struct FrameBuffers<const WORDS: usize, const ROWS: usize> {
    words: [u32; WORDS],
    cells: [Cells; ROWS],
}

impl<const WORDS: usize, const ROWS: usize> FrameBuffers<WORDS, ROWS> {
    /// Black buffers.
    pub const BLANK: Self = Self {
        words: [0; WORDS],
        cells: [Cells::NONE; ROWS],
    };

    /// Returns a canvas of this format in these buffers. Pixels for which they have no room are
    /// not drawn.
    pub fn canvas(&mut self, format: Format) -> Canvas<'_> {
        Canvas::new(format, &mut self.words, &mut self.cells)
    }
}

/// The cells of a row, one in each bit, from the left.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cells {
    /// The cells that the foreground covers.
    drawn: u32,
    /// The cells that have changed since the panel took the row.
    changed: u32,
}

impl Cells {
    /// No cells.
    pub const NONE: Self = Self {
        drawn: 0,
        changed: 0,
    };
}

impl Cells {
    fn touch(&mut self, layer: Layer, touched: u32) {
        match layer {
            Layer::Ink => self.changed |= touched,
            Layer::Foreground => self.drawn |= touched,
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

/// The level of the foreground that covers the ink with black. 0 is transparent.
const BLACK: u8 = 1;
/// The bits of the foreground in a word.
const FOREGROUND: u32 = 0x0F0F_0F0F;
/// The number 1 in every byte.
const ONES: u32 = 0x0101_0101;

impl Layer {
    /// Returns the grey that this layer shows in a pixel: of the foreground the visible one.
    fn grey(self, pixel: u8) -> u8 {
        match (self, pixel & 15) {
            (Self::Ink, _) | (_, 0) => pixel >> 4,
            (_, BLACK) => 0,
            (_, grey) => grey,
        }
    }

    /// Returns the pixel with another grey in this layer.
    fn with(self, pixel: u8, grey: u8) -> u8 {
        match self {
            Self::Ink => pixel & 0x0F | grey << 4,
            Self::Foreground => pixel & 0xF0 | grey.max(BLACK),
        }
    }

    /// Sets a pixel to a grey, unless it is brighter.
    fn lighten(self, pixel: &mut u8, grey: u8) {
        if grey > self.grey(*pixel) {
            *pixel = self.with(*pixel, grey);
        }
    }

    /// Returns a tool that sets pixels of this layer to a grey.
    fn paint(self, grey: u8) -> Paint {
        let (shift, level) = match self {
            Self::Ink => (4, grey),
            Self::Foreground => (0, grey.max(BLACK)),
        };
        Paint {
            shift,
            levels: (u32::from(level) * ONES) << shift,
        }
    }
}

/// A grey of a layer, for four pixels at once.
#[derive(Clone, Copy, Debug)]
struct Paint {
    /// The place of the layer in a pixel.
    shift: u32,
    levels: u32,
}

impl Paint {
    /// Sets the pixels of a word whose bits are set in `pixels`, the left one in bit 0.
    fn put(self, word: &mut u32, pixels: u32) {
        let bits = (pixels & 15).wrapping_mul(0x0020_4081) & ONES;
        let covered = (15 * bits) << self.shift;
        *word = (*word & !covered) | (self.levels & covered);
    }
}

/// A picture of a [`Format`] in two layers. Drawing cannot fail: pixels outside are ignored.
///
/// A pixel is a byte: ink in the high nibble, foreground in the low one. Four pixels are a word,
/// the left one in its lowest byte. A level is a grey from 0 (black) to 15. The foreground covers
/// the ink; its level 0 is transparent, and its level 1 is black. A panel of greys shows the
/// [visible](visible) grey, and a colour panel the colour of the byte in the
/// [`Palette`](Palette::colours).
///
/// Each row keeps a bit for every cell of 8 pixels (16 on panels wider than 256) that has changed,
/// so that a driver sends only those.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// The size of the picture and of its text.
    pub format: Format,
    /// The colours of the scene.
    pub palette: Palette,
    words: &'a mut [u32],
    cells: &'a mut [Cells],
    layer: Layer,
    /// The next row to fade.
    row: u16,
}

/// Canvases are equal if they show the same picture.
impl PartialEq for Canvas<'_> {
    fn eq(&self, other: &Self) -> bool {
        (self.format, self.palette) == (other.format, other.palette) && self.words == other.words
    }
}

impl<'a> Canvas<'a> {
    /// Creates a canvas in this memory, which is not cleared. Its first drawing is in the
    /// foreground, and counts as whole.
    pub fn new(format: Format, words: &'a mut [u32], cells: &'a mut [Cells]) -> Self {
        let mut canvas = Self {
            format,
            palette: Palette::Trail,
            words,
            cells,
            layer: Layer::Foreground,
            row: 0,
        };
        canvas.touch_all();
        canvas
    }

    /// Clears both layers for a new scene.
    pub fn blank(&mut self, palette: Palette) {
        self.words.fill(0);
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

    /// Clears the foreground, and draws on it from now on.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn on_clear_foreground(&mut self) -> &mut Self {
        self.layer = Layer::Foreground;
        let shift = self.cell_shift() - 2;
        let rows = self.words.chunks_exact_mut(self.format.row_words().max(1));
        for (row, cells) in rows.zip(&mut *self.cells) {
            let drawn = core::mem::take(&mut cells.drawn);
            if drawn == 0 {
                continue;
            }
            cells.changed |= drawn;
            let first = (drawn.trailing_zeros() << shift) as usize;
            let end = ((u32::BITS - drawn.leading_zeros()) << shift) as usize;
            let words = row.get_mut(first..end).unwrap_or_default();
            let (pairs, rest) = words.as_chunks_mut::<2>();
            for [left, right] in pairs {
                *left &= !FOREGROUND;
                *right &= !FOREGROUND;
            }
            rest.iter_mut().for_each(|word| *word &= !FOREGROUND);
        }
        self
    }

    /// Returns the width of a cell, pixels.
    pub fn cell(&self) -> usize {
        1 << self.cell_shift()
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
        self.cells
            .get(y)
            .map_or(0, |cells| cells.changed | cells.drawn)
    }

    /// Returns the words of row `y`, none outside the canvas.
    pub fn row(&self, y: usize) -> &[u32] {
        let range = self.format.row_range(y).unwrap_or_default();
        self.words.get(range).unwrap_or_default()
    }

    /// Marks everything as shown by the panel.
    pub fn settle(&mut self) {
        self.cells.iter_mut().for_each(|cells| cells.changed = 0);
    }

    /// Marks everything as changed, because the panel may show anything.
    pub fn touch_all(&mut self) {
        let count = (u32::from(self.format.known().width) - 1) >> self.cell_shift();
        let all = u32::MAX >> (31 - count.min(31));
        self.cells.iter_mut().for_each(|cells| cells.changed = all);
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
    pub fn row_mut(&mut self, y: i32, columns: Range<i32>) -> Option<Row<'_>> {
        self.row_in(y, self.cells_of(columns))
    }

    /// Returns row `y` for drawing in these cells, as [`row_mut`](Self::row_mut). Several rows then
    /// need [`cells_of`](Self::cells_of) only once.
    pub(super) fn row_in(&mut self, y: i32, touched: u32) -> Option<Row<'_>> {
        let layer = self.layer;
        let words = self.words_in(y, touched)?;
        Some(Row {
            pixels: bytemuck::cast_slice_mut(words),
            layer,
        })
    }

    fn words_in(&mut self, y: i32, touched: u32) -> Option<&mut [u32]> {
        self.cells.get_mut(y as usize)?.touch(self.layer, touched);
        self.words_of(y)
    }

    fn words_of(&mut self, y: i32) -> Option<&mut [u32]> {
        // A negative number becomes a row far beyond the end.
        if y as u32 >= self.format.known().height.into() {
            return None;
        }
        let length = self.format.row_words();
        let rest = self.words.get_mut(y as usize * length..)?;
        rest.get_mut(..length)
    }

    /// Returns the grey that a pixel shows, 0 to 15; `None` outside the canvas.
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        self.pixel(x, y).map(|pixel| Layer::Foreground.grey(pixel))
    }

    /// Returns both layers of a pixel; `None` outside the canvas.
    pub fn pixel(&self, x: i32, y: i32) -> Option<u8> {
        let word = self.row(y as usize).get((x >> 2) as usize)?;
        Some((word >> (8 * (x as u32 & 3))) as u8)
    }

    /// Replaces the grey of a pixel by a function of it. The function is not called for a pixel
    /// outside the canvas.
    pub fn update(&mut self, x: i32, y: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(mut row) = self.row_mut(y, x..x.saturating_add(1)) {
            row.update(x, new);
        }
    }

    /// Sets a rectangle to a grey, except pixels that are brighter.
    #[inline(never)] // Inlined, it takes 1,508 bytes of flash (M3).
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
            self.words_in(y, touched);
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
    #[inline(never)] // Inlined, it takes 336 bytes of flash (M3).
    pub(super) fn stamp_touched(&mut self, x: i32, y: i32, bits: u64, grey: u8) {
        let unit = self.format.units(1);
        let paint = self.layer.paint(grey);

        let mut top = y;
        for squares in bits.to_be_bytes() {
            let end = top.saturating_add(unit);
            if squares != 0 {
                let pixels = stretched(squares, unit) << (x & 3);
                // Negative numbers become rows and words far beyond the end.
                for y in top..end {
                    let Some(words) = self.words_of(y) else {
                        continue;
                    };
                    let mut place = (x >> 2) as usize;
                    let mut pixels = pixels;
                    while pixels != 0 {
                        if let Some(word) = words.get_mut(place) {
                            paint.put(word, pixels);
                        }
                        pixels >>= 4;
                        place = place.wrapping_add(1);
                    }
                }
            }
            top = end;
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
        let width = 4 * self.format.row_words();
        let pixels: &mut [u8] = bytemuck::cast_slice_mut(self.words);
        let mut place = rows.start as usize * width + x as usize;
        for y in rows {
            let (Some(pixel), Some(cells)) =
                (pixels.get_mut(place), self.cells.get_mut(y as usize))
            else {
                return;
            };
            self.layer.lighten(pixel, grey(y));
            cells.touch(self.layer, touched);
            place += width;
        }
    }

    /// Moves the ink to the left by one column. The last column becomes black, and so does column
    /// `left - 1`, where the moving part ends. Columns before it must be black.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn scroll(&mut self, left: i32) {
        self.on_ink();
        let all = self.cells_of(left - 1..self.format.right());
        let first = ((left - 1).max(0) >> 2) as usize;
        for y in 0..self.format.bottom() {
            let Some(words) = self.words_in(y, 0) else {
                return;
            };
            let mut changes = 0;
            let mut from_right = 0;
            for word in words.iter_mut().skip(first).rev() {
                let ink = *word & !FOREGROUND;
                let change = ((ink >> 8) | from_right) ^ ink;
                from_right = ink << 24;
                *word ^= change;
                changes |= change;
            }
            if changes != 0
                && let Some(mut row) = self.row_in(y, all)
            {
                row.update(left - 1, |_| 0);
            }
        }
    }

    /// Clears the ink.
    pub fn clear_ink(&mut self) {
        self.on_ink();
        for y in 0..self.format.bottom() {
            let has_ink = self
                .row(y as usize)
                .iter()
                .any(|word| word & !FOREGROUND != 0);
            let touched = self.cells_of(0..self.format.right());
            if has_ink && let Some(words) = self.words_in(y, touched) {
                words.iter_mut().for_each(|word| *word &= FOREGROUND);
            }
        }
    }

    /// Makes the columns of the present layer black.
    pub fn clear_columns(&mut self, columns: Range<i32>) {
        for y in 0..self.format.bottom() {
            if let Some(mut row) = self.row_mut(y, columns.clone()) {
                columns.clone().for_each(|x| row.set(x, 0));
            }
        }
    }

    /// Fades the next rows by one level each, after the lowest row the top one again; to be called
    /// once a tick of the scene. Ink at or below the level `last` is unchanged.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn fade(&mut self, Fading { rows, last }: Fading) {
        let room = u32::from(15_u8.saturating_sub(last)) * ONES;
        let shift = self.cell_shift() - 2;
        let rows = (u32::from(rows) * u32::from(self.format.known().height) + 32) / 64;

        // A level above `last` carries out of its nibble, and then loses 1.
        for _ in 0..rows {
            let y = usize::from(self.row);
            self.row += 1;
            if self.row >= self.format.known().height {
                self.row = 0;
            }
            let row = self
                .words
                .get_mut(self.format.row_range(y).unwrap_or_default());
            let (Some(row), Some(cells)) = (row, self.cells.get_mut(y)) else {
                continue;
            };
            for (place, word) in row.iter_mut().enumerate() {
                if *word & !FOREGROUND != 0 {
                    let lost = carried(*word >> 4, room);
                    if lost != 0 {
                        *word -= lost << 4;
                        cells.changed |= 1 << (place >> shift);
                    }
                }
            }
        }
    }
}

/// A row of a canvas, for drawing on one layer.
#[derive(Debug)]
pub struct Row<'c> {
    pixels: &'c mut [u8],
    layer: Layer,
}

impl Row<'_> {
    /// Replaces the grey of the pixel in column `x` by a function of it. Only the low four bits of
    /// the result count. The function is not called for a pixel outside the row.
    pub fn update(&mut self, x: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(pixel) = self.pixels.get_mut(x as usize) {
            let old = self.layer.grey(*pixel);
            let new = new(old) & 15;
            if new != old {
                *pixel = self.layer.with(*pixel, new);
            }
        }
    }

    /// Sets a pixel to a grey of 0 to 15. It then covers the ink, also if that has the same grey.
    pub fn set(&mut self, x: i32, grey: u8) {
        if let Some(pixel) = self.pixels.get_mut(x as usize) {
            *pixel = self.layer.with(*pixel, grey);
        }
    }

    /// Sets a pixel to a grey of 0 to 15. A pixel that is brighter already keeps its grey.
    pub fn lighten(&mut self, x: i32, grey: u8) {
        if let Some(pixel) = self.pixels.get_mut(x as usize) {
            self.layer.lighten(pixel, grey);
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

/// Returns the carries of the levels in the low nibbles of the four bytes of `greys`: bit 0 of a
/// byte is 1 if the level plus the summand in the same byte of `room`, 0 to 15, is at least 16. All
/// other bits are 0. The high nibbles are ignored.
pub(super) fn carried(greys: u32, room: u32) -> u32 {
    (((greys & FOREGROUND) + room) >> 4) & ONES
}

/// Returns the squares of a row as pixels, the left one in bit 0.
fn stretched(squares: u8, unit: i32) -> u32 {
    let squares = u32::from(squares.reverse_bits());
    if unit == 1 {
        return squares;
    }
    widened(squares, unit as u32)
}

#[inline(never)] // Inlined, it takes registers from the stamps of a small panel.
fn widened(squares: u32, unit: u32) -> u32 {
    let square = (1 << unit) - 1;
    (0..8)
        .filter(|place| squares >> place & 1 != 0)
        .fold(0, |pixels, place| pixels | square << (unit * place))
}

/// Returns the greys that two words of four pixels show: of the left one in the low nibbles of the
/// bytes, of the right one in the high nibbles.
pub fn visible_pair(left: u32, right: u32) -> u32 {
    const NIBBLES: u32 = 0x1111_1111;
    let ink = (left >> 4) & FOREGROUND | right & !FOREGROUND;
    if (left | right) & FOREGROUND == 0 {
        return ink;
    }
    let foreground = left & FOREGROUND | (right & FOREGROUND) << 4;
    let above_black = foreground >> 1 | foreground >> 2 | foreground >> 3;
    let is_lit = above_black & NIBBLES;
    let is_drawn = (above_black | foreground) & NIBBLES;
    ink & !(15 * is_drawn) | foreground & (15 * is_lit)
}

/// Returns the greys that a word of four pixels shows, one in each byte.
pub fn visible(word: u32) -> u32 {
    let foreground = word & FOREGROUND;
    if foreground == 0 {
        return word >> 4;
    }
    let is_drawn = carried(foreground, 15 * ONES);
    let is_lit = carried(foreground, 14 * ONES);
    ((word >> 4) & FOREGROUND & !(15 * is_drawn)) | (foreground & (15 * is_lit))
}
