//! The plane of starts, cut into pixels, and the map computed: in threads, lanes and two steps.

use double_pendulum::flips::{Flip, step_size};
use double_pendulum::{Error, Parameters};
use firmware::scenes::flips::GREYS;
use rayon::prelude::*;
use vectors::{Search, flips};

/// A rectangle of starts, a1 across and a2 upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The pendulum; its gravity is its l1, so that times are in sqrt(l1/g).
    pub parameters: Parameters<f32>,
    /// The step, sqrt(l1/g).
    pub dt: f64,
    /// How long is waited, sqrt(l1/g).
    pub limit: f32,
    /// Pixels across and down.
    pub size: [usize; 2],
    /// The start in the middle, rad.
    pub centre: [f64; 2],
    /// From the middle to each side, rad.
    pub half: f64,
    /// With the step, and with half of it.
    pub searches: [Search; 2],
}

/// A start's flip with the step, which is shown, and with half of it, which it is held against.
pub type FlipPair = [Flip<f32>; 2];

/// Starts that a thread follows by itself; the more, the fewer lanes are idle at its end. Fewer
/// where each takes long, so that a portion ends every few seconds and progress is reported.
const PORTION: usize = 8192;
const LEAST_PORTION: usize = 64;
/// The steps of a portion.
const PORTION_STEPS: f64 = 1e9;

impl Map {
    /// All starts, with the step that suits the pendulum, for a time `limit`, sqrt(l1/g), of the pendulum's l1 being its g.
    pub fn new(parameters: Parameters<f32>, limit: f32, size: [usize; 2]) -> Result<Self, Error> {
        let dt = step_size(&parameters)?;
        let search = |dt: f64| Search::new(&parameters, dt, (f64::from(limit) / dt).ceil() as u32);
        let searches = [search(dt)?, search(dt / 2.0)?];
        Ok(Self {
            parameters,
            dt,
            limit,
            size,
            centre: [0.0; 2],
            half: std::f64::consts::PI,
            searches,
        })
    }

    /// Returns the most steps that a start takes, with the step and with half of it.
    pub fn steps(&self) -> f64 {
        3.0 * f64::from(self.limit) / self.dt
    }

    /// Rows to compute: the lower half of a rectangle about hanging is the upper one's mirror image, both ways.
    pub fn rows(&self) -> usize {
        let [_, height] = self.size;
        if self.centre == [0.0; 2] {
            height.div_ceil(2)
        } else {
            height
        }
    }

    /// The pixels of so many rows, row by row from the top left corner.
    fn pixels(&self, rows: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [width, _] = self.size;
        (0..rows).flat_map(move |row| (0..width).map(move |column| [column, row]))
    }

    /// The start at the middle of a pixel.
    pub fn start(&self, [column, row]: [usize; 2]) -> [f32; 2] {
        let Self {
            size: [width, height],
            centre: [a1, a2],
            half,
            ..
        } = *self;
        // Twice the pixels from the middle: whole, so that what lies opposite is its mirror image, bit for bit.
        let angle = |pixel: usize, pixels: usize| {
            (2 * pixel as i64 + 1 - pixels as i64) as f64 * half / pixels as f64
        };
        [
            (a1 + angle(column, width)) as f32,
            (a2 - angle(row, height)) as f32,
        ]
    }

    /// Those to compute.
    pub fn starts(&self) -> Vec<[f32; 2]> {
        self.pixels(self.rows())
            .map(|pixel| self.start(pixel))
            .collect()
    }

    /// What becomes of each; `tick` is told how many more are done.
    pub fn points(&self, tick: impl Fn(usize) + Sync) -> Result<Vec<FlipPair>, Error> {
        let (starts, [search, finer]) = (self.starts(), &self.searches);
        let portion = ((PORTION_STEPS / self.steps()) as usize).clamp(LEAST_PORTION, PORTION);
        let portions = starts.par_chunks(portion).map(|portion| {
            let [flips, checks] = [flips(search, portion)?, flips(finer, portion)?];
            tick(portion.len());
            Ok(flips
                .into_iter()
                .zip(checks)
                .map(FlipPair::from)
                .collect::<Vec<_>>())
        });
        Ok(portions.collect::<Result<Vec<_>, Error>>()?.concat())
    }

    /// All pixels with what has become of their starts.
    pub fn shown(&self, points: &[FlipPair]) -> impl Iterator<Item = ([usize; 2], FlipPair)> {
        let (rows, [width, height]) = (self.rows(), self.size);
        self.pixels(height).map(move |[column, row]| {
            let [x, y] = if row < rows {
                [column, row]
            } else {
                [width - 1 - column, height - 1 - row]
            };
            ([column, row], points[y * width + x])
        })
    }

    /// Whether two flips are farther apart than a grey level of the panel; none at all counts as at the limit. With half the step,
    /// it is in doubt.
    pub fn differ(&self, [one, other]: FlipPair) -> bool {
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
