//! `cargo flips`: when a rod first turns over, for every start from rest, as a picture or as numbers.

pub mod judge;
mod legend;
pub mod map;
mod options;
mod output;
mod part;
pub mod square;

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result};
use signal_hook::flag::register_usize;

use crate::console::cli::check_writable;
use crate::console::progress::Bar;
use crate::emulator::process::INTERRUPTS;
use map::{Map, Point};
pub use options::Options;
use part::Part;

/// What a run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// All points are done; so many there are, and so many are in doubt.
    Done {
        /// Points.
        all: usize,
        /// Of them, those in doubt.
        doubtful: usize,
    },
    /// It was interrupted.
    Interrupted {
        /// By this signal.
        signal: i32,
        /// What is done, of 1.
        share: f64,
    },
}

/// Computes the map and writes the file, or what of it is done when it is interrupted.
pub fn run(options: &Options) -> Result<Outcome> {
    let (map, kind) = options.map()?;
    check_writable("--out", &options.out)?;
    let (mut part, mut points) = Part::open(&options.out, &map, options.resume)?;
    let stopped = Arc::new(AtomicUsize::new(0));
    for signal in INTERRUPTS {
        register_usize(signal, Arc::clone(&stopped), signal as usize)?;
    }
    let is_stopped = || stopped.load(Ordering::Relaxed) != 0;
    let all = compute(&map, &mut points, is_stopped, |band| part.add(band))?;
    let file = kind.file(&map, &points, options.doubt)?;
    fs::write(&options.out, file).with_context(|| format!("cannot write {}", options.out.display()))?;
    if points.len() < all {
        let signal = stopped.load(Ordering::Relaxed) as i32;
        return Ok(Outcome::Interrupted { signal, share: points.len() as f64 / all as f64 });
    }
    part.remove()?;
    let doubtful = doubtful(&map, &points);
    let [width, height] = map.square.size;
    Ok(Outcome::Done { all: width * height, doubtful })
}

/// Computes what is missing of `points`, band by band, until it is stopped; how many there are in all.
fn compute(
    map: &Map,
    points: &mut Vec<Point>,
    is_stopped: impl Fn() -> bool,
    mut keep: impl FnMut(&[Point]) -> Result<()>,
) -> Result<usize> {
    let ([width, _], rows) = (map.square.size, map.square.rows());
    let (all, whole) = (width * rows, points.len() / width);
    let bar = Bar::start("starts", all as u64);
    bar.begin_at((whole * width) as u64);
    for first in (whole..rows).step_by(map.band()) {
        if is_stopped() {
            break;
        }
        let band = map.points(first..rows.min(first + map.band()))?;
        // Of a row that was cut off, the rest.
        let new = band.get(points.len() - first * width..).unwrap_or_default();
        keep(new)?;
        points.extend_from_slice(new);
        bar.advance(band.len() as u64);
    }
    Ok(all)
}

/// How many pixels are in doubt.
fn doubtful(map: &Map, points: &[Point]) -> usize {
    let [width, height] = map.square.size;
    let places = (0..height).flat_map(|row| (0..width).map(move |column| map.square.place([column, row])));
    places.filter(|&place| points.get(place).is_some_and(|&point| map.is_in_doubt(point))).count()
}
