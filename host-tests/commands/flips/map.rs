//! The plane of starts, divided into pixels, and the computation of the map in threads, vector
//! lanes and two step sizes.

use double_pendulum::flips::{Flip, step_size};
use double_pendulum::{Error, Parameters};
use exact::vectors::{Search, flips};
use firmware::scenes::flips::GREYS;
use rayon::prelude::*;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The pendulum, whose gravity is the same number as its l1, so that sqrt(l1/g) is 1 s.
    pub parameters: Parameters<f32>,
    /// The step of the first search, in sqrt(l1/g), as all times.
    pub dt: f64,
    pub limit: f32,
    pub size: [usize; 2],
    pub centre: [f64; 2],
    /// The distance from the middle to the ends of the longer side, rad.
    pub half: f64,
    pub searches: [Search; 2],
}

/// A start's flip with the step, which is shown, and with half of it, for comparison.
pub type FlipPair = [Flip<f32>; 2];

/// The starts that a thread computes together. With a larger number, fewer lanes are idle at its
/// end. It is smaller if each start takes long, so that progress is reported.
const PORTION: usize = 8192;
const LEAST_PORTION: usize = 64;
const PORTION_STEPS: f64 = 1e9;

impl Map {
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

    /// Returns the most steps that a start takes: a search with the step, one with half of it.
    pub fn steps(&self) -> f64 {
        3.0 * f64::from(self.limit) / self.dt
    }

    /// Returns the number of rows to compute. About the hanging position, the lower half of a map
    /// mirrors the upper one in both directions.
    pub fn rows(&self) -> usize {
        let [_, height] = self.size;
        if self.centre == [0.0; 2] {
            height.div_ceil(2)
        } else {
            height
        }
    }

    fn pixels(&self, rows: usize) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [width, _] = self.size;
        (0..rows).flat_map(move |row| (0..width).map(move |column| [column, row]))
    }

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

    pub fn starts(&self) -> Vec<[f32; 2]> {
        self.pixels(self.rows())
            .map(|pixel| self.start(pixel))
            .collect()
    }

    /// Returns the flips of [`Map::starts`]. Calls `tick` with the size of each completed portion.
    pub fn points(&self, tick: impl Fn(usize) + Sync) -> Result<Vec<FlipPair>, Error> {
        let starts = self.starts();

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

    /// Returns all pixels with the flips of their starts.
    pub fn shown(&self, points: &[FlipPair]) -> impl Iterator<Item = ([usize; 2], FlipPair)> {
        let rows = self.rows();
        let [width, height] = self.size;
        self.pixels(height).map(move |[column, row]| {
            let [x, y] = if row < rows {
                [column, row]
            } else {
                [width - 1 - column, height - 1 - row]
            };
            ([column, row], points[y * width + x])
        })
    }

    /// Returns true if two flips differ by more than a grey level of the panel, a 14th of the scale
    /// of [`Map::share`]. If the flips of the two steps differ, the start is in doubt.
    pub fn differ(&self, [one, other]: FlipPair) -> bool {
        // `Never` is no time on the scale. `Later` counts as its end.
        if [one, other].contains(&Flip::Never) {
            return one != other;
        }
        let level = |flip| self.share(flip).unwrap_or(1.0) * f32::from(GREYS);
        (level(one) - level(other)).abs() > 1.0
    }

    /// Returns the position of a flip on the logarithmic scale of time, from 0 to 1.
    pub fn share(&self, flip: Flip<f32>) -> Option<f32> {
        match flip {
            Flip::After(time) => Some((time.ln() / self.limit.ln()).clamp(0.0, 1.0)),
            Flip::Never | Flip::Later => None,
        }
    }
}
