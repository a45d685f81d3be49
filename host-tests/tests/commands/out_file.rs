//! The files that commands write are complete or do not exist.

use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use std::{fs, io};

use boards::process::spawn;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use super::cli::{output, program};
use crate::support::LIMIT;

/// A table that takes minutes.
const LONG: [&str; 7] = [
    "--seconds",
    "1e5",
    "--every",
    "1e-3",
    "--out",
    "swing.csv",
    "--bits",
];

/// A second writer is refused. Nothing else remains in the folder.
#[test]
fn a_file_is_replaced_by_a_complete_one_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("swing.csv");
    fs::write(&file, "old").expect("a file");

    // A limit of a kilobyte for files, as if the disk were full.
    let script = format!(
        "trap '' XFSZ; ulimit -f 1; exec {} simulate --seconds 1 --out swing.csv",
        env!("CARGO_BIN_EXE_host-tests")
    );
    let full = output(
        Command::new("bash")
            .args(["-c", &script])
            .current_dir(&folder),
    );
    assert_eq!(
        (full.status.code(), &*full.stdout, &*full.stderr),
        (
            Some(1),
            "",
            "error: --out: cannot write swing.csv: File too large (os error 27)\n"
        )
    );

    let mut long = program("simulate");
    long.args(LONG)
        .current_dir(&folder)
        .stdin(Stdio::null())
        .stderr(Stdio::piped());
    let mut long = spawn(&mut long, LIMIT).expect("it starts");
    let part = folder.path().join(".swing.csv.part");
    while fs::metadata(&part).map_or(0, |part| part.len()) == 0 {
        sleep(Duration::from_millis(10));
    }
    let second = output(program("simulate").args(LONG).current_dir(&folder));
    assert_eq!(
        (second.status.code(), &*second.stdout, &*second.stderr),
        (
            Some(2),
            "",
            "error: --out: cannot write swing.csv: another command is writing it\n"
        )
    );
    kill(Pid::from_raw(long.child.id().cast_signed()), Signal::SIGINT).expect("it runs");
    assert_eq!(long.wait().expect("it ends").code(), Some(130));
    let report = io::read_to_string(long.child.stderr.take().expect("piped")).expect("text");
    assert!(
        report.ends_with("interrupted: swing.csv not written\n"),
        "{report}"
    );
    assert_eq!(fs::read_to_string(&file).expect("the old one"), "old");

    let link = folder.path().join("link.csv");
    symlink("swing.csv", &link).expect("a link");
    let short = ["--seconds", "1", "--every", "1", "--out", "link.csv"];
    let done = output(program("simulate").args(short).current_dir(&folder));
    assert_eq!(done.stdout, "wrote link.csv\n");
    assert_eq!(
        fs::read_link(&link).expect("a link"),
        Path::new("swing.csv")
    );
    let rows = fs::read_to_string(&file).expect("a table");
    assert!(rows.starts_with("t,a1,"), "{rows}");
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 2);
}
