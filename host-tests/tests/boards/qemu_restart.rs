//! Faults in the running application: their reports, and the restart of the board.
//!
//! The faults are injected into the images that are flashed. A debugger stops the board in the
//! middle of a frame that is drawn but not yet sent, and diverts its processor.

use std::path::PathBuf;
use std::time::Duration;

use crate::support::{address, application, on};
use boards::qemu::{Machine, MachineSettings, Register};
use boards::{BOARDS, Board, STM32F405};
use cycles::Image;
use firmware::app::MOST_RESTARTS;
use firmware::protocol::{Cause, Command, Field, Frame, Restarted, ToHost};
use firmware::scenes::SceneName;

const UNUSED: u32 = 0x2000_0000;
const HUGE: u32 = 100 * 1024;
/// Two instructions: `b .`, an endless loop, and `udf #0`, which is undefined.
const HANG: [u8; 2] = [0xfe, 0xe7];
const UNDEFINED: [u8; 2] = [0x00, 0xde];
const FRAMES: usize = 20;
/// Reads the cycle counter at the beginning of a frame, after drawing, and after sending.
const STOPWATCH: &str = "clock::cycles";
const MASS_RATIO: f32 = 0.7;

const PATIENCE: Duration = Duration::from_secs(120);

/// Returns a board that is stopped in the middle of a frame of `scene` with the tests' mass ratio.
fn within(
    board: &Board,
    scene: SceneName,
    debugger: bool,
) -> anyhow::Result<(PathBuf, Machine, Frame)> {
    let elf = application(board);
    let mut probe = on(board, |settings| {
        Machine::halted(&MachineSettings {
            debugger,
            limit: PATIENCE,
            ..*settings
        })
    })?;

    // A serial port that is not yet enabled receives no bytes.
    let stopwatch = address(&elf, STOPWATCH);
    probe.run_to(stopwatch)?;
    probe.send(1, Command::Choose(scene))?;
    probe.send(
        2,
        Command::Set {
            field: Field::MassRatio,
            value: MASS_RATIO.into(),
        },
    )?;

    // Rare stops are faster, because QEMU discards its translated code at each stop.
    let is_it = |frame: &Frame| frame.scene == scene && frame.mass_ratio == MASS_RATIO;
    let machine = probe.run()?;
    let mut seen = 0;
    while seen < FRAMES {
        seen += usize::from(is_it(&machine.next_frame()?));
    }
    probe.stop()?;
    probe.messages()?;

    loop {
        probe.run_to(stopwatch)?;
        if let Some(frame) = probe.messages()?.into_iter().rev().find_map(ToHost::frame) {
            assert!(is_it(&frame), "{frame:?}");

            // This reading was at the end of the frame. The next is at the beginning, and the one
            // after it follows the drawing.
            probe.run_to(stopwatch)?;
            probe.run_to(stopwatch)?;
            return Ok((elf, probe, frame));
        }
    }
}

fn execute(probe: &mut Machine, instruction: [u8; 2]) -> anyhow::Result<()> {
    probe.write(UNUSED, &instruction)?;
    probe.divert(&[(Register::Pc, UNUSED)])
}

fn watched() -> impl Iterator<Item = &'static Board> {
    BOARDS.iter().filter(|board| **board != STM32F405)
}

fn place(frame: &Frame) -> String {
    format!("scene {}, step {}\n", frame.scene.name(), frame.report.step)
}

fn assert_logged(board: &Board, log: &str, parts: &[&str]) {
    for part in parts {
        assert!(log.contains(part), "{}: no {part:?} in\n{log}", board.name);
    }
}

fn last_words(board: &Board, machine: &mut Machine, parts: &[&str]) -> anyhow::Result<String> {
    let mut report = String::new();
    let status = machine.wait(|line| report += &format!("{line}\n"))?;
    assert_eq!(status.code(), Some(1), "{report}");
    assert_logged(board, &report, parts);
    Ok(report)
}

#[test]
fn a_fault_in_a_frame_reports_the_scene_and_the_step() -> anyhow::Result<()> {
    let registers = format!("pc {UNUSED:#010x}  lr 0x12345679");
    for board in &BOARDS {
        // A Cortex-M0+ does not report the cause of a fault.
        let [why, cfsr] = match board.reports_causes() {
            true => ["HARDFAULT: undefined instruction", "cfsr 0x00010000"],
            false => ["HARDFAULT: unknown cause (a Cortex-M0+ tells none)", ""],
        };
        let (_, mut probe, frame) = within(board, SceneName::Figure7, true)?;
        execute(&mut probe, UNDEFINED)?;
        probe.divert(&[(Register::Lr, 0x1234_5679)])?;
        last_words(
            board,
            probe.run()?,
            &[why, &registers, cfsr, &place(&frame)],
        )?;
    }
    Ok(())
}

#[test]
fn a_stack_overflow_in_a_frame_is_reported_however_large_the_frame() -> anyhow::Result<()> {
    for board in &BOARDS {
        let (elf, mut probe, frame) = within(board, SceneName::Butterfly, true)?;
        probe.divert(&[
            (Register::Sp, address(&elf, "_stack_start") - HUGE),
            (Register::Pc, address(&elf, "Player::draw")),
        ])?;
        let lost = "pc and lr are lost; the last call on the stack is at 0x";
        last_words(
            board,
            probe.run()?,
            &["HARDFAULT: stack overflow", lost, &place(&frame)],
        )?;
    }
    Ok(())
}

