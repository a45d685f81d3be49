//! A command works on the project that it is run in.

use std::fs;
use std::path::Path;
use std::process::Command;

/// A command that was built in one checkout and is run in another works on that one; outside of any it says so.
#[test]
fn the_project_is_the_one_that_a_command_is_run_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let (copy, checkout) = (folder.path().join("fw"), folder.path().join("checkout"));
    fs::copy(env!("CARGO_BIN_EXE_host-tests"), &copy).expect("a copy");
    for file in ["kernel/Cargo.toml", "firmware/Cargo.toml", "host-tests/Cargo.toml", "firmware/src/bin/elsewhere.rs"] {
        let file = checkout.join(file);
        fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        fs::write(file, "").expect("a file");
    }
    let help = |within: &Path| {
        Command::new(&copy)
            .args(["fw", "--help"])
            .current_dir(within)
            .env_remove("CARGO_MANIFEST_DIR")
            .output()
            .expect("it runs")
    };
    let inside = help(&checkout.join("firmware/src"));
    assert!(inside.status.success() && String::from_utf8_lossy(&inside.stdout).contains("Binaries:\n  elsewhere\n"));
    let outside = help(folder.path());
    let line = String::from_utf8(outside.stderr).expect("text");
    assert_eq!((outside.status.code(), outside.stdout.len(), line.lines().count()), (Some(2), 0, 1), "{line}");
}
