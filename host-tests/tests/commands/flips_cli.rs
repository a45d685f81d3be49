//! `cargo flips`: its files.

use std::fs;

use host_tests::commands::figures::folder;

use super::cli::{output, program};

/// The file that it writes.
fn flips(arguments: &[&str], name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join(name);
    let output = output(program("flips").args(arguments).arg("--out").arg(&out));
    assert!(output.status.success(), "{output:?}");
    fs::read(out).expect("a file")
}

#[test]
fn the_committed_picture_is_what_it_draws() {
    let committed = fs::read(folder().join("figures/flips.png")).expect("a picture");
    assert!(flips(&["--limit", "100"], "flips.png") == committed, "accept by the README's `cargo flips`");
}

#[test]
fn a_table_has_every_start_and_is_its_own_mirror_image() {
    let table = String::from_utf8(flips(&["--size", "12x6", "--limit", "20"], "map.csv")).expect("text");
    let times: Vec<_> = table.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    assert_eq!(times.len(), 72);
    // Both angles mirrored: the same motion.
    assert!(times.iter().eq(times.iter().rev()));
    let [never, later] = ["never", "later"].map(|word| times.iter().filter(|time| **time == word).count());
    assert!(never > 10 && never < 40 && later > 0, "{table}");
    assert!(times.iter().filter_map(|time| time.parse::<f32>().ok()).all(|time| time > 0.0 && time <= 20.0), "{table}");
}
