//! Snapshots of pictures and files of checksums. A picture is stored as text with one character per
//! pixel, so that a change of a picture is visible in a diff. Not every test uses all of this module.
#![allow(dead_code)]

use std::env;
use std::fs;

use boards::toolchain::workspace;

pub const GREYS: &[u8; 16] = b" .,:;-~=+*oaOX#@";

/// The environment variable that makes [`check`] and [`check_lines`] write the files instead of
/// comparing them.
pub const BLESS: &str = "BLESS";

/// Returns a picture as lines of `width` characters of [`GREYS`].
pub fn text(greys: &[u8], width: usize) -> String {
    let line = |row: &[u8]| {
        row.iter()
            .map(|&grey| GREYS[usize::from(grey & 15)] as char)
            .chain(['\n'])
            .collect::<String>()
    };
    greys.chunks(width).map(line).collect()
}

/// Compares a picture with the committed one, `host-tests/golden/scenes/NAME.txt`. The error lists
/// the rows that differ, and says how to accept the picture.
pub fn check(name: &str, picture: &str) -> Result<(), String> {
    let path = workspace()
        .join("host-tests/golden/scenes")
        .join(format!("{name}.txt"));
    if env::var_os(BLESS).is_some() {
        return fs::write(&path, picture).map_err(|error| format!("{}: {error}", path.display()));
    }
    let committed = fs::read_to_string(&path).map_err(|error| {
        format!(
            "{}: {error}; a new one is written by {BLESS}=1",
            path.display()
        )
    })?;

    differing_rows(&committed, picture).map_or(Ok(()), |rows| {
        Err(format!(
            "{name} differs from {}; accept by {BLESS}=1\n{rows}",
            path.display()
        ))
    })
}

/// Returns the rows that differ, each with the old one above the new one.
fn differing_rows(committed: &str, picture: &str) -> Option<String> {
    let differs = |(row, (old, new)): (usize, (&str, &str))| {
        (old != new).then(|| format!("row {row}\n  was |{old}|\n  is  |{new}|"))
    };
    let rows: Vec<_> = committed
        .lines()
        .zip(picture.lines())
        .enumerate()
        .filter_map(differs)
        .collect();
    (committed != picture).then(|| rows.join("\n"))
}

/// Compares `text` with a committed file. The error lists the lines that differ, and says how to
/// accept the text.
pub fn check_lines(file: &str, text: &str) -> Result<(), String> {
    let path = workspace().join(file);
    if env::var_os(BLESS).is_some() {
        return fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()));
    }
    let committed =
        fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    if committed == text {
        return Ok(());
    }
    let differing: Vec<String> = committed
        .lines()
        .zip(text.lines())
        .filter(|(old, new)| old != new)
        .map(|(old, new)| format!("was {old}\nis  {new}"))
        .collect();
    Err(format!(
        "{file} differs, {} lines before and {} now; accept by {BLESS}=1\n{}",
        committed.lines().count(),
        text.lines().count(),
        differing.join("\n")
    ))
}