fn function_after(what: &str, report: &str, image: &Image) -> String {
    let digits = report
        .split_once(what)
        .and_then(|(_, rest)| rest.trim_start().strip_prefix("0x"));
    let address = digits.and_then(|digits| u32::from_str_radix(digits.get(..8)?, 16).ok());
    let address = address.unwrap_or_else(|| panic!("no address after {what:?} in\n{report}"));
    image
        .function_at(address)
        .map_or(String::new(), |function| function.name.clone())
}

/// A board can be taken only once, so a second start of the program panics.
#[test]
fn a_panic_reports_its_place_and_reason_and_ends_with_failure() -> anyhow::Result<()> {
    for board in &BOARDS {
        let (elf, mut probe, frame) = within(board, SceneName::Page, true)?;
        probe.divert(&[(Register::Pc, address(&elf, "main"))])?;
        let report = last_words(
            board,
            probe.run()?,
            &[
                "PANIC",
                &format!("{}.rs:", board.binary),
                "the board was taken before",
                "cfsr 0x00000000",
                &place(&frame),
            ],
        )?;

        let image = Image::read(&elf)?;
        for (what, name) in [("pc", "panic_fmt"), ("lr", "__cortex_m_rt_main")] {
            let caller = function_after(what, &report, &image);
            assert!(
                caller.contains(name),
                "{}: {what} in {caller}\n{report}",
                board.name
            );
        }
    }

    Ok(())
}

#[test]
fn a_board_that_hangs_restarts_in_its_scene_and_reports_the_cause() -> anyhow::Result<()> {
    for board in watched() {
        let (_, mut probe, before) = within(board, SceneName::Butterfly, true)?;
        execute(&mut probe, HANG)?;
        let machine = probe.run()?;
        let Restarted {
            cause,
            restarts,
            pc,
            scene,
            step,
            ..
        } = machine.wait_for(ToHost::restarted)?;
        assert_eq!(
            (cause, restarts, pc),
            (Some(Cause::Hang), 1, UNUSED),
            "{}",
            board.name
        );
        assert_eq!(
            (scene, step),
            (before.scene, before.report.step),
            "{}",
            board.name
        );

        for sequence in 0..FRAMES as u32 {
            let frame = machine.next_frame()?;
            let step = u64::from(sequence) + 1;
            assert_eq!(
                (frame.sequence, frame.report.step),
                (sequence, step),
                "{}",
                board.name
            );
            assert_eq!(
                (frame.scene, frame.mass_ratio),
                (before.scene, MASS_RATIO),
                "{}",
                board.name
            );
        }
        assert_eq!(
            (machine.counts().damaged, machine.counts().lost),
            (0, 0),
            "{}",
            board.name
        );

        let pc = format!("pc {UNUSED:#010x}");
        let last = format!("restarted after a hang (in a row: 1): {pc}");
        assert_logged(
            board,
            &machine.log_text(),
            &[
                "HANG: no frame finished for 1 s\n",
                &pc,
                &place(&before),
                &last,
            ],
        );
    }

    Ok(())
}

/// A copy of the record is damaged. One fault is while the scene is started.
#[test]
fn without_a_debugger_a_fault_restarts_the_board() -> anyhow::Result<()> {
    for board in watched() {
        let (elf, mut probe, before) = within(board, SceneName::Figure7, false)?;
        for restarts in 1..=MOST_RESTARTS + 1 {
            // This is the state if the program ends while it writes the first copy.
            probe.write(address(&elf, "retained::KEPT") + 8, &[0; 8])?;
            execute(&mut probe, UNDEFINED)?;

            if restarts == 2 {
                probe.run_to(address(&elf, "Player::play_by"))?;
                probe.run_to(address(&elf, "Player::play_by"))?;
                continue;
            }

            let stopwatch = address(&elf, STOPWATCH);
            let mut restarted = None;
            let mut frame = None;
            while frame.is_none() {
                probe.run_to(stopwatch)?;
                for message in probe.messages()? {
                    restarted = restarted.or(message.restarted());
                    frame = frame.or(message.frame());
                }
            }

            let restarted = restarted.expect("sent before the first frame");
            let cfsr = if board.reports_causes() { 1 << 16 } else { 0 };
            assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
            assert_eq!(
                (restarted.restarts, restarted.pc, restarted.cfsr),
                (restarts, UNUSED, cfsr),
                "{}",
                board.name
            );
            assert_eq!(restarted.scene, before.scene, "{}", board.name);

            let scene = if restarts <= MOST_RESTARTS {
                SceneName::Figure7
            } else {
                SceneName::Page
            };
            assert_eq!(
                frame.map(|frame| frame.scene),
                Some(scene),
                "{}: restart {restarts}",
                board.name
            );
        }
    }

    Ok(())
}

/// The watchdog's non-maskable interrupt arrives in the report.
#[test]
fn a_report_that_takes_long_is_no_hang() -> anyhow::Result<()> {
    for board in watched() {
        let (elf, mut probe, _) = within(board, SceneName::Butterfly, true)?;
        // The report begins, and hangs.
        execute(&mut probe, UNDEFINED)?;
        probe.run_to(address(&elf, "crash::say"))?;
        execute(&mut probe, HANG)?;

        let machine = probe.run()?;
        let restarted = machine.wait_for(ToHost::restarted)?;
        assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
        let log = machine.log_text();
        assert!(!log.contains("HANG"), "{}: {log}", board.name);
    }
    Ok(())
}
