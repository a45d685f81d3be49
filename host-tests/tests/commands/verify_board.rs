//! `cargo verify-board`: a pseudo-terminal with an emulated board behind it.

use std::fs;
use std::io::{BufRead, BufReader, Write, pipe};
use std::process::Stdio;
use std::sync::mpsc::{Receiver, channel};
use std::thread::spawn;
use std::time::{Duration, Instant};

use super::cli::{output, program};
use crate::support::LIMIT;
use crate::support::bench::{BOARD, Bench, at_port, wire};
use boards::BOARDS;
use boards::process;
use firmware::app::Key;
use firmware::display::{BusFault, PanelState};
use firmware::job::ON_BOARDS;
use firmware::protocol::{Answer, Cause, Restarted, ToHost};
use firmware::scenes::SceneName;

const UNCOUNTED: &str = "| no cycle counter | - |";

#[test]
fn a_board_with_the_hosts_bits_is_verified_and_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = program("verify-board");
    command
        .args(["--no-questions", "--report"])
        .arg(folder.path().join("board"));
    let output = at_port(&mut Bench::new(), &mut command, |bench| {
        bench.carry(|mut message| {
            if let ToHost::Answer(_, Answer::Status(status)) = &mut message {
                status.panel.state = PanelState::Absent(BusFault::NoAnswer);
            }
            wire(message)
        })
    });
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(
        output.stdout.contains("all bit-identical to the host"),
        "{}",
        output.stdout
    );

    let markdown = fs::read_to_string(folder.path().join("board.md")).expect("the report");
    assert_eq!(
        markdown.matches(UNCOUNTED).count(),
        ON_BOARDS.len(),
        "{markdown}"
    );
    let head = [
        format!("# {}\n", BOARD.name),
        format!(", {} Hz\n", BOARD.hertz),
        "built from commit ".to_owned(),
        "- panel: built for oled: absent: no answer at 0x3C and 0x3D: check the wiring".to_owned(),
    ];
    assert!(
        head.iter().all(|part| markdown.contains(part)),
        "{markdown}"
    );

    for row in [
        "| restarts during the comparison | 0 |",
        "| restarts during this verification | 0 |",
        "| last unplanned restart | none since power-on |",
        "| a night's run | (fill in) |",
    ] {
        assert!(markdown.contains(row), "no {row:?} in {markdown}");
    }

    let agree = |columns: usize| {
        let is_row = |line: &&str| {
            line.matches('|').count() == columns + 1 && line.contains("| identical |")
        };
        markdown.lines().filter(is_row).count()
    };
    assert_eq!(
        (agree(4), agree(6)),
        (2 * ON_BOARDS.len(), SceneName::ALL.len()),
        "{markdown}"
    );
}

#[test]
fn a_report_that_cannot_be_written_is_refused_at_the_start() {
    let mut command = program("verify-board");
    command.args(["--port", "/nowhere/port", "--report", "/nowhere/report"]);
    let output = output(&mut command);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let error = "error: --report: cannot write /nowhere/report.md: ";
    assert!(output.stderr.starts_with(error), "{output:?}");
}

#[test]
fn missing_tools_are_refused_before_the_measurements() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = program("verify-board");
    command
        .args(["--no-questions", "--report"])
        .arg(folder.path().join("report"))
        .env("PATH", folder.path())
        .env("CARGO_TARGET_DIR", folder.path());
    let mut samples = 0;
    let output = at_port(&mut Bench::new(), &mut command, |bench| {
        bench.carry(|message| {
            samples += u32::from(matches!(message, ToHost::Answer(_, Answer::Sample { .. })));
            wire(message)
        })
    });
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stderr.contains(" is missing: "), "{output:?}");
    assert_eq!(samples, 0, "{output:?}");
}

#[test]
fn a_board_that_only_answers_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = program("verify-board");
    command
        .args(["--no-questions", "--report"])
        .arg(folder.path().join("report"));
    let output = at_port(&mut Bench::new(), &mut command, |bench| {
        bench.carry(|message| {
            let is_lost = message
                .frame()
                .is_some_and(|frame| frame.scene == SceneName::ALL[1]);
            wire(if is_lost {
                ToHost::Answer(0, Answer::Done)
            } else {
                message
            })
        })
    });
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let error = ": the board answers but sends no frames for 20 s; flash it again";
    assert!(output.stderr.trim_end().ends_with(error), "{output:?}");
}

