//! `cargo demo --port`: a pseudo-terminal with an emulated board behind it, whose cable can be
//! pulled.

use std::fs::File;
use std::io::{Read, Write};
use std::process::Stdio;
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use super::cli::program;
use crate::support::bench::{Bench, WAIT, at_port, wire};
use firmware::display::{BusFault, By, Controller, Found, PanelReport, PanelState};
use firmware::protocol::{Answer, Cause, Frame, Restarted, ToHost};
use firmware::scenes::{Report, SceneName};
use nix::pty::{OpenptyResult, Winsize, openpty};

const SILENCE: Duration = Duration::from_secs(3);
const FOREIGNER: &[u8] = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
const FOREIGN: Duration = Duration::from_secs(4);

fn demo(code: i32, arguments: &str, play: impl FnMut(&mut Bench)) -> [String; 2] {
    let mut command = program("demo");
    command.arg("--headless").args(arguments.split_whitespace());
    let output = at_port(&mut Bench::new(), &mut command, play);
    assert_eq!(output.status.code(), Some(code), "{output:?}");
    [output.stdout, output.stderr]
}

#[test]
fn every_frame_of_a_board_at_a_port_is_compared_and_a_damaged_one_counted() {
    let damaged = |message: ToHost| {
        let mut wire = wire(message);
        if message.frame().is_some_and(|frame| frame.sequence == 400) {
            wire[30] ^= 0x10;
        }
        wire
    };
    let [summary, _] = demo(0, "--scene butterfly --seconds 8", |bench| {
        bench.carry(damaged)
    });
    assert!(
        summary.contains("frames, all identical to the host"),
        "{summary}"
    );
    assert!(
        summary.contains("CRC errors            1\nlost frames           1\n"),
        "{summary}"
    );
}

#[test]
fn a_motion_of_the_user_is_played_at_a_port() {
    let arguments = "--scene butterfly --angles 90,45 --degrees --masses 1,3 --seconds 2";
    let [summary, _] = demo(0, arguments, |bench| bench.carry(wire));
    assert!(
        summary.contains("frames, all identical to the host"),
        "{summary}"
    );
}

/// The fastest board could execute these steps in time, so only this board can refuse them.
#[test]
fn a_method_that_the_board_refuses_is_named() {
    let arguments = "--method extrapolation10-fixed64 --angles 120,120 --degrees --lengths 1,1/10";
    let [summary, messages] = demo(2, arguments, |bench| bench.carry(wire));
    assert_eq!(summary, "");
    assert!(
        messages.ends_with("ttyACM0: the board refuses this method; change --method\n"),
        "{messages}"
    );
}

#[test]
fn one_flipped_bit_is_named_and_fails() {
    let flipped = |mut message: ToHost| {
        if let ToHost::Frame(frame) = &mut message
            && frame.sequence == 300
        {
            frame.report.state.p1 = f32::from_bits(frame.report.state.p1.to_bits() ^ 1);
        }
        wire(message)
    };
    let [_, messages] = demo(1, "--seconds 8", |bench| bench.carry(flipped));
    let is_it =
        |line: &str| line.starts_with("problem: frame 300, step ") && line.contains(": p1 is 0x");
    assert!(messages.lines().any(is_it), "{messages}");
}

/// The board has played its scene for months, so the host does not reach the frames in 4 s.
#[test]
fn frames_that_the_host_does_not_reach_are_no_success() {
    let late = |mut message: ToHost| {
        if let ToHost::Frame(frame) = &mut message {
            frame.report.step += 1 << 30;
        }
        wire(message)
    };
    let [summary, messages] = demo(1, "--seconds 1", |bench| bench.carry(late));
    assert!(
        messages.contains("problem: no frame was compared"),
        "{messages}"
    );
    assert!(
        summary.contains("0 frames, all identical to the host (")
            && summary.contains(" waiting for the host)")
            && !summary.contains("skipped"),
        "{summary}"
    );
}

fn with_panel(mut message: ToHost, report: PanelReport) -> ToHost {
    if let ToHost::Answer(_, Answer::Status(status)) = &mut message {
        status.panel = report;
    }
    message
}

#[test]
fn state_of_the_panel_is_reported_with_the_remedy_when_it_changes() {
    let absent = PanelReport {
        state: PanelState::Absent(BusFault::NoAnswer),
        ..PanelReport::default()
    };
    let found = Found {
        controller: Controller::Sh1106,
        by: By::Memory,
        status: Some(0x48),
    };
    let shown = PanelReport {
        state: PanelState::Shown(found),
        shown: 60,
        ..PanelReport::default()
    };
    let [summary, messages] = demo(0, "--seconds 8", |bench| {
        let report = if bench.frame < 200 { absent } else { shown };
        bench.carry(|message| wire(with_panel(message, report)));
    });
    let lines: Vec<_> = messages
        .lines()
        .filter(|line| line.starts_with("panel: "))
        .collect();
    assert!(
        matches!(&lines[..], [first, second]
            if first.contains("no answer at 0x3C and 0x3D: check the wiring")
                && second.contains("sh1106 by reading its memory back (status 0x48)")),
        "{messages}"
    );
    assert!(
        summary.contains("panel                 built for oled: sh1106 by reading"),
        "{summary}"
    );
}

