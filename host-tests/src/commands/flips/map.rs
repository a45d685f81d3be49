//! The plane of starts, cut into pixels, and the map computed: in threads, lanes and two steps.

use double_pendulum::flips::{Flip, step_size};
use double_pendulum::{Error, Parameters};
use firmware::scenes::flips::GREYS;
use rayon::prelude::*;
use vectors::{Search, flips};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The pendulum; its gravity is its l1, so that times are in sqrt(l1/g).
    pub parameters: Parameters<f32>,
    /// The step, sqrt(l1/g).
    pub dt: f64,
    /// How long is waited, sqrt(l1/g).
    pub limit: f32,
    pub square: Square,
}

/// A start's flip with the step, and with half of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// What is shown.
    pub flip: Flip<f32>,
    /// What it is held against.
    pub check: Flip<f32>,
}

/// Starts that a thread follows by itself; the more, the fewer lanes are idle at its end.
const PORTION: usize = 8192;

impl Map {
    /// The search with the step divided by `finer`.
    pub fn search(&self, finer: u32) -> Result<Search, Error> {
        let dt = self.dt / f64::from(finer);
        Search::new(&self.parameters, dt, (f64::from(self.limit) / dt).ceil() as u32)
    }

    /// A pendulum's map with the step that suits it, for a time `limit`, sqrt(l1/g), of the pendulum's l1 being its g.
    pub fn new(parameters: Parameters<f32>, limit: f32, square: Square) -> Result<Self, Error> {
        Ok(Self { parameters, dt: step_size(&parameters)?, limit, square })
    }

    /// Row by row; of a whole square, the upper half.
    pub fn starts(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        let [width, _] = self.square.size;
        (0..self.square.rows()).flat_map(move |row| (0..width).map(move |column| self.square.start([column, row])))
    }

    /// What becomes of each; `tick` is told how many more are done.
    pub fn points(&self, tick: impl Fn(usize) + Sync) -> Result<Vec<Followed>, Error> {
        let starts: Vec<[f32; 2]> = self.starts().collect();
        let searches = [self.search(1)?, self.search(2)?];
        let portions = starts.par_chunks(PORTION).map(|portion| {
            let [flips, checks] = [flips(&searches[0], portion)?, flips(&searches[1], portion)?];
            tick(portion.len());
            Ok(flips.into_iter().zip(checks).map(|(flip, check)| Followed { flip, check }).collect::<Vec<_>>())
        });
        Ok(portions.collect::<Result<Vec<_>, Error>>()?.concat())
    }

    /// Whether its two times are farther apart than a grey level of the panel.
    pub fn is_in_doubt(&self, Followed { flip, check }: Followed) -> bool {
        self.differ(flip, check)
    }

    /// Whether two flips are farther apart than a grey level; none at all counts as at the limit.
    pub fn differ(&self, one: Flip<f32>, other: Flip<f32>) -> bool {
        if [one, other].contains(&Flip::Never) {
            return one != other;
        }
        let level = |flip| self.share(flip).unwrap_or(1.0) * f32::from(GREYS);
        (level(one) - level(other)).abs() > 1.0
    }

    /// How far a flip is on the logarithmic scale from sqrt(l1/g) to the limit, 0 to 1; none without one.
    pub fn share(&self, flip: Flip<f32>) -> Option<f32> {
        match flip {
            Flip::After(time) => Some((time.ln() / self.limit.ln()).clamp(0.0, 1.0)),
            Flip::Never | Flip::Later => None,
        }
    }
}

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