#[test]
fn a_silent_board_is_reported_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = program("verify-board");
    command
        .args(["--no-questions", "--report"])
        .arg(folder.path().join("report"));
    let output = at_port(&mut Bench::new(), &mut command, |bench| {
        bench.carry(|_| Vec::new())
    });
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let lines: Vec<_> = output.stderr.lines().collect();
    assert!(
        matches!(lines[..], [notice, error]
            if notice.contains(": no data; is the board powered")
                && error.starts_with("error: ")
                && error.contains(": no expected message for 20 s")),
        "{output:?}"
    );
}

const PATIENCE: Duration = Duration::from_secs(10);

/// Returns the button to tap and the line to enter; `None` ends the input.
fn person(question: &str) -> Option<(Option<Key>, Option<&'static str>)> {
    if question.contains("the panel shows a swinging pendulum") {
        return Some((None, Some("n\n")));
    }
    let key = Key::ALL
        .iter()
        .copied()
        .find(|key| question.contains(&format!("tap the button '{}'", key.name())))?;
    Some(match key {
        Key::Up | Key::Right => (Some(key), Some("\n")),
        Key::Down => (None, Some("\n")),
        Key::Left => (None, Some("n\n")),
        Key::Select => (None, None),
    })
}

/// A frame that ended 15 ms before it began, by a clock that is read wrongly: 86 s at 50 MHz.
const OVERLONG: u32 = 0_u32.wrapping_sub(750_000);

const HANG: Restarted = Restarted {
    cause: Some(Cause::Hang),
    scene: SceneName::Upright,
    step: 20,
    restarts: 1,
    pc: 0,
    lr: 0,
    cfsr: 0,
};

/// Changes the messages of an emulated board, which has no cycle counter, into those of a chip with
/// one. It counts 100 cycles for a step of the second arithmetic, and none for the others. One bit
/// is flipped in a motion of it, and one in a scene. In another scene a frame takes longer than the
/// run, and the board reports a restart after it.
#[derive(Default)]
struct Counting {
    measurements: u32,
    /// The step whose angle has a flipped bit.
    flipped: Option<u64>,
    is_overlong: bool,
}

/// The first frame from this step on is changed. A board that is read late drops frames, so that a
/// given step may never be sent.
const STEP: u64 = 20;

impl Counting {
    fn change(&mut self, mut message: ToHost) -> Vec<u8> {
        match &mut message {
            ToHost::Answer(_, Answer::Measured { steps, cycles }) => {
                let is_counted = (1..17).contains(&self.measurements);
                *cycles = if is_counted { *steps * 100 } else { 0 };
                self.measurements += 1;
            }
            ToHost::Answer(3, Answer::Sample { index: 5, reading }) => {
                let [_, w2] = &mut reading.velocities;
                *w2 = f64::from_bits(w2.to_bits() ^ 1);
            }
            ToHost::Frame(frame) if frame.report.step >= STEP => match frame.scene {
                SceneName::Butterfly if self.flipped.is_none() => {
                    self.flipped = Some(frame.report.step);
                    let a1 = &mut frame.report.state.a1;
                    *a1 = f32::from_bits(a1.to_bits() ^ 1);
                }
                SceneName::Upright if !self.is_overlong => {
                    self.is_overlong = true;
                    frame.busy_cycles = OVERLONG;
                    return [wire(message), wire(ToHost::Restarted(HANG))].concat();
                }
                _ => {}
            },
            _ => {}
        }
        wire(message)
    }
}

