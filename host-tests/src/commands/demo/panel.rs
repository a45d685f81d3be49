//! The panel as a widget: in colours two dots a character, by the upper half block; without, eight, by Braille patterns.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
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
    /// The first 16.
    Sixteen,
    /// None, or none are wanted.
    None,
}

impl Depth {
    /// As the environment tells.
    pub fn of_terminal() -> Self {
        Self::of(|name| std::env::var(name).unwrap_or_default())
    }

    /// As environment variables tell: <https://no-color.org>, and what terminals call themselves.
    fn of(variable: impl Fn(&str) -> String) -> Self {
        let terminal = variable("TERM");
        let is_named = |names: &[&str]| names.contains(&terminal.as_str());
        if !variable("NO_COLOR").is_empty()
            || is_named(&["", "dumb"])
            || terminal.starts_with("vt")
            || terminal.ends_with("-m")
            || terminal.ends_with("-mono")
        {
            Self::None
        } else if ["truecolor", "24bit"].contains(&variable("COLORTERM").as_str()) || terminal.ends_with("-direct") {
            Self::True
        } else if is_named(&["linux", "ansi", "cygwin", "screen", "xterm", "xterm-color", "rxvt"]) {
            Self::Sixteen
        } else {
            Self::Indexed
        }
    }

    /// A style with this colour for the text, where there are colours.
    pub fn style(self, colour: Color) -> Style {
        if self == Self::None { Style::new() } else { Style::new().fg(colour) }
    }

    /// The terminal's colour nearest to `level` of [`LEVELS`].
    fn colour(self, level: u16) -> Color {
        let [red, green, blue] = tint::blend(level, LEVELS);
        match self {
            Self::None => Color::Reset,
            Self::True => Color::Rgb(red, green, blue),
            // The colours of the panel's greys are four: of the 16, these are nearest.
            Self::Sixteen => [Color::Black, Color::DarkGray, Color::Yellow, Color::LightYellow]
                [usize::from((4 * level / LEVELS).min(3))],
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

/// The level from which a dot of a Braille pattern is set: all but the end of a fading trail where a dot is a pixel or less,
/// and where it is more what fills a third of it, or letters would run together.
const SET: u16 = LEVELS / 6;
const SET_SMALL: u16 = LEVELS / 3;
/// A Braille pattern's bits, row by row.
const BRAILLE: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
/// The pattern of no dot.
const BLANK: u32 = 0x2800;

impl Panel<'_> {
    /// The Braille pattern at `column`, `row` of `area`.
    fn pattern(&self, (column, row): (u16, u16), area: Rect) -> char {
        let size = (2 * usize::from(area.width), 4 * usize::from(area.height));
        let set = if size.0 < WIDTH { SET_SMALL } else { SET };
        let dots = BRAILLE.iter().zip(4 * usize::from(row)..).flat_map(|(bits, y)| {
            let across = bits.iter().zip(2 * usize::from(column)..);
            across.map(move |(bit, x)| if self.level((x, y), size) >= set { *bit } else { 0 })
        });
        char::from_u32(BLANK + dots.sum::<u32>()).unwrap_or(' ')
    }
}

impl Widget for Panel<'_> {
    fn render(self, area: Rect, buffer: &mut Buffer) {
        if self.depth == Depth::None {
            for (column, row) in (0..area.height).flat_map(|row| (0..area.width).map(move |column| (column, row))) {
                if let Some(cell) = buffer.cell_mut((area.x + column, area.y + row)) {
                    cell.set_char(self.pattern((column, row), area));
                }
            }
            return;
        }
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

#[cfg(test)]
mod tests {
    use firmware::graphics::canvas::Canvas;

    use super::*;

    fn depth(variables: &[(&str, &str)]) -> Depth {
        let value = |name: &str| variables.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        Depth::of(|name| value(name).unwrap_or_default().to_owned())
    }

    #[test]
    fn colours_are_those_the_terminal_has_and_the_user_wants() {
        assert_eq!(depth(&[("TERM", "xterm-256color"), ("COLORTERM", "truecolor")]), Depth::True);
        assert_eq!(depth(&[("TERM", "tmux-256color")]), Depth::Indexed);
        assert_eq!(depth(&[("TERM", "linux")]), Depth::Sixteen);
        for terminal in ["vt100", "vt220", "dumb", "xterm-mono", ""] {
            assert_eq!(depth(&[("TERM", terminal)]), Depth::None, "{terminal}");
        }
        let unwanted = [("TERM", "xterm-256color"), ("COLORTERM", "truecolor"), ("NO_COLOR", "1")];
        assert_eq!(depth(&unwanted), Depth::None);
    }

    #[test]
    fn without_colours_what_is_lit_is_a_dot_and_what_is_dark_is_none() {
        let mut canvas = Canvas::default();
        let lit = [(0, 0), (3, 2), (127, 63)];
        lit.into_iter().for_each(|(x, y)| canvas.update(x, y, |_| 15));
        let area = Rect::new(0, 0, 64, 16);
        let mut buffer = Buffer::empty(area);
        Panel { screenshot: &Screenshot::from(&canvas), depth: Depth::None }.render(area, &mut buffer);
        let drawn: Vec<_> = buffer.content().iter().filter(|cell| cell.symbol() != "\u{2800}").collect();
        assert_eq!(drawn.iter().map(|cell| cell.symbol()).collect::<String>(), "⠁⠠⢀");
        assert!(buffer.content().iter().all(|cell| (cell.fg, cell.bg) == (Color::Reset, Color::Reset)));
    }
}
