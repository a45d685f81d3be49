//! The plane of starts, divided into pixels, and the computation of the map in threads, vector
//! lanes and two step sizes.

use double_pendulum::flips::{Flip, step_size};
use double_pendulum::{Error, Parameters};
use firmware::scenes::flips::GREYS;
use rayon::prelude::*;
use vectors::{Search, flips};

/// A rectangle of starts, a1 across and a2 upwards. The fields are not checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The pendulum. Its gravity, m/s^2, is the same number as its l1, m, so that sqrt(l1/g) is 1
    /// s.
    pub parameters: Parameters<f32>,
    /// The step of the first search, sqrt(l1/g).
    pub dt: f64,
    /// The time limit, sqrt(l1/g), more than 1.
    pub limit: f32,
    /// Pixels across and down, each at least 1.
    pub size: [usize; 2],
    /// The start in the middle of the map, a1, a2 in rad.
    pub centre: [f64; 2],
    /// The distance from the middle to the ends of the longer side, rad.
    pub half: f64,
    /// The searches with the step and with half of it. Both end at the limit, rounded up to whole
    /// steps.
    pub searches: [Search; 2],
}

/// A start's flip with the step, which is shown, and with half of it, which is used for comparison.
/// Times are in sqrt(l1/g).
pub type FlipPair = [Flip<f32>; 2];

/// The number of starts that a thread computes together. With a larger number, fewer lanes are idle
/// at its end. It is smaller if each start takes long, so that a portion ends every few seconds and
/// progress is reported.
const PORTION: usize = 8192;
const LEAST_PORTION: usize = 64;
/// The number of steps in a portion.
const PORTION_STEPS: f64 = 1e9;

impl Map {
    /// Returns the map of all starts, from -pi to pi in both angles, with the step of
    /// [`step_size`], up to the time `limit`, sqrt(l1/g). An error means that the kernel refuses
    /// the pendulum, or that `f32` cannot represent its modes or the step. Not checked: the gravity
    /// must equal l1, `limit` must exceed 1 and be finite, and `size` must not contain 0.
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

    /// Returns the largest number of steps of a start, with the step and with half of it together.
    /// It is three times the limit over the step, not rounded to whole steps.
    pub fn steps(&self) -> f64 {
        3.0 * f64::from(self.limit) / self.dt
    }

    /// Returns the number of rows to compute: all, or, if the middle of the map is the hanging
    /// position, only the upper half, with the middle row of an odd number. The lower half is then
    /// the upper half mirrored in both directions.
    pub fn rows(&self) -> usize {
        let [_, height] = self.size;
        if self.centre == [0.0; 2] {
            height.div_ceil(2)
        } else {
            height
        }
    }

    /// Returns the pixels of `rows` rows, row by row from the top left corner.
    fn pixels(&self, rows: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [width, _] = self.size;
        (0..rows).flat_map(move |row| (0..width).map(move |column| [column, row]))
    }

    /// Returns the start at the middle of a pixel. `[0, 0]` is the top left pixel; the result is
    /// a1, a2 in rad. Not checked: the pixel must be in the map.
    pub fn start(&self, [column, row]: [usize; 2]) -> [f32; 2] {
        let Self {
            size: [width, height],
            centre: [a1, a2],
            half,
            ..
        } = *self;

        // The distance from the middle is in half pixels, a whole number, so that opposite pixels
        // are bit-identical mirror images.
        let longer = width.max(height) as f64;
        let angle = |pixel: usize, pixels: usize| {
            (2 * pixel as i64 + 1 - pixels as i64) as f64 * half / longer
        };
        [
            (a1 + angle(column, width)) as f32,
            (a2 - angle(row, height)) as f32,
        ]
    }

    /// Returns the starts to compute, a1, a2 in rad: the first [`Map::rows`] rows, row by row from
    /// the top left pixel.
    pub fn starts(&self) -> Vec<[f32; 2]> {
        self.pixels(self.rows())
            .map(|pixel| self.start(pixel))
            .collect()
    }

    /// Returns the flips of [`Map::starts`], in that order. All processors compute, which may take
    /// hours. `tick` is called by several threads, each time with the number of starts completed
    /// since that thread's last call; together these are all starts. An error means that an angle
    /// of a start is not finite.
    pub fn points(&self, tick: impl Fn(usize) + Sync) -> Result<Vec<FlipPair>, Error> {
        let starts = self.starts();

        // A portion is a few seconds of work, and large enough to fill the lanes.
        let [search, finer] = &self.searches;
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

    /// Returns all pixels with the flips of their starts, row by row from the top left. `points`
    /// must come from [`Map::points`] of this map; if there are fewer, the iteration panics.
    pub fn shown(&self, points: &[FlipPair]) -> impl Iterator<Item = ([usize; 2], FlipPair)> {
        let rows = self.rows();
        let [width, height] = self.size;
        self.pixels(height).map(move |[column, row]| {
            // A row that was not computed mirrors a computed one.
            let [x, y] = if row < rows {
                [column, row]
            } else {
                [width - 1 - column, height - 1 - row]
            };
            ([column, row], points[y * width + x])
        })
    }

    /// Returns true if two flips differ by more than a grey level of the panel, a 14th of the scale
    /// of [`Map::share`]. A flip after the limit, or none by then, counts as at the limit. A start
    /// that cannot flip differs from all others, but not from another such start. If the flips of
    /// the two steps differ, the start is in doubt.
    pub fn differ(&self, [one, other]: FlipPair) -> bool {
        // One step size finds no flip at any time, the other one may.
        if [one, other].contains(&Flip::Never) {
            return one != other;
        }
        let level = |flip| self.share(flip).unwrap_or(1.0) * f32::from(GREYS);
        (level(one) - level(other)).abs() > 1.0
    }

    /// Returns the position of a flip on the logarithmic scale from sqrt(l1/g), 0, to the limit, 1.
    /// An earlier flip is at 0, a later one at 1. Returns `None` if the flip has no time: if the
    /// start cannot flip, and if it does not within the limit.
    pub fn share(&self, flip: Flip<f32>) -> Option<f32> {
        match flip {
            Flip::After(time) => Some((time.ln() / self.limit.ln()).clamp(0.0, 1.0)),
            Flip::Never | Flip::Later => None,
        }
    }
}
