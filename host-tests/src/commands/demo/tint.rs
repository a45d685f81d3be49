//! The panel's colour: the evaluation board's OLED glows yellow.

use ratatui::style::Color;

/// Red, green and blue of the brightest grey.
const BRIGHTEST: [u32; 3] = [255, 200, 64];
/// Of black: the panel's glass is not quite dark.
const DARKEST: [u32; 3] = [10, 8, 4];
pub const BRIGHTEST_GREY: u8 = 15;
/// The same among the 256 colours that terminals have in common: black, a few greys too dark to have a hue, then amber. Chosen
/// by hand, for by distance the dark ones would come out olive and red.
const TERMINAL: [u8; 16] = [16, 233, 234, 235, 237, 239, 94, 94, 130, 136, 136, 172, 178, 214, 214, 221];

/// The colour of a grey of 0 to 15.
pub fn colour(grey: u8) -> [u8; 3] {
    let grey = grey.min(BRIGHTEST_GREY);
    std::array::from_fn(|channel| {
        let (dark, bright) = (DARKEST[channel], BRIGHTEST[channel]);
        (dark + (bright - dark) * u32::from(grey) / u32::from(BRIGHTEST_GREY)) as u8
    })
}

pub fn in_terminal(grey: u8) -> Color {
    Color::Indexed(TERMINAL[usize::from(grey.min(BRIGHTEST_GREY))])
}

/// The colours of all greys in a row, red, green, blue, as image files want them.
pub fn palette() -> Vec<u8> {
    (0..=BRIGHTEST_GREY).flat_map(colour).collect()
}
