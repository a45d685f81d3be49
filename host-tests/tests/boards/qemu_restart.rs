//! Things that go wrong in the running application: what is said of them, and how the board comes back.
//!
//! All but the panic are injected into the images that are flashed, from outside: a debugger stops the board in the middle of a frame
//! that is drawn but not yet sent, and sends its processor elsewhere.

use std::path::PathBuf;
use std::time::Duration;

use crate::support::{address, application, on, settings, toolchain};
use cycles::Image;
use firmware::app::MOST_RESTARTS;
use firmware::protocol::{Cause, Command, Field, Frame, Restarted, ToHost};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board, STM32F405};
use host_tests::emulator::qemu::{Machine, Register, Settings};

/// The lowest addresses of the stack, where it never reaches.
const UNUSED: u32 = 0x2000_8000;
/// Two instructions: `b .`, an endless loop, and `udf #0`, which is none.
const HANG: [u8; 2] = [0xfe, 0xe7];
const UNDEFINED: [u8; 2] = [0x00, 0xde];
/// Frames of the scene that are waited for.
const FRAMES: usize = 20;
/// The stopwatch is read when a frame is begun, when it is drawn, and when it is sent.
const STOPWATCH: &str = "clock::cycles";
/// The mass ratio that the tests set, unlike any scene's own.
const MASS_RATIO: f32 = 0.7;

/// A board that nothing restarts is given up after this long, by the host's clock: many times what a restart takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// A board, with a debugger that takes its log or without, that stands still in the middle of a frame of `scene`, with a mass ratio of
/// its own: its program, and the last frame it has sent.
fn within(
    board: &Board,
    scene: SceneName,
    debugger: bool,
) -> anyhow::Result<(PathBuf, Machine, Frame)> {
    let elf = application(board);
    let mut probe = on(board, |settings| {
        Machine::halted(&Settings {
            debugger,
            limit: PATIENCE,
            ..*settings
        })
    })?;
    // A serial port that is not yet on takes no bytes.
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
    // To stop rarely is quicker: QEMU then forgets what it has translated.
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
            // This reading was for the end of the frame; the next is for the beginning, then the frame is drawn.
            probe.run_to(stopwatch)?;
            probe.run_to(stopwatch)?;
            return Ok((elf, probe, frame));
        }
    }
}

/// Puts an instruction where it disturbs nothing, and the processor there.
fn execute(probe: &mut Machine, instruction: [u8; 2]) -> anyhow::Result<()> {
    probe.write(UNUSED, &instruction)?;
    probe.divert(&[(Register::Pc, UNUSED)])
}

/// The boards whose watchdog is emulated.
fn watched() -> impl Iterator<Item = &'static Board> {
    BOARDS.iter().filter(|board| **board != STM32F405)
}

/// Where a report says that the board was.
fn place(frame: &Frame) -> String {
    format!("scene {}, step {}\n", frame.scene.name(), frame.report.step)
}

/// Holds that a board has said all `parts`.
fn assert_said(board: &Board, said: &str, parts: &[&str]) {
    for part in parts {
        assert!(
            said.contains(part),
            "{}: no {part:?} in\n{said}",
            board.name
        );
    }
}

/// The last words of a machine that ends as a failure, which hold all `parts`.
fn last_words(board: &Board, machine: &mut Machine, parts: &[&str]) -> anyhow::Result<String> {
    let mut report = String::new();
    let status = machine.wait(|line| report += &format!("{line}\n"))?;
    assert_eq!(status.code(), Some(1), "{report}");
    assert_said(board, &report, parts);
    Ok(report)
}

