//! `cargo demo` as a process: exit codes, summary, and the files it saves.

use std::f64::consts::PI;
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use super::cli::{output, program};
use crate::support::toolchain;
use boards::host::Show;
use demo::played;
use double_pendulum::Parameters;
use firmware::config::STM32F405;
use firmware::motion::Settings;
use firmware::scenes::SceneName;
use tempfile::TempDir;

/// 128 x 64 pixels.
const SECONDS: u32 = 2;
const FRAMES: usize = 60;
const SIZE: (u32, u32) = (384, 192);

fn recorded(board: &str, folder: &TempDir, name: &str) -> ([PathBuf; 2], String) {
    toolchain();
    let files = ["gif", "png"].map(|kind| folder.path().join(format!("{name}.{kind}")));
    let mut command = program("demo");
    command.args([
        "--board",
        board,
        "--headless",
        "--seconds",
        &SECONDS.to_string(),
    ]);
    command
        .arg("--record")
        .arg(&files[0])
        .arg("--screenshot")
        .arg(&files[1]);
    let output = output(&mut command);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    (files, output.stdout)
}

/// The Pico's emulator reads the panel through the panel's own bus.
#[test]
fn a_recording_shows_a_swinging_pendulum_and_is_the_same_every_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut files = Vec::new();
    for (board, name) in [
        ("lm3s6965evb", "first"),
        ("pico", "pico"),
        ("lm3s6965evb", "again"),
    ] {
        let ([animation, last], summary) = recorded(board, &folder, name);
        for line in [
            "frames                120\n",
            "CRC errors            0\n",
            "dropped frames        0\n",
            "shown                 extrapolation10-fixed64 · 3 steps per frame · ",
            "120 frames, all identical to the host",
        ] {
            assert!(summary.contains(line), "no {line:?} in\n{summary}");
        }

        let late = if board == "pico" {
            0.1..0.2
        } else {
            0.0..0.001
        };
        let simulated = summary
            .split_once("simulated time")
            .and_then(|(_, rest)| rest.split_whitespace().next()?.parse::<f64>().ok());
        let simulated = simulated.expect("the simulated time");
        assert!(
            late.contains(&(simulated - f64::from(SECONDS))),
            "{board}: {simulated}"
        );

        let frames = played(&animation).expect("a GIF file");
        let time: u32 = frames.iter().map(|(_, delay)| u32::from(*delay)).sum();
        assert_eq!((frames.len(), time), (FRAMES, 100 * SECONDS));
        let moved = frames
            .windows(2)
            .filter(|pair| pair[0].0 != pair[1].0)
            .count();

        let dark = frames
            .iter()
            .take_while(|(dots, _)| dots.iter().all(|dot| *dot == dots[0]))
            .count();
        assert!(dark <= 3, "{dark}");
        assert_eq!(
            moved,
            FRAMES - dark.max(1),
            "every frame differs from the one before"
        );

        let screenshot = png::Decoder::new(BufReader::new(File::open(last).expect("a file")));
        let screenshot = screenshot.read_info().expect("a PNG file");
        assert_eq!((screenshot.info().width, screenshot.info().height), SIZE);
        files.push(std::fs::read(animation).expect("a file"));
    }
    assert!(files[0] == files[2], "two recordings differ");
}

#[test]
fn the_method_can_be_chosen_and_is_named() {
    toolchain();
    for (method, named) in [
        ("plan", "extrapolation10-fixed64 · 3 steps per frame"),
        ("rk4-f32-direction", "rk4-f32-direction · 1 step per frame"),
    ] {
        let output =
            output(program("demo").args(["--method", method, "--headless", "--seconds", "1"]));
        let shown = format!("\nshown                 {named} · accurate to half a pixel until");
        assert!(
            output.status.success() && output.stdout.contains(&shown),
            "{output:?}"
        );
    }
}

#[test]
fn the_panel_of_a_board_without_one_is_redrawn_and_recorded() {
    toolchain();
    let folder = tempfile::tempdir().expect("a folder");
    let animation = folder.path().join("figure-7.gif");
    let mut command = program("demo");
    command.args([
        "--board",
        "stm32f405",
        "--scene",
        "figure-7",
        "--headless",
        "--seconds",
        "1",
        "--record",
    ]);
    let output = output(command.arg(&animation));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(
        output
            .stdout
            .contains("60 frames, all identical to the host"),
        "{}",
        output.stdout
    );

    let name = SceneName::Figure7;
    let mut scene =
        Show::on(STM32F405, name, &name.first_settings()).expect("a scene of the catalogue");
    let played = played(&animation).expect("a GIF file");
    assert_eq!(played.len(), 30);

    for (number, (greys, _)) in played.iter().enumerate() {
        scene.tick();
        assert!(scene.frame().greys == *greys, "screenshot {number}");
        scene.tick();
    }
}