/// The six problems are two flipped bits, a frame that is too long, a restart, the panel and a
/// button.
#[test]
fn the_report_has_differences_answers_of_the_person_and_counted_cycles() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bench = Bench::of(&BOARDS[0]);
    bench.machine.wake_keys().expect("buttons");
    let mut command = program("verify-board");
    command
        .arg("--port")
        .arg(&bench.name)
        .arg("--report")
        .arg(folder.path().join("asked"));
    let (_, stdout) = pipe().expect("a pipe");
    command
        .stdin(Stdio::piped())
        .stdout(stdout)
        .stderr(Stdio::piped());
    let mut verification = process::spawn(&mut command, LIMIT).expect("it starts");
    let mut input = verification.child.stdin.take();
    let lines = lines(BufReader::new(
        verification.child.stderr.take().expect("a pipe"),
    ));
    let mut said = Vec::new();
    let mut counting = Counting::default();
    let mut step = 0;

    let mut carry = |bench: &mut Bench| {
        bench.carry(|message| {
            step = message.frame().map_or(step, |frame| frame.report.step);
            counting.change(message)
        });
        step
    };
    let status = loop {
        carry(&mut bench);
        if let Some(status) = verification.try_wait().expect("it runs") {
            break status;
        }
        let Ok(line) = lines.try_recv() else { continue };
        if let Some((key, entered)) = person(&line) {
            if let Some(key) = key {
                let before = carry(&mut bench);
                let since = Instant::now();
                bench.machine.set_key(key, true).expect("buttons");

                while carry(&mut bench) >= before && since.elapsed() < PATIENCE {}
                bench.machine.set_key(key, false).expect("buttons");
            }
            // The end of the input is no answer.
            input = input.filter(|_| entered.is_some());
            if let Some((input, entered)) = input.as_mut().zip(entered) {
                input.write_all(entered.as_bytes()).expect("it listens");
            }
        }
        said.push(line);
    };
    said.extend(lines);
    assert_eq!(status.code(), Some(1), "{said:#?}");
    let markdown = fs::read_to_string(folder.path().join("asked.md")).expect("the report");

    let sample = format!("problem: {}, chaotic: step 160: w2 is 0x", ON_BOARDS[1]);
    assert!(
        said.iter().any(|line| line.starts_with(&sample)),
        "no {sample:?} in {said:#?}"
    );
    let step = counting.flipped.expect("a frame of the butterfly");
    let flipped = format!("step {step}: a1 is 0x");
    let scene = said
        .iter()
        .find(|line| line.starts_with("problem: butterfly: frame"));
    assert!(
        scene.is_some_and(|line| line.contains(&flipped)),
        "{said:#?}"
    );

    let too_long = "problem: upright: a frame of 85884.35 ms in a run of ";
    assert!(
        said.iter().any(|line| line.starts_with(too_long)),
        "no {too_long:?} in {said:#?}"
    );

    let restart = "the board has restarted after a hang in scene upright, step 20 (in a row: 1)";
    assert!(said.iter().any(|line| line.ends_with(restart)), "{said:#?}");
    assert!(
        said.contains(&"problem: restarts during the comparison: 1".to_owned()),
        "{said:#?}"
    );
    assert!(
        markdown.contains("| restarts during the comparison | 1 |"),
        "{markdown}"
    );

    assert!(
        markdown.contains("problems: 6") && markdown.contains("step 160: w2 is 0x"),
        "{markdown}"
    );

    let panel = "the panel shows a swinging pendulum, upright and sharp".to_owned();
    let button = |key: &Key| {
        format!(
            "a tap on the button '{}' starts the motion again",
            key.name()
        )
    };
    let answers = ["no", "yes", "no", "not answered", "yes", "not answered"];

    for (what, answer) in [panel]
        .into_iter()
        .chain(Key::ALL.iter().map(button))
        .zip(answers)
    {
        assert!(
            markdown.contains(&format!("| {what} | {answer} |")),
            "{what}: not {answer} in {markdown}"
        );
        assert_eq!(
            said.contains(&format!("problem: answered no: {what}")),
            answer == "no",
            "{said:#?}"
        );
    }

    let counted = format!("| {} | 100.0 | ", ON_BOARDS[1]);
    let estimate: Option<f64> = markdown
        .split_once(&counted)
        .and_then(|(_, rest)| rest.split(' ').next()?.parse().ok());

    // A step takes some 23,000 cycles (`cargo count`).
    assert!(
        estimate.is_some_and(|estimate| (1e4..4e4).contains(&estimate)),
        "{markdown}"
    );
    assert_eq!(
        markdown.matches(UNCOUNTED).count(),
        ON_BOARDS.len() - 1,
        "{markdown}"
    );
}

fn lines(source: impl BufRead + Send + 'static) -> Receiver<String> {
    let (line, lines) = channel();
    spawn(move || {
        source
            .lines()
            .map_while(Result::ok)
            .try_for_each(|text| line.send(text))
    });
    lines
}
