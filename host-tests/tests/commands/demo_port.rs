//! `cargo demo --port`: a pseudo-terminal with an emulated board behind it, whose cable can be pulled.

use std::fs::File;
use std::io::{Read, Write};
use std::process::Stdio;
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use super::cli::program;
use crate::support::bench::{Bench, WAIT, at_port, board, wire};
use firmware::display::{BusFault, By, Controller, Found, PanelReport, PanelState};
use firmware::protocol::{Answer, Cause, Frame, Restarted, ToHost};
use firmware::scenes::{Report, SceneName};
use nix::pty::{OpenptyResult, Winsize, openpty};

/// The time for which a cable is unplugged.
const OUT: Duration = Duration::from_millis(700);
/// The time for which the terminal is watched.
const SILENCE: Duration = Duration::from_secs(3);
/// The data of a foreign device, and the time for which it is connected.
const FOREIGNER: &[u8] = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
const FOREIGN: Duration = Duration::from_secs(4);

/// Returns the output on stdout and on stderr, and checks that the command ends with `code`.
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
    let [said, _] = demo(0, "--scene butterfly --seconds 8", |bench| {
        bench.carry(damaged)
    });
    assert!(said.contains("frames, all identical to the host"), "{said}");
    assert!(
        said.contains("CRC errors            1\nlost frames           1\n"),
        "{said}"
    );
}

#[test]
fn a_motion_of_ones_own_is_played_at_a_port_too() {
    let arguments = "--scene butterfly --angles 90,45 --degrees --masses 1,3 --seconds 2";
    let [said, _] = demo(0, arguments, |bench| bench.carry(wire));
    assert!(said.contains("frames, all identical to the host"), "{said}");
}

/// The fastest board could execute these steps in time, so only this board can refuse them.
#[test]
fn a_method_that_the_board_refuses_is_named() {
    let arguments = "--method extrapolation10-fixed64 --angles 120,120 --degrees --lengths 1,1/10";
    let [said, told] = demo(2, arguments, |bench| bench.carry(wire));
    assert_eq!(said, "");
    assert!(
        told.ends_with("ttyACM0: the board refuses this method; change --method\n"),
        "{told}"
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
    let [_, told] = demo(1, "--seconds 8", |bench| bench.carry(flipped));
    let is_it =
        |line: &str| line.starts_with("not well: frame 300, step ") && line.contains(": p1 is 0x");
    assert!(told.lines().any(is_it), "{told}");
}

/// Returns the message with this state of the panel.
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
    let [said, told] = demo(0, "--seconds 8", |bench| {
        let report = if bench.frame < 200 { absent } else { shown };
        bench.carry(|message| wire(with_panel(message, report)));
    });
    let lines: Vec<_> = told
        .lines()
        .filter(|line| line.starts_with("panel: "))
        .collect();
    assert!(
        matches!(&lines[..], [first, second]
            if first.contains("no answer at 0x3C and 0x3D: check the wiring")
                && second.contains("sh1106 by reading its memory back (status 0x48)")),
        "{told}"
    );
    assert!(
        said.contains("panel                 sh1106 by reading"),
        "{said}"
    );
}

#[test]
fn board_without_a_choice_of_controllers_refuses_one() {
    let [_, told] = demo(2, "--panel sh1106", |bench| bench.carry(wire));
    assert!(
        told.contains("the board refuses this panel; the board has none"),
        "{told}"
    );
}

/// The board's frames arrive, but they are always of another scene.
#[test]
fn a_board_that_does_not_play_what_it_is_told_is_given_up() {
    let mut sequence = 0;
    let [_, told] = demo(1, "--scene butterfly", |bench| {
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
    assert!(told.contains("no frame for 10 s"), "{told}");
}

#[test]
fn a_pulled_cable_is_said_and_waited_for_and_a_board_that_restarts_is_followed_again() {
    let mut pulled = None;
    let mut restarted = false;
    let [said, told] = demo(0, "--seconds 8", |bench| {
        bench.carry(wire);
        match pulled {
            None if bench.heard && bench.frame > 200 => {
                bench.unplug();
                pulled = Some(Instant::now());
            }
            Some(since) if bench.cable.is_none() && since.elapsed() > OUT => bench.plug(),
            Some(_) if !restarted && bench.frame > 300 => {
                bench.machine = board();
                restarted = true;
            }
            _ => {}
        }
    });
    let lines: Vec<_> = told
        .lines()
        .filter(|line| line.contains("ttyACM0 is "))
        .collect();
    assert!(
        lines.len() == 2 && lines[0].contains("is gone") && lines[1].ends_with("is back"),
        "{told}"
    );
    assert!(lines[0].contains("or the board restarts"), "{told}");
    assert!(
        told.contains("the board has been switched on or reset"),
        "{told}"
    );
    assert!(said.contains("frames, all identical to the host"), "{said}");
}

/// Over USB a restart disconnects the port, and the board's message about it is lost. Only the
/// answer to the question that is asked when the port is back remains.
#[test]
fn a_board_that_comes_back_after_a_hang_is_not_taken_for_a_pulled_cable() {
    let end = Restarted {
        cause: Some(Cause::Hang),
        restarts: 2,
        scene: SceneName::Butterfly,
        step: 1234,
        ..Restarted::default()
    };
    let mut gone = None;
    let [_, told] = demo(0, "--seconds 6", |bench| {
        let has_restarted = gone.is_some();
        bench.carry(|message| match message {
            ToHost::Answer(request, Answer::Restart(None)) if has_restarted => {
                wire(ToHost::Answer(request, Answer::Restart(Some(end))))
            }
            message => wire(message),
        });
        match gone {
            None if bench.heard && bench.frame > 150 => {
                bench.unplug();
                bench.machine = board();
                gone = Some(Instant::now());
            }
            Some(since) if bench.cable.is_none() && since.elapsed() > OUT => bench.plug(),
            _ => {}
        }
    });
    let restarts: Vec<_> = told
        .lines()
        .filter(|line| line.contains("the board has"))
        .collect();
    assert_eq!(restarts.len(), 1, "{told}");
    let line = "the board has restarted after a hang in scene butterfly, step 1234 (in a row: 2)";
    assert!(restarts[0].ends_with(line), "{told}");
}

#[test]
fn a_foreign_device_is_said_and_a_board_in_its_place_is_taken() {
    let mut foreign = None;
    let [_, told] = demo(0, "--seconds 2", |bench| {
        if bench.is_heard() && foreign.get_or_insert_with(Instant::now).elapsed() < FOREIGN {
            bench.say(FOREIGNER);
            sleep(Duration::from_millis(20));
        } else {
            bench.carry(wire);
        }
    });
    let count = |words| told.matches(words).count();
    assert_eq!(
        ["no message: another device", "the board sends again"].map(count),
        [1, 1],
        "{told}"
    );
}

/// In a terminal no time limit applies, because the user can quit. The terminal shows no number
/// that was not received.
#[test]
fn of_a_silent_or_foreign_device_the_terminal_shows_no_number() {
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
        let (mut keyboard, mut screen) = (
            File::from(master.try_clone().expect("a terminal")),
            File::from(master),
        );
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
        let told = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(
            told.lines().count() == 1 && told.contains("ttyACM0: no frame came"),
            "{told}"
        );
    }
}

#[test]
fn a_port_where_nothing_comes_is_given_up() {
    let [said, told] = demo(1, "", |_| sleep(WAIT));
    assert!(
        said.is_empty() && told.contains("no data") && told.contains("no frame for 10 s"),
        "{said}{told}"
    );
}
