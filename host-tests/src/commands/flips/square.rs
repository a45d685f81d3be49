//! The plane of starts, cut into pixels.

/// A rectangle of starts, a1 across and a2 upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Square {
    pub size: [usize; 2],
    pub centre: [f64; 2],
    /// From the middle to each side, rad.
    pub half: f64,
}

impl Square {
    pub fn whole(size: [usize; 2]) -> Self {
        Self { size, centre: [0.0; 2], half: std::f64::consts::PI }
    }

    /// The start at the middle of a pixel, counted from the top left corner.
    pub fn start(&self, [column, row]: [usize; 2]) -> [f32; 2] {
        let Self { size: [width, height], centre: [a1, a2], half } = *self;
        // Twice the pixels from the middle: whole, so that what lies opposite is its mirror image, bit for bit.
        let angle = |pixel: usize, pixels: usize| (2 * pixel as i64 + 1 - pixels as i64) as f64 * half / pixels as f64;
        [(a1 + angle(column, width)) as f32, (a2 - angle(row, height)) as f32]
    }

    /// Rows to compute: the lower half of a rectangle about hanging is the upper one's mirror image, both ways.
    pub fn rows(&self) -> usize {
        let [_, height] = self.size;
        if self.centre == [0.0; 2] { height.div_ceil(2) } else { height }
    }

    /// Where in the computed rows a pixel is.
    pub fn place(&self, [column, row]: [usize; 2]) -> usize {
        let [width, height] = self.size;
        if row < self.rows() { row * width + column } else { (height - 1 - row) * width + width - 1 - column }
    }
}