#[test]
fn a_fault_in_a_picture_tells_the_scene_and_the_step() -> anyhow::Result<()> {
    let registers = format!("pc {UNUSED:#010x}  lr 0x12345679");
    for board in &BOARDS {
        let [why, cfsr] = match board.is_guarded() {
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
fn a_stack_that_overflows_in_a_picture_meets_the_guard_and_changes_nothing_below()
-> anyhow::Result<()> {
    for board in BOARDS.iter().filter(|board| board.is_guarded()) {
        let (elf, mut probe, frame) = within(board, SceneName::Butterfly, true)?;
        let statics = address(&elf, "_ram_start")..address(&elf, "__euninit");
        let before = probe.read(statics.clone())?;
        assert!(before.len() > 1024, "there is something to damage");
        probe.divert(&[
            (Register::Sp, UNUSED),
            (Register::Pc, address(&elf, "Player::execute")),
        ])?;
        probe.run_to(address(&elf, "HardFault"))?;
        assert!(probe.read(statics)? == before, "the statics are damaged");
        let lost = "pc and lr are lost; the last call on the stack is at 0x";
        last_words(
            board,
            probe.run()?,
            &[
                "HARDFAULT: stack overflow",
                lost,
                "cfsr 0x000000",
                &place(&frame),
            ],
        )?;
    }
    Ok(())
}

/// The name of the function at the address that the report gives after `what`.
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

#[test]
fn a_panic_tells_where_and_why_and_ends_the_run_as_a_failure() -> anyhow::Result<()> {
    let toolchain = toolchain();
    for board in &BOARDS {
        let elf = toolchain.build("inject-panic", board.target)?;
        let parts = [
            "boot: about to panic",
            "PANIC",
            "inject-panic.rs:",
            "injected with the number 42",
            "cfsr 0x00000000",
        ];
        let report = last_words(
            board,
            &mut Machine::start(&settings(&toolchain, board, &elf))?,
            &parts,
        )?;
        let image = Image::read(&elf)?;
        for (what, name) in [("pc", "panic_fmt"), ("lr", "main")] {
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
fn a_board_that_hangs_comes_back_where_it_was_and_says_why() -> anyhow::Result<()> {
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
        let last = format!("restarted after a hang, 1 in a row: {pc}");
        assert_said(
            board,
            &machine.said(),
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

#[test]
fn without_a_debugger_a_fault_restarts_the_board() -> anyhow::Result<()> {
    for board in watched() {
        let (elf, mut probe, before) = within(board, SceneName::Figure7, false)?;
        for restarts in 1..=MOST_RESTARTS + 1 {
            // As where the program ends while it writes the first copy.
            probe.write(address(&elf, "retained::KEPT") + 8, &[0; 8])?;
            execute(&mut probe, UNDEFINED)?;
            // This one comes while the scene is started, after the first scene was.
            if restarts == 2 {
                probe.run_to(address(&elf, "Player::play"))?;
                probe.run_to(address(&elf, "Player::play"))?;
                continue;
            }
            // To the first frame after the restart.
            let stopwatch = address(&elf, STOPWATCH);
            let (mut restarted, mut frame) = (None, None);
            while frame.is_none() {
                probe.run_to(stopwatch)?;
                for message in probe.messages()? {
                    restarted = restarted.or(message.restarted());
                    frame = frame.or(message.frame());
                }
            }
            let restarted = restarted.expect("said before the first frame");
            let cfsr = if board.is_guarded() { 1 << 16 } else { 0 };
            assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
            assert_eq!(
                (restarted.restarts, restarted.pc, restarted.cfsr),
                (restarts, UNUSED, cfsr),
                "{}",
                board.name
            );
            assert_eq!(restarted.scene, before.scene, "{}", board.name);
            // What ends the board each time is given up.
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

/// The watchdog's call that cannot be masked comes in the middle of a report that takes long: the fault stays the reason.
#[test]
fn a_report_that_takes_long_is_no_hang() -> anyhow::Result<()> {
    for board in watched() {
        let (elf, mut probe, _) = within(board, SceneName::Butterfly, true)?;
        execute(&mut probe, UNDEFINED)?;
        probe.run_to(address(&elf, "crash::say"))?;
        execute(&mut probe, HANG)?;
        let machine = probe.run()?;
        let restarted = machine.wait_for(ToHost::restarted)?;
        assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
        let log = machine.said();
        assert!(!log.contains("HANG"), "{}: {log}", board.name);
    }
    Ok(())
}
