//! `cargo flips`: when a rod first turns over, for every start from rest, as a picture or as numbers.

pub mod judge;
mod legend;
pub mod map;
mod options;
mod output;
mod part;
pub mod square;

use std::fs;
use std::process::ExitCode;
use std::sync::atomic::Ordering;

use anyhow::{Context, Result};

use crate::console::cli::{check_writable, complain, say};
use crate::console::progress::Bar;
use crate::emulator::process::{interrupted, interrupted_by};
use map::{Followed, Map};
pub use options::FlipsOptions;
use part::Part;

/// Computes the map and writes the file, or what of it is done when it is interrupted; says how much, or how much is in doubt.
pub fn run(options: &FlipsOptions) -> Result<ExitCode> {
    let (map, kind) = options.map()?;
    check_writable("--out", &options.out)?;
    let (mut part, mut points) = Part::open(&options.out, &map, options.resume)?;
    let stopped = interrupted()?;
    let all = compute(&map, &mut points, || stopped.load(Ordering::Relaxed) != 0, |band| part.add(band))?;
    let (file, out) = (kind.file(&map, &points, options.doubt)?, options.out.display());
    fs::write(&options.out, file).with_context(|| format!("cannot write {out}"))?;
    if points.len() < all {
        let percent = 100.0 * points.len() as f64 / all as f64;
        complain(format_args!("interrupted: {out} has {percent:.1} %; --resume goes on"));
        return Ok(interrupted_by(stopped.load(Ordering::Relaxed)));
    }
    part.remove()?;
    let ([width, height], doubtful) = (map.square.size, doubtful(&map, &points));
    let (all, percent) = (width * height, 100.0 * doubtful as f64 / (width * height) as f64);
    say(format_args!("{out}: {doubtful} of {all} starts in doubt ({percent:.3} %)"))?;
    Ok(ExitCode::SUCCESS)
}

/// Computes what is missing of `points`, band by band, until it is stopped; how many there are in all.
fn compute(
    map: &Map,
    points: &mut Vec<Followed>,
    is_stopped: impl Fn() -> bool,
    mut keep: impl FnMut(&[Followed]) -> Result<()>,
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

fn doubtful(map: &Map, points: &[Followed]) -> usize {
    let [width, height] = map.square.size;
    let places = (0..height).flat_map(|row| (0..width).map(move |column| map.square.place([column, row])));
    places.filter(|&place| points.get(place).is_some_and(|&point| map.is_in_doubt(point))).count()
}