#[test]
fn a_motion_of_the_user_is_played_recorded_and_compared() {
    toolchain();
    let folder = tempfile::tempdir().expect("a folder");
    let animation = folder.path().join("own.gif");
    let mut command = program("demo");
    command.args(["--board", "stm32f405", "--headless", "--seconds", "1"]);
    command.args(["--angles", "90,-45", "--degrees", "--masses", "1,3"]);
    command.args([
        "--lengths",
        "1,7/10",
        "--velocities",
        "0,180",
        "--gravity",
        "1.62",
    ]);
    let output = output(command.arg("--record").arg(&animation));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = &output.stdout;
    // On a busy machine the board's answer may arrive some frames late. Then more are compared.
    let compared = summary
        .split_once(" frames, all identical to the host")
        .and_then(|(before, _)| before.split_whitespace().next_back()?.parse().ok());
    assert!(compared >= Some(60), "{summary}");
    let saved = format!(
        "saved                 {}, 30 pictures, the panel redrawn here from the board's numbers\n",
        animation.display()
    );
    assert!(summary.ends_with(&saved), "{summary}");

    let own = Settings {
        parameters: Parameters {
            m1: 1.0,
            m2: 3.0,
            l1: 1.0,
            l2: 0.7,
            g: 1.62,
        },
        degrees: [90.0, -45.0],
        velocities: [0.0, PI],
    };
    let mut scene = Show::on(STM32F405, SceneName::Page, &own).expect("a motion");
    let played = played(&animation).expect("a GIF file");
    assert_eq!(played.len(), 30);

    while scene.frame().greys != played[0].0 {
        scene.tick();
        assert!(scene.report().step < 10, "it is another motion");
    }
    for (number, (greys, _)) in played.iter().enumerate() {
        assert!(scene.frame().greys == *greys, "screenshot {number}");
        scene.tick();
        scene.tick();
    }
}

#[test]
fn half_speed_simulates_half_the_time() {
    toolchain();
    let output = output(program("demo").args(["--speed", "1/2", "--headless", "--seconds", "2"]));
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let summary = &output.stdout;
    let time = summary
        .lines()
        .find_map(|line| {
            line.strip_prefix("simulated time")?
                .trim()
                .strip_suffix(" s")
        })
        .and_then(|time| time.parse::<f64>().ok())
        .expect("the simulated time");
    assert!((0.98..1.1).contains(&time), "{summary}");
    assert!(
        summary.contains(" frames, all identical to the host"),
        "{summary}"
    );
}

/// The map of flips takes half of a tick of the Cortex-M3, so that the board cannot keep speed 4.
#[test]
fn a_board_that_cannot_keep_a_speed_lowers_it() {
    toolchain();
    let mut command = program("demo");
    command.args(["--scene", "flips", "--speed", "4"]);
    let output = output(command.args(["--headless", "--seconds", "4"]));
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(output.stderr.contains("speed lowered to 2"), "{output:?}");

    let number = |name| {
        let lines = output.stdout.lines();
        let mut words = lines.filter_map(|line| line.strip_prefix(name));
        let word = words.next().map(str::trim).unwrap_or_default();
        word.parse::<u32>().expect(name)
    };
    let ticks = number("frames ") + number("dropped frames");
    assert!((240..=1200).contains(&ticks), "{output:?}");
}

#[test]
fn without_a_terminal_the_reason_and_the_options_are_printed() {
    toolchain();
    let messages = |arguments: &[&str]| {
        let mut command = program("demo");
        command.args(["--seconds", "0.1"]);
        let output = output(command.args(arguments));
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(!output.stdout.contains("no terminal"), "{output:?}");
        output.stderr
    };
    let reason = "no terminal: running headless; --record FILE.gif";
    let without_terminal = messages(&[]);
    assert!(without_terminal.contains(reason), "{without_terminal}");
    let headless = messages(&["--headless"]);
    assert!(!headless.contains("no terminal"), "{headless}");
}

/// The pipes to QEMU are in the folder `TMPDIR`.
#[test]
fn an_unusable_folder_for_pipes_is_named() {
    let output = output(
        program("demo")
            .args(["--headless", "--seconds", "0.1"])
            .env("TMPDIR", "/dev/null"),
    );
    assert_eq!(
        (output.status.code(), output.stdout.as_str()),
        (Some(2), ""),
        "{output:?}"
    );
    assert!(
        output.stderr.lines().count() == 1 && output.stderr.contains("TMPDIR=/dev/null"),
        "{}",
        output.stderr
    );
}
