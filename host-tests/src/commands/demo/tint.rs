//! The panel's colour: the evaluation board's OLED glows yellow.

use ratatui::style::Color;

/// Red, green and blue of the brightest grey.
const BRIGHTEST: [u32; 3] = [255, 200, 64];
/// Of black: the panel's glass is not quite dark.
const DARKEST: [u32; 3] = [10, 8, 4];
/// The greys, 0 to this.
const BRIGHTEST_GREY: u8 = 15;
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

/// The same in a terminal.
pub fn in_terminal(grey: u8) -> Color {
    Color::Indexed(TERMINAL[usize::from(grey.min(BRIGHTEST_GREY))])
}

/// The colours of all greys in a row, red, green, blue, as image files want them.
pub fn palette() -> Vec<u8> {
    (0..=BRIGHTEST_GREY).flat_map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red, green and blue of one of the 256: a cube of 6 x 6 x 6 colours from 16 on, 24 greys from 232 on.
    fn cube(index: u8) -> [u32; 3] {
        let level = |step: u8| if step == 0 { 0 } else { 55 + 40 * u32::from(step) };
        match index {
            232.. => [8 + 10 * u32::from(index - 232); 3],
            _ => [(index - 16) / 36, (index - 16) / 6 % 6, (index - 16) % 6].map(level),
        }
    }

    #[test]
    fn in_a_terminal_brighter_is_never_darker_and_every_hue_is_amber() {
        let luminance =
            |index: u8| cube(index).into_iter().zip([299, 587, 114]).map(|(c, weight)| c * weight).sum::<u32>();
        assert!(TERMINAL.is_sorted_by_key(|&index| luminance(index)), "{:?}", TERMINAL.map(luminance));
        for [red, green, blue] in TERMINAL.map(cube) {
            let is_grey = red == green && green == blue && red < 90;
            assert!(is_grey || (red * 7 >= green * 8 && green * 2 > red && blue < green), "{red} {green} {blue}");
        }
    }
}
