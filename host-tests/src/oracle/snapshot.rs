//! Pictures as text, one character per pixel, so that a change of a picture shows in a diff.

use std::env;
use std::fs;

use crate::emulator::toolchain::workspace;

/// One character for each of the panel's 16 greys, from black to white.
pub const GREYS: &[u8; 16] = b" .,:;-~=+*oaOX#@";

/// Set to anything, this environment variable makes [`check`] write the pictures instead of comparing them.
pub const BLESS: &str = "BLESS";

/// Greys of 0 to 15, row by row, as lines of `width` characters.
pub fn text(greys: &[u8], width: usize) -> String {
    let line = |row: &[u8]| {
        row.iter()
            .map(|&grey| GREYS[usize::from(grey & 15)] as char)
            .chain(['\n'])
            .collect::<String>()
    };
    greys.chunks(width).map(line).collect()
}

/// Compares a picture with the committed one called `name`; the message of what differs, with the command that accepts it.
pub fn check(name: &str, picture: &str) -> Result<(), String> {
    let path = workspace()
        .join("host-tests/pictures/scenes")
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
    let differs = |(row, (old, new)): (usize, (&str, &str))| {
        (old != new).then(|| format!("row {row}\n  was |{old}|\n  is  |{new}|"))
    };
    let rows: Vec<_> = committed
        .lines()
        .zip(picture.lines())
        .enumerate()
        .filter_map(differs)
        .collect();
    if rows.is_empty() && committed.len() == picture.len() {
        return Ok(());
    }
    Err(format!(
        "{name} differs from {}; accept by {BLESS}=1\n{}",
        path.display(),
        rows.join("\n")
    ))
}
