//! Snapshots of pictures and files of checksums. A picture is stored as text with one character per
//! pixel, so that a change of a picture is visible in a diff.

use std::env;
use std::fs;

use emulator::toolchain::workspace;

/// The character of each of the panel's 16 greys, from black (0) to white (15).
pub const GREYS: &[u8; 16] = b" .,:;-~=+*oaOX#@";

/// The name of the environment variable that makes [`check`] and [`check_lines`] write the files
/// instead of comparing them. Any value has this effect, even an empty one.
pub const BLESS: &str = "BLESS";

/// Returns a picture as lines of `width` characters of [`GREYS`], each line with a `\n` at its end.
/// `greys` are 0 to 15, row by row. Only the lower four bits of each byte count. A last row that is
/// not complete gives a shorter line, and no greys give an empty text. A `width` of 0 panics.
pub fn text(greys: &[u8], width: usize) -> String {
    let line = |row: &[u8]| {
        row.iter()
            .map(|&grey| GREYS[usize::from(grey & 15)] as char)
            .chain(['\n'])
            .collect::<String>()
    };
    greys.chunks(width).map(line).collect()
}

/// Compares a picture with the committed one, the file `host-tests/golden/scenes/NAME.txt` in the
/// project's folder ([`workspace`]). Returns `Ok` if both are the same.
///
/// The error names the file and says how to accept the picture, and lists the rows that differ,
/// numbered from 0, each old row above the new row. Rows that only one of the two pictures has, and
/// other ends of lines, are an error but are not listed. A file that cannot be read is an error,
/// too.
///
/// If [`BLESS`] is set, nothing is compared: the picture replaces the file, or creates it. It is
/// then an error only if the file cannot be written. The folder must exist.
pub fn check(name: &str, picture: &str) -> Result<(), String> {
    let path = workspace()
        .join("host-tests/golden/scenes")
        .join(format!("{name}.txt"));
    // A blessed run accepts the picture.
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

/// Returns the rows that differ, each with the old one above the new one, or `None` if both
/// pictures are the same, byte by byte. The text is empty if only the numbers of rows or the ends
/// of lines differ.
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

/// Compares `text` with a committed file; `file` is its path from the project's folder
/// ([`workspace`]). Returns `Ok` if both are the same, byte by byte.
///
/// The error names the file and says how to accept the text. It contains the numbers of lines
/// before and now, and the lines that differ, each old line above the new line. Lines that only one
/// of the two texts has, and other ends of lines, are an error but are not listed. A file that
/// cannot be read is an error, too.
///
/// If [`BLESS`] is set, nothing is compared: the text replaces the file, or creates it. It is then
/// an error only if the file cannot be written. The folder must exist.
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
    // Only lines that both files have are compared; the message has the number of lines.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures are the same only if every byte is: other ends of lines differ, also if the number
    /// of bytes is the same.
    #[test]
    fn other_ends_of_lines_are_a_difference() {
        assert_eq!(differing_rows("ab\ncd\n", "ab\ncd\n"), None);
        for other in ["ab\r\ncd", "ab\ncd", "ab\r\ncd\r\n"] {
            assert_eq!(
                differing_rows("ab\ncd\n", other),
                Some(String::new()),
                "{other:?}"
            );
        }
        let rows = differing_rows("ab\ncd\n", "ab\nce\n");
        assert_eq!(rows.as_deref(), Some("row 1\n  was |cd|\n  is  |ce|"));
    }
}
