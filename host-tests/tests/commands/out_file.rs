//! The files that commands write are complete or do not exist.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use emulator::process::Output;

use super::cli::{output, program};

/// Runs a command of this project in `folder` with a limit of a kilobyte for files, as if the disk
/// were full.
fn on_a_full_disk(line: &str, folder: &Path) -> Output {
    let script = format!(
        "trap '' XFSZ; ulimit -f 1; exec {} {line}",
        env!("CARGO_BIN_EXE_host-tests")
    );
    output(
        Command::new("bash")
            .args(["-c", &script])
            .current_dir(folder),
    )
}

/// Returns the names of the entries of a folder.
fn names(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).expect("a folder");
    files
        .map(|file| {
            let name = file.expect("a file").file_name();
            name.to_string_lossy().into_owned()
        })
        .collect()
}

/// Three commands write to a full disk. Each has exit code 1, one line that names the file and the
/// reason, and leaves neither a part of the file nor a temporary one.
#[test]
fn a_full_disk_is_an_error_and_leaves_no_part_of_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    for (line, file) in [
        ("flips --size 64 --limit 20 --out map.png", "map.png"),
        ("simulate --out swing.csv", "swing.csv"),
        ("figures --out .", "./figures/figure-2.svg"),
    ] {
        let output = on_a_full_disk(line, folder.path());
        let error = format!("error: --out: cannot write {file}: File too large (os error 27)\n");
        assert_eq!(
            (output.status.code(), &*output.stdout, output.stderr),
            (Some(1), "", error),
            "{line}"
        );
        // No part of the file remains, nor a temporary file.
        let left = names(folder.path());
        assert!(
            left.iter().all(|name| name == "figures"),
            "{line}: {left:?}"
        );
    }
    assert!(names(&folder.path().join("figures")).is_empty());
}

/// Four commands at once write one file. All succeed, and the folder contains that file only.
#[test]
fn two_commands_that_write_one_file_both_succeed() {
    let folder = tempfile::tempdir().expect("a folder");
    let start = || {
        program("flips")
            .args(["--size", "64", "--limit", "20", "--out", "map.png"])
            .current_dir(folder.path())
            .output()
            .expect("it runs")
    };
    std::thread::scope(|scope| {
        // All are started before the first is awaited, so that their writes can overlap.
        let runs = [(); 4].map(|()| scope.spawn(start));
        for run in runs {
            let said = run.join().expect("it ends");
            assert!(said.status.success(), "{said:?}");
            assert!(said.stdout.starts_with(b"wrote map.png; "), "{said:?}");
        }
    });
    assert_eq!(names(folder.path()), ["map.png"]);
}

/// A command that fails on a full disk leaves the old file unchanged. A link to a file remains a
/// link and its target is replaced, and a device remains a device.
#[test]
fn an_existing_file_remains_until_the_new_one_is_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("swing.csv");
    fs::write(&file, "old").expect("a file");
    let said = on_a_full_disk("simulate --out swing.csv", folder.path());
    assert_eq!(said.status.code(), Some(1), "{said:?}");
    assert_eq!(fs::read_to_string(&file).expect("the old one"), "old");

    // A link remains a link, and a device a device.
    let link = folder.path().join("link.csv");
    symlink("swing.csv", &link).expect("a link");
    let to = |file: &str| {
        output(
            program("simulate")
                .args(["--until", "1", "--every", "1", "--out", file])
                .current_dir(folder.path()),
        )
    };
    assert_eq!(to("link.csv").stdout, "wrote link.csv\n");
    assert_eq!(
        fs::read_link(&link).expect("a link"),
        Path::new("swing.csv")
    );
    let rows = fs::read_to_string(&file).expect("a table");
    assert_eq!(rows.lines().count(), 3, "{rows}");
    assert_eq!(to("/dev/null").status.code(), Some(0));
    assert!(!fs::metadata("/dev/null").expect("a device").is_file());
    assert_eq!(names(folder.path()).len(), 2);
}

/// A name that is too long, or below a file, is refused with exit code 2 before the computation,
/// which would take minutes. Nothing is written.
#[test]
fn a_name_that_no_file_can_have_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("file"), "old").expect("a file");
    let long = "a".repeat(300);
    for (path, reason) in [
        (format!("{long}.csv"), "File name too long (os error 36)"),
        (String::from("file/x.csv"), "Not a directory (os error 20)"),
    ] {
        for (line, file) in [
            ("flips --size 20000 --limit 1000", path.clone()),
            ("simulate --until 1e5", path.clone()),
            ("simulate --tolerance 1e-30 --until 100", path.clone()),
            ("figures", format!("{path}/figures/figure-2.svg")),
        ] {
            let mut command = program(line.split(' ').next().unwrap_or_default());
            command
                .args(line.split(' ').skip(1))
                .args(["--out", &path])
                .current_dir(folder.path());
            let output = output(&mut command);
            let error = format!("error: --out: cannot write {file}: {reason}\n");
            assert_eq!(
                (output.status.code(), &*output.stdout, output.stderr),
                (Some(2), "", error),
                "{line}"
            );
        }
    }
    assert_eq!(names(folder.path()), ["file"]);
}

/// A motion leaves the finite numbers after 20 rows: `cargo simulate` has exit code 1, and the file
/// has the heading and these 20 rows. They are correct.
#[test]
fn rows_before_an_error_are_in_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = output(
        program("simulate")
            .args(
                "--masses 1,100 --angles 3,2 --step 1/20 --method rk4-f32 --out swing.csv"
                    .split(' '),
            )
            .current_dir(folder.path()),
    );
    assert_eq!(said.status.code(), Some(1), "{said:?}");
    assert!(said.stderr.contains("error: after 20 rows"), "{said:?}");
    let rows = fs::read_to_string(folder.path().join("swing.csv")).expect("a table");
    assert_eq!(rows.lines().count(), 21, "{rows}");
}
