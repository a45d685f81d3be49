//! The panel's colour: the evaluation board's OLED glows yellow.

/// Red, green and blue of the brightest grey.
const BRIGHTEST: [u16; 3] = [255, 200, 64];
/// Of black: the panel's glass is not quite dark.
const DARKEST: [u16; 3] = [10, 8, 4];
/// The greys, 0 to this.
const LEVELS: u16 = 15;

/// The colour of a grey of 0 to 15.
pub fn colour(grey: u8) -> [u8; 3] {
    blend(u16::from(grey), LEVELS)
}

/// The colour at `level` of `levels` between darkest and brightest.
pub fn blend(level: u16, levels: u16) -> [u8; 3] {
    let level = u32::from(level.min(levels));
    std::array::from_fn(|channel| {
        let (dark, bright) = (u32::from(DARKEST[channel]), u32::from(BRIGHTEST[channel]));
        (dark + (bright - dark) * level / u32::from(levels)) as u8
    })
}

/// The colours of all greys in a row, red, green, blue, as image files want them.
pub fn palette() -> Vec<u8> {
    (0..=LEVELS as u8).flat_map(colour).collect()
}
