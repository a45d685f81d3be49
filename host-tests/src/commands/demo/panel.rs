//! The panel as a widget: in greys where it fits pixel by pixel, two to a character by the upper half block; else by Braille
//! patterns, eight dots to a character, each in the colour of its brightest dot.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::widgets::Widget;

use super::tint;
use crate::emulator::qemu::{HEIGHT, Screenshot, WIDTH};

/// The grey from which a dot of a Braille pattern is set: all but the end of a fading trail where a dot is a pixel or less, and
/// where it is more what fills a third of it, or letters would run together.
const SET: u8 = 3;
const SET_SMALL: u8 = 5;
/// A Braille pattern's bits, row by row.
const BRAILLE: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
const BLANK: u32 = 0x2800;

/// The panel, scaled down by averaging to fill its area.
#[derive(Debug)]
pub struct Panel<'a> {
    pub screenshot: &'a Screenshot,
    /// Whether there are colours for greys.
    pub colours: bool,
}

impl Panel<'_> {
    /// The mean grey of the part of the panel that the dot `x`, `y` of `width` by `height` dots covers.
    fn grey(&self, (x, y): (usize, usize), (width, height): (usize, usize)) -> u8 {
        let span = |i: usize, dots: usize, pixels: usize| {
            let start = i * pixels / dots;
            start..((i + 1) * pixels).div_ceil(dots).max(start + 1)
        };
        let (columns, rows) = (span(x, width, WIDTH), span(y, height, HEIGHT));
        let count = columns.len() * rows.len();
        let sum: usize = rows.flat_map(|y| columns.clone().map(move |x| usize::from(self.screenshot.grey(x, y)))).sum();
        (sum / count) as u8
    }

    /// The Braille pattern at `column`, `row` of `area`, and its brightest grey.
    fn pattern(&self, (column, row): (u16, u16), area: Rect) -> (char, u8) {
        let size = (2 * usize::from(area.width), 4 * usize::from(area.height));
        let set = if size.0 < WIDTH { SET_SMALL } else { SET };
        let (mut pattern, mut brightest) = (BLANK, 0);
        for (bits, y) in BRAILLE.iter().zip(4 * usize::from(row)..) {
            for (bit, x) in bits.iter().zip(2 * usize::from(column)..) {
                let grey = self.grey((x, y), size);
                pattern += if grey >= set { *bit } else { 0 };
                brightest = grey.max(brightest);
            }
        }
        (char::from_u32(pattern).unwrap_or(' '), brightest)
    }
}

impl Widget for Panel<'_> {
    fn render(self, area: Rect, buffer: &mut Buffer) {
        let in_greys = self.colours && usize::from(area.width) >= WIDTH;
        let size = (usize::from(area.width), 2 * usize::from(area.height));
        for (column, row) in (0..area.height).flat_map(|row| (0..area.width).map(move |column| (column, row))) {
            let Some(cell) = buffer.cell_mut((area.x + column, area.y + row)) else { continue };
            if in_greys {
                let (x, y) = (usize::from(column), 2 * usize::from(row));
                let [above, below] = [y, y + 1].map(|y| tint::in_terminal(self.grey((x, y), size)));
                cell.set_char('▀').set_fg(above).set_bg(below);
            } else {
                let (pattern, grey) = self.pattern((column, row), area);
                cell.set_char(pattern);
                if self.colours {
                    cell.set_fg(tint::in_terminal(grey));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use firmware::graphics::canvas::Canvas;
    use ratatui::style::Color;

    use super::*;

    /// Three pixels of a dark panel, drawn `width` columns wide.
    fn drawn(width: u16, colours: bool) -> Buffer {
        let mut canvas = Canvas::default();
        [(0, 0, 15), (3, 2, 15), (127, 63, 6)].into_iter().for_each(|(x, y, grey)| canvas.update(x, y, |_| grey));
        let area = Rect::new(0, 0, width, width / 4);
        let mut buffer = Buffer::empty(area);
        Panel { screenshot: &Screenshot::from(&canvas), colours }.render(area, &mut buffer);
        buffer
    }

    #[test]
    fn what_is_lit_is_a_dot_or_a_pixel_in_its_colour() {
        for colours in [true, false] {
            let buffer = drawn(64, colours);
            let lit: Vec<_> = buffer.content().iter().filter(|cell| cell.symbol() != "\u{2800}").collect();
            assert_eq!(lit.iter().map(|cell| cell.symbol()).collect::<String>(), "⠁⠠⢀");
            let expected = [15, 15, 6].map(|grey| if colours { tint::in_terminal(grey) } else { Color::Reset });
            assert_eq!(lit.iter().map(|cell| cell.fg).collect::<Vec<_>>(), expected);
        }
        let buffer = drawn(128, true);
        for (x, y, greys) in [(0, 0, [15, 0]), (3, 1, [15, 0]), (127, 31, [0, 6])] {
            let colours = buffer.cell((x, y)).map(|cell| [cell.fg, cell.bg]);
            assert_eq!(colours, Some(greys.map(tint::in_terminal)), "{x}, {y}");
        }
    }
}
