//! The panel in the terminal: where it fits, a pixel is half a character, in its grey; else eight pixels or more are a character,
//! whose dots are those that are lit, in the colour of the brightest.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Color;
use ratatui::symbols::Marker;
use ratatui::widgets::canvas::{Canvas, Points};

use crate::emulator::qemu::{HEIGHT, Screenshot, WIDTH};

/// The grey from which a dot is set: all but the end of a fading trail.
const SET: u8 = 3;

pub fn draw(frame: &mut Frame, area: Rect, screenshot: &Screenshot) {
    let in_greys = usize::from(area.width) >= WIDTH;
    let canvas = Canvas::default().marker(if in_greys { Marker::HalfBlock } else { Marker::Braille });
    let canvas = canvas.x_bounds([0.0, WIDTH as f64 - 1.0]).y_bounds([1.0 - HEIGHT as f64, 0.0]);
    let canvas = canvas.paint(|context| {
        // The brightest last: it gives a character its colour.
        for grey in if in_greys { 0 } else { SET }..=BRIGHTEST_GREY {
            let lit = screenshot.greys.iter().enumerate().filter(|(_, pixel)| **pixel == grey);
            let coords: Vec<_> = lit.map(|(i, _)| ((i % WIDTH) as f64, -((i / WIDTH) as f64))).collect();
            context.draw(&Points { coords: &coords, color: in_terminal(grey) });
        }
    });
    frame.render_widget(canvas, area);
}

pub const BRIGHTEST_GREY: u8 = 15;
/// Its red, green and blue, and black's: the panel's glass is not quite dark.
const BRIGHTEST: [u32; 3] = [255, 200, 64];
const DARKEST: [u32; 3] = [10, 8, 4];
/// The greys among the 256 colours that terminals have in common: black, a few too dark to have a hue, then amber. Chosen by
/// hand, for by distance the dark ones would come out olive and red.
const TERMINAL: [u8; 16] = [16, 233, 234, 235, 237, 239, 94, 94, 130, 136, 136, 172, 178, 214, 214, 221];

fn in_terminal(grey: u8) -> Color {
    Color::Indexed(TERMINAL[usize::from(grey.min(BRIGHTEST_GREY))])
}

/// The colours of all greys in a row, red, green, blue, as image files want them.
pub fn palette() -> Vec<u8> {
    let most = u32::from(BRIGHTEST_GREY);
    let mix =
        |grey: u32| DARKEST.into_iter().zip(BRIGHTEST).map(move |(dark, bright)| dark + (bright - dark) * grey / most);
    (0..=most).flat_map(mix).map(|channel| channel as u8).collect()
}

#[cfg(test)]
mod tests {
    use firmware::graphics::Canvas;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;
    use ratatui::style::Color;

    use super::*;

    /// The characters of a panel with three pixels, in which anything is, and their colours.
    fn drawn(width: u16) -> Vec<(String, Color, Color)> {
        let mut canvas = Canvas::default();
        [(0, 0, 15), (3, 2, 15), (127, 63, 6)].into_iter().for_each(|(x, y, grey)| canvas.update(x, y, |_| grey));
        let mut terminal = Terminal::new(TestBackend::new(width, width / 4)).expect("a terminal of characters");
        terminal.draw(|frame| draw(frame, frame.area(), &Screenshot::from(&canvas))).expect("it is drawn");
        let cells = terminal.backend().buffer().content();
        let lit = cells.iter().filter(|cell| ![" ", "█"].contains(&cell.symbol()));
        lit.map(|cell| (cell.symbol().to_owned(), cell.fg, cell.bg)).collect()
    }

    #[test]
    fn what_is_lit_is_a_dot_or_a_pixel_in_its_colour() {
        let dots = [("⠁", 15), ("⠠", 15), ("⢀", 6)];
        assert_eq!(drawn(64), dots.map(|(dot, grey)| (dot.to_owned(), in_terminal(grey), Color::Reset)));
        let pixels = [[15, 0], [15, 0], [0, 6]].map(|greys| greys.map(in_terminal));
        assert_eq!(drawn(128), pixels.map(|[above, below]| ("▀".to_owned(), above, below)));
    }
}
