//! The panel as a widget: two pixels a character, by the upper half block.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::widgets::Widget;

use super::tint;
use crate::emulator::qemu::{HEIGHT, Screenshot, WIDTH};

/// Finer steps than the panel's own, for averages.
const LEVELS: u16 = 240;

/// How many colours the terminal has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// 24 bits.
    True,
    /// The usual 256.
    Indexed,
}

impl Depth {
    /// As the environment tells.
    pub fn of_terminal() -> Self {
        let named = std::env::var("COLORTERM").unwrap_or_default();
        if named == "truecolor" || named == "24bit" { Self::True } else { Self::Indexed }
    }

    /// The terminal's colour nearest to `level` of [`LEVELS`].
    fn colour(self, level: u16) -> Color {
        let [red, green, blue] = tint::blend(level, LEVELS);
        match self {
            Self::True => Color::Rgb(red, green, blue),
            Self::Indexed => {
                // A cube of 6 x 6 x 6 colours begins at index 16; its levels are 0, 95, 135, 175, 215, 255.
                let step = |channel: u8| if channel < 48 { 0 } else { (u16::from(channel).saturating_sub(35)) / 40 };
                Color::Indexed((16 + 36 * step(red) + 6 * step(green) + step(blue)) as u8)
            }
        }
    }
}

/// The panel, scaled down by averaging to fill its area.
#[derive(Debug)]
pub struct Panel<'a> {
    /// What it shows.
    pub screenshot: &'a Screenshot,
    /// In which colours.
    pub depth: Depth,
}

impl Panel<'_> {
    /// The mean grey of the part of the panel that the dot `x`, `y` of `width` by `height` dots covers, in [`LEVELS`].
    fn level(&self, (x, y): (usize, usize), (width, height): (usize, usize)) -> u16 {
        let span = |i: usize, dots: usize, pixels: usize| {
            let start = i * pixels / dots;
            start..((i + 1) * pixels).div_ceil(dots).max(start + 1)
        };
        let (columns, rows) = (span(x, width, WIDTH), span(y, height, HEIGHT));
        let count = columns.len() * rows.len();
        let sum: usize = rows.flat_map(|y| columns.clone().map(move |x| usize::from(self.screenshot.grey(x, y)))).sum();
        (sum * usize::from(LEVELS) / (15 * count)) as u16
    }
}

impl Widget for Panel<'_> {
    fn render(self, area: Rect, buffer: &mut Buffer) {
        let size = (usize::from(area.width), 2 * usize::from(area.height));
        for row in 0..area.height {
            for column in 0..area.width {
                let dot = |below: usize| {
                    let place = (usize::from(column), 2 * usize::from(row) + below);
                    self.depth.colour(self.level(place, size))
                };
                if let Some(cell) = buffer.cell_mut((area.x + column, area.y + row)) {
                    cell.set_char('▀').set_fg(dot(0)).set_bg(dot(1));
                }
            }
        }
    }
}
