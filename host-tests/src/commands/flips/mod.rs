//! `cargo flips`: when a rod first turns over, for every start from rest, as a picture or as numbers.

pub mod map;
mod options;
mod output;

use std::fs;

use anyhow::{Context, Result};

use crate::console::cli::{Refused, check_writable, say};
use crate::console::progress::Progress;
use map::{Followed, Map};
pub use options::FlipsOptions;

/// Computes the map and writes the file; says how much of it is in doubt.
pub fn run(options: &FlipsOptions) -> Result<()> {
    let map = options.map().map_err(|error| Refused::because(format_args!("{error:#}")))?;
    check_writable("--out", &options.out)?;
    let [width, height] = map.square.size;
    let bar = Progress::of("starts", (width * map.square.rows()) as u64);
    let points = map.points(|done| bar.advance(done as u64))?;
    drop(bar);
    let file = output::file(&options.out, &map, &points, options.doubt)?;
    let out = options.out.display();
    fs::write(&options.out, file).with_context(|| format!("cannot write {out}"))?;
    let (all, doubtful) = (width * height, doubtful(&map, &points));
    let percent = 100.0 * doubtful as f64 / all as f64;
    Ok(say(format_args!("{out}: {doubtful} of {all} starts in doubt ({percent:.3} %)"))?)
}

fn doubtful(map: &Map, points: &[Followed]) -> usize {
    let [width, height] = map.square.size;
    let places = (0..height).flat_map(|row| (0..width).map(move |column| map.square.place([column, row])));
    places.filter(|&place| map.is_in_doubt(points[place])).count()
}
