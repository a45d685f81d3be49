//! The page of `cargo web`: its boards send the host's bytes; in Chromium it shows the pictures of
//! the scenes, and its keys, sliders, bobs and links work. A test whose tools are missing reports
//! them.

use std::fs;
use std::io::{Write, stderr};
use std::path::PathBuf;
use std::process::Command;

use console::cli::Refused;
use emulator::host::Show;
use emulator::process;
use emulator::toolchain::{WASM, set_up_chromium, set_up_for, workspace};
use firmware::config::TICK_RATE;
use firmware::protocol::{Answer, Frame, MAX_WIRE, ToHost, encode};
use firmware::scenes::SceneName;
use host_tests::commands::web::{HEADLESS, PROCESSORS, write_page};

use crate::support::LIMIT;

/// Returns Node.js with a script, and the page.
fn set_up(script: &str) -> anyhow::Result<(Command, PathBuf)> {
    let mut node = Command::new(set_up_for(WASM)?.qemu);
    node.arg(workspace().join("host-tests/emulator/web").join(script));
    Ok((node, write_page()?))
}

/// Runs a script to its end, and returns its output.
fn run(node: &mut Command) -> anyhow::Result<String> {
    let output = process::run(node, LIMIT)?;
    anyhow::ensure!(output.status.success(), output.stderr);
    Ok(output.stdout)
}

/// Runs a test. If a tool is missing, reports that instead; this message is not captured.
fn unless_missing(test: fn() -> anyhow::Result<()>) -> anyhow::Result<()> {
    test().or_else(|error| {
        let missing = error.downcast::<Refused>()?;
        Ok(writeln!(stderr(), "SKIPPED, web page: {missing}")?)
    })
}

/// The messages of 18 s of every scene have the host's bytes. So do plans, which they contain.
#[test]
fn boards_on_the_page_send_the_hosts_bytes() -> anyhow::Result<()> {
    unless_missing(|| {
        let (mut node, page) = set_up("board.js")?;
        let codes = PROCESSORS.map(|(_, _, processor)| processor.code.to_string());
        let output = run(node.arg(page).args(codes))?;
        let mut sent = output.as_str();

        // The page prints its boards in this order: every processor for each scene.
        let scenes = SceneName::ALL.iter().copied();
        let scenes = scenes.flat_map(|scene| PROCESSORS.map(|chip| (scene, chip)));
        for (scene, (chip, _, processor)) in scenes {
            let mut show = Show::on(processor, scene, &scene.first_settings())?;
            let mut expect = |message: ToHost| {
                for byte in encode(&message, &mut [0; MAX_WIRE]) {
                    let rest = sent.strip_prefix(&format!("{byte:02x}"));
                    sent = rest.unwrap_or_else(|| panic!("{chip}, {}: {message:?}", scene.name()));
                }
            };
            expect(ToHost::Answer(0, Answer::Done));
            for sequence in 0..18 * TICK_RATE {
                expect(ToHost::Answer(0, Answer::Status(show.player.status())));
                show.tick();
                expect(ToHost::Frame(Frame {
                    sequence,
                    ..show.player.frame()
                }));
            }
            expect(ToHost::Answer(0, Answer::Status(show.player.status())));
        }
        assert_eq!(sent, "");
        Ok(())
    })
}

/// The script `browser.js` checks the page in Chromium. The file of the page is smaller than 1 MB.
#[test]
fn page_works_in_chromium_and_makes_no_request() -> anyhow::Result<()> {
    unless_missing(|| {
        let (mut node, page) = set_up("browser.js")?;
        assert!(fs::metadata(&page)?.len() < 1_000_000, "too large");
        let profile = tempfile::tempdir()?;
        let folder = profile.path().display();
        let options = format!("{HEADLESS} --remote-debugging-pipe --user-data-dir={folder}");
        let pictures = workspace().join("host-tests/golden/scenes");
        run(node
            .arg(set_up_chromium()?)
            .arg(options)
            .args([page, pictures]))
        .map(drop)
    })
}
