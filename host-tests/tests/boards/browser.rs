//! The page of `cargo web`: its boards send the host's bytes, and it works in Chromium. A test
//! whose tools are missing reports them.

use std::fs;
use std::io::{Write, stderr};
use std::path::PathBuf;
use std::process::Command;
use std::sync::Mutex;

use boards::console::cli::Refused;
use boards::host::Show;
use boards::process;
use boards::toolchain::{WASM, set_up_chromium, set_up_for, workspace};
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Frame, MAX_WIRE, ToHost, encode};
use firmware::scenes::SceneName;
use host_tests::web::{HEADLESS, OFFERED, digits, write_page};

use crate::support::LIMIT;

fn run(script: &str, add: impl FnOnce(&mut Command)) -> anyhow::Result<String> {
    let mut node = Command::new(set_up_for(WASM)?.qemu);
    node.arg(workspace().join("host-tests/boards/web").join(script));
    add(&mut node);
    let output = process::run(&mut node, LIMIT)?;
    anyhow::ensure!(output.status.success(), output.stderr);
    Ok(output.stdout)
}

/// Reports a missing tool; the message is not captured.
fn unless_missing(test: fn() -> anyhow::Result<()>) -> anyhow::Result<()> {
    test().or_else(|error| {
        let missing = error.downcast::<Refused>()?;
        Ok(writeln!(stderr(), "SKIPPED, web page: {missing}")?)
    })
}

/// Writes the page. A second writer at the same time would be refused.
fn page() -> anyhow::Result<PathBuf> {
    static WRITER: Mutex<()> = Mutex::new(());
    let _only = WRITER.lock();
    write_page()
}

#[test]
fn boards_on_the_page_send_the_hosts_bytes() -> anyhow::Result<()> {
    unless_missing(|| {
        let page = page()?;
        let codes = OFFERED.map(|(board, _)| board.processor().code.to_string());
        let output = run("board.js", |node| _ = node.arg(page).args(codes))?;
        let mut sent = output.lines();

        for scene in SceneName::ALL {
            for (board, chip) in OFFERED {
                let mut show = Show::on(board.processor(), *scene, &scene.first_settings())?;
                let mut first = ToHost::Answer(0, Answer::Done);
                for sequence in 0..=18 * TICK_RATE {
                    let status = ToHost::Answer(0, Answer::Status(show.player.status()));
                    let both = [first, status];
                    let both = both.map(|one| digits(encode(&one, &mut [0; MAX_WIRE])));
                    assert_eq!(
                        sent.next(),
                        Some(&*both.concat()),
                        "{chip}, {scene:?}: {first:?}"
                    );
                    show.tick();
                    first = ToHost::Frame(Frame {
                        sequence,
                        ..show.player.frame()
                    });
                }
            }
        }
        assert_eq!(sent.next(), None);
        Ok(())
    })
}

#[test]
fn page_works_in_chromium_and_makes_no_request() -> anyhow::Result<()> {
    unless_missing(|| {
        let page = page()?;
        assert!(fs::metadata(&page)?.len() < 1_000_000, "too large");
        let profile = tempfile::tempdir()?;
        let folder = profile.path().display();
        let options = format!("{HEADLESS} --remote-debugging-pipe --user-data-dir={folder}");
        let pictures = workspace().join("host-tests/golden/scenes");
        let chromium = set_up_chromium()?;
        run("browser.js", |node| {
            node.arg(chromium).arg(options).args([page, pictures]);
        })
        .map(drop)
    })
}
