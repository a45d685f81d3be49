//! What is done so far, on disk: rows are added as they are computed, so that a run may be ended in any way.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use double_pendulum::flips::Flip;
use nix::fcntl::{Flock, FlockArg};

use super::map::{Followed, Map};
use crate::console::cli::Refused;

/// Points in a file: a line that says of what map, then two numbers for each.
#[derive(Debug)]
pub(super) struct Part {
    path: PathBuf,
    /// Locked, for two runs of one name would write over each other.
    file: Flock<File>,
}

const POINT: usize = 8;

impl Part {
    /// The points of `map` done so far, beside `out`: none, unless it is to `resume`.
    pub fn open(out: &Path, map: &Map, resume: bool) -> Result<(Self, Vec<Followed>)> {
        let mut name = out.as_os_str().to_owned();
        name.push(".part");
        let path = PathBuf::from(name);
        let head = format!("{map:?}\n");
        let opened = File::options().read(true).append(true).create(!resume).open(&path);
        let option = if resume { "--resume" } else { "--out" };
        let file = opened.map_err(|error| Refused::because(format!("{option}: {}: {error}", path.display())))?;
        let locked = Flock::lock(file, FlockArg::LockExclusiveNonblock);
        let busy = |_| Refused::because(format!("--out {}: another cargo flips is writing it", out.display()));
        let mut file = locked.map_err(busy)?;
        if !resume {
            file.set_len(0).and_then(|()| file.write_all(head.as_bytes()))?;
            return Ok((Self { path, file }, Vec::new()));
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let other = || Refused::because(format!("--resume: {} is of another map", path.display()));
        let body = bytes.strip_prefix(head.as_bytes()).ok_or_else(other)?;
        let points: Vec<Followed> = body.chunks_exact(POINT).map(read).collect();
        // What follows the last whole point was cut off.
        file.set_len((head.len() + points.len() * POINT) as u64)?;
        Ok((Self { path, file }, points))
    }

    pub fn add(&mut self, points: &[Followed]) -> Result<()> {
        let numbers = points.iter().flat_map(|point| [point.flip, point.check].map(number));
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        self.file.write_all(&bytes).with_context(|| format!("cannot write {}", self.path.display()))
    }

    pub fn remove(self) -> Result<()> {
        fs::remove_file(&self.path).with_context(|| format!("cannot remove {}", self.path.display()))
    }
}

/// A flip as a number: its time; infinite if it was waited for in vain, -1 if it cannot be.
fn number(flip: Flip<f32>) -> f32 {
    match flip {
        Flip::Never => -1.0,
        Flip::After(time) => time,
        Flip::Later => f32::INFINITY,
    }
}

fn read(bytes: &[u8]) -> Followed {
    let (numbers, _) = bytes.as_chunks();
    let flip = |at: usize| match numbers.get(at).map_or(-1.0, |bytes| f32::from_le_bytes(*bytes)) {
        time if time < 0.0 => Flip::Never,
        time if time.is_finite() => Flip::After(time),
        _ => Flip::Later,
    };
    Followed { flip: flip(0), check: flip(1) }
}
