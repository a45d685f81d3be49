//! The colours of a colour panel: a table with an entry for each pair of ink and foreground.
//!
//! Ramps grow brighter from level to level, so that they can be read without telling hues apart.
//! Two pendulums are orange and blue, which differ for every kind of colour blindness.

/// The colours of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Ink from violet to yellow under a white foreground.
    #[default]
    Trail,
    /// As `Trail`, and dim parts of the foreground are blue: a second pendulum.
    Two,
    /// A picture, such as the map of flips: 16 colours of ink. All its greys matter, so that a
    /// panel of one colour shows them as patterns ([`Bitmap`](crate::graphics::Bitmap)).
    Map,
}

type Rgb = [u8; 3];
/// Colours at some levels; those between are mixed.
type Ramp<const N: usize> = [(u8, Rgb); N];

const NIGHT: Rgb = [4, 6, 16];
const TRAIL: Ramp<6> = [
    (0, NIGHT),
    (4, [84, 38, 140]),
    (7, [186, 44, 124]),
    (9, [244, 104, 70]),
    (11, [255, 206, 96]),
    (15, [255, 236, 170]),
];
const WHITE: Ramp<2> = [(0, NIGHT), (15, [246, 249, 255])];
const BLUE_AND_WHITE: Ramp<5> = [
    (0, NIGHT),
    (6, [40, 140, 255]),
    (8, [96, 136, 178]),
    (11, [190, 196, 206]),
    (15, [246, 249, 255]),
];
/// Flips: never is black, later is grey, and the sooner, the brighter.
const MAP: Ramp<8> = [
    (0, [0, 0, 0]),
    (1, [26, 28, 40]),
    (2, [44, 16, 92]),
    (5, [112, 30, 132]),
    (8, [190, 54, 106]),
    (11, [244, 110, 62]),
    (13, [253, 180, 66]),
    (15, [252, 250, 180]),
];

const fn mixed<const N: usize>(ramp: Ramp<N>) -> [Rgb; 16] {
    let mut colours = [[0; 3]; 16];
    let mut level = 0;
    while level < 16 {
        let mut above = 1;
        while above + 1 < N && (ramp[above].0 as usize) < level {
            above += 1;
        }
        let (from, low) = ramp[above - 1];
        let (to, high) = ramp[above];
        let mut part = 0;
        while part < 3 {
            let rise = high[part] as i32 - low[part] as i32;
            let steps = level as i32 - from as i32;
            colours[level][part] = (low[part] as i32 + rise * steps / (to - from) as i32) as u8;
            part += 1;
        }
        level += 1;
    }
    colours
}

/// Returns the table of a palette. The foreground covers the ink, and each part of its colour is at
/// least that of the ink, so that soft edges have no dark fringe. Where it is darker than the ink,
/// as around a bob, the colour is that of fainter ink, or of the foreground if `is_darker_own`.
const fn table(ink: [Rgb; 16], foreground: [Rgb; 16], is_darker_own: bool) -> [u16; 256] {
    let mut table = [0; 256];
    let mut pixel = 0;
    while pixel < 256 {
        let below = pixel >> 4;
        let level = pixel & 15;
        let mut colour = ink[below];
        if level == 1 {
            colour = ink[0];
        } else if level > 1 && level < below {
            colour = if is_darker_own {
                foreground[level]
            } else {
                ink[level]
            };
        } else if level > 1 {
            let mut part = 0;
            while part < 3 {
                if foreground[level][part] > colour[part] {
                    colour[part] = foreground[level][part];
                }
                part += 1;
            }
        }
        let [red, green, blue] = colour;
        table[pixel] = (red as u16 >> 3) << 11 | (green as u16 >> 2) << 5 | blue as u16 >> 3;
        pixel += 1;
    }
    table
}

static TRAIL_COLOURS: [u16; 256] = table(mixed(TRAIL), mixed(WHITE), false);
static TWO_COLOURS: [u16; 256] = table(mixed(TRAIL), mixed(BLUE_AND_WHITE), true);
static MAP_COLOURS: [u16; 256] = table(mixed(MAP), mixed(WHITE), false);

impl Palette {
    /// Returns the colour of each pixel of two layers: five bits of red, six of green, five of
    /// blue.
    pub fn colours(self) -> &'static [u16; 256] {
        match self {
            Self::Trail => &TRAIL_COLOURS,
            Self::Two => &TWO_COLOURS,
            Self::Map => &MAP_COLOURS,
        }
    }
}

/// Returns the red, green and blue of a panel's colour, 0 to 255 each.
pub fn rgb(colour: u16) -> Rgb {
    let [red, green, blue] = [colour >> 11, colour >> 5 & 63, colour & 31];
    [
        (red << 3 | red >> 2) as u8,
        (green << 2 | green >> 4) as u8,
        (blue << 3 | blue >> 2) as u8,
    ]
}