#[test]
fn board_without_an_oled_refuses_the_options_of_one() {
    for option in ["--panel sh1106", "--turn 180", "--dim off"] {
        let [_, messages] = demo(2, option, |bench| bench.carry(wire));
        assert!(
            messages.contains("the board refuses this panel; it has no OLED"),
            "{option}: {messages}"
        );
    }
}

#[test]
fn a_board_that_never_plays_the_requested_scene_is_an_error() {
    let mut sequence = 0;
    let [_, messages] = demo(1, "--scene butterfly", |bench| {
        sequence += 1;
        let report = Report {
            step: sequence.into(),
            ..Report::default()
        };
        bench.say(&wire(ToHost::Frame(Frame {
            sequence,
            report,
            ..Frame::default()
        })));
        bench.is_heard();
        sleep(Duration::from_millis(16));
    });
    assert!(messages.contains("no frame for 10 s"), "{messages}");
}

#[test]
fn a_pulled_cable_ends_the_command() {
    let [summary, messages] = demo(1, "--seconds 8", |bench| {
        bench.carry(wire);
        if bench.cable.is_some() && bench.frame > 200 {
            bench.unplug();
        }
    });
    assert_eq!(summary, "");
    let is_gone = |line: &str| line.starts_with("error: ") && line.contains("ttyACM0 is gone (");
    assert!(messages.lines().any(is_gone), "{messages}");
}

/// Over USB a restart ends the connection, so the board is asked for it at the next one.
#[test]
fn the_last_restart_of_a_board_is_reported_once() {
    let end = Restarted {
        cause: Some(Cause::Hang),
        restarts: 2,
        scene: SceneName::Butterfly,
        step: 1234,
        ..Restarted::default()
    };
    let [_, messages] = demo(0, "--seconds 3", |bench| {
        bench.carry(|message| match message {
            ToHost::Answer(request, Answer::Restart(None)) => {
                wire(ToHost::Answer(request, Answer::Restart(Some(end))))
            }
            message => wire(message),
        });
    });
    let restarts: Vec<_> = messages
        .lines()
        .filter(|line| line.contains("the board has"))
        .collect();
    assert_eq!(restarts.len(), 1, "{messages}");
    let line = "the board has restarted after a hang in scene butterfly, step 1234 (in a row: 2)";
    assert!(restarts[0].ends_with(line), "{messages}");
}

#[test]
fn a_foreign_device_is_reported_and_a_board_in_its_place_is_accepted() {
    let mut foreign = None;
    let [_, messages] = demo(0, "--seconds 2", |bench| {
        if bench.is_heard() && foreign.get_or_insert_with(Instant::now).elapsed() < FOREIGN {
            bench.say(FOREIGNER);
            sleep(Duration::from_millis(20));
        } else {
            bench.carry(wire);
        }
    });
    let count = |words| messages.matches(words).count();
    assert_eq!(
        ["no message; is it another device", "the board sends again"].map(count),
        [1, 1],
        "{messages}"
    );
}

#[test]
fn the_terminal_shows_no_number_of_a_silent_or_foreign_device() {
    for says in [b"", FOREIGNER] {
        let mut bench = Bench::new();
        let size = Winsize {
            ws_row: 24,
            ws_col: 80,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        let OpenptyResult { master, slave } = openpty(&size, None).expect("a terminal");
        let mut command = program("demo");
        command
            .stdin(slave.try_clone().expect("a terminal"))
            .stdout(slave)
            .stderr(Stdio::piped());
        let child = command
            .arg("--port")
            .arg(&bench.name)
            .spawn()
            .expect("it starts");
        drop(command);
        let mut keyboard = File::from(master.try_clone().expect("a terminal"));
        let mut screen = File::from(master);
        let shown = spawn(move || {
            let mut bytes = Vec::new();

            // On Linux, a closed other end is an error.
            let _ = screen.read_to_end(&mut bytes);
            String::from_utf8_lossy(&bytes).into_owned()
        });

        let ends = Instant::now() + SILENCE;
        while Instant::now() < ends {
            bench.is_heard();
            bench.say(says);
            sleep(Duration::from_millis(20));
        }
        keyboard.write_all(b"q").expect("it is heard");
        let output = child.wait_with_output().expect("it ends");
        let shown = shown.join().expect("it ends");
        assert!(shown.contains("yet") && !shown.contains("every"), "{shown}");
        let messages = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(1), "{messages}");
        assert!(
            messages.lines().count() == 1
                && messages.contains("ttyACM0: ended before the first frame"),
            "{messages}"
        );
    }
}

#[test]
fn a_silent_port_is_an_error() {
    let [summary, messages] = demo(1, "", |_| sleep(WAIT));
    assert!(
        summary.is_empty()
            && messages.contains("no data")
            && messages.contains("no frame for 10 s"),
        "{summary}{messages}"
    );
}
