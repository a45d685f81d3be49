//! Things that go wrong in the running application: what is said of them, and how the board comes back.
//!
//! All but the panic are injected into the images that are flashed, from outside: a debugger stops the board in the middle of a frame
//! that is drawn but not yet sent, and sends its processor elsewhere.

use std::path::Path;
use std::time::Duration;

use crate::support::{address, application, on, settings, toolchain};
use cycles::Image;
use firmware::app::MOST_RESTARTS;
use firmware::protocol::{Cause, Command, Field, Frame, Restarted, ToHost};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board, STM32F405};
use host_tests::emulator::qemu::{Lockstep, Machine, Register, Settings};

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

/// A board that stands still in the middle of a frame of `scene`, with a mass ratio of its own: the last frame it has
/// sent.
fn within(probe: &mut Lockstep, elf: &Path, scene: SceneName) -> anyhow::Result<Frame> {
    // A serial port that is not yet on takes no bytes.
    let stopwatch = address(elf, STOPWATCH);
    probe.run_to(stopwatch)?;
    let serial = &mut probe.machine().serial;
    serial.send(1, Command::Choose(scene))?;
    serial.send(2, Command::Set { field: Field::MassRatio, value: MASS_RATIO.into() })?;
    // To stop rarely is quicker: QEMU then forgets what it has translated.
    let is_it = |frame: &Frame| frame.scene == scene && frame.mass_ratio == MASS_RATIO;
    let machine = probe.run()?;
    let mut seen = 0;
    while seen < FRAMES {
        seen += usize::from(is_it(&machine.next_frame()?));
    }
    probe.stop()?;
    probe.machine().serial.all_arrived().for_each(drop);
    loop {
        probe.run_to(stopwatch)?;
        if let Some(frame) = probe.machine().serial.frames_arrived().last() {
            assert!(is_it(&frame), "{frame:?}");
            // This reading was for the end of the frame; the next is for the beginning, then the frame is drawn.
            probe.run_to(stopwatch)?;
            probe.run_to(stopwatch)?;
            return Ok(frame);
        }
    }
}

/// Puts an instruction where it disturbs nothing, and the processor there.
fn execute(probe: &mut Lockstep, instruction: [u8; 2]) -> anyhow::Result<()> {
    probe.write(UNUSED, &instruction)?;
    probe.divert(&[(Register::Pc, UNUSED)])
}

/// Holds that a board has said all `parts`.
fn assert_said(board: &Board, said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "{}: no {part:?} in\n{said}", board.name);
    }
}

/// The last words of a machine that ends as a failure.
fn last_words(machine: &mut Machine) -> anyhow::Result<String> {
    let (status, lines) = machine.wait()?;
    let report = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
    assert_eq!(status.code(), Some(1), "{report}");
    Ok(report)
}

/// Spoils a board in the middle of a frame of `scene`; its last words must hold all `parts`, and where it was.
fn says(
    board: &Board,
    scene: SceneName,
    parts: &[&str],
    spoil: impl Fn(&mut Lockstep, &Path) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let elf = application(board);
    let mut probe = on(board, Lockstep::start)?;
    let frame = within(&mut probe, &elf, scene)?;
    spoil(&mut probe, &elf)?;
    let report = last_words(probe.run()?)?;
    assert_said(board, &report, parts);
    assert_said(board, &report, &[&format!("scene {}, step {}\n", scene.name(), frame.report.step)]);
    Ok(())
}

#[test]
fn a_fault_in_a_picture_tells_the_scene_and_the_step() -> anyhow::Result<()> {
    let registers = format!("pc {UNUSED:#010x}  lr 0x12345679");
    for board in &BOARDS {
        let parts = match board.is_guarded() {
            true => ["HARDFAULT: undefined instruction", &registers, "cfsr 0x00010000"],
            false => ["HARDFAULT: unknown cause (a Cortex-M0+ tells none)", &registers, ""],
        };
        says(board, SceneName::Figure7, &parts, |probe, _| {
            execute(probe, UNDEFINED)?;
            probe.divert(&[(Register::Lr, 0x1234_5679)])
        })?;
    }
    Ok(())
}

#[test]
fn a_stack_that_overflows_in_a_picture_meets_the_guard_and_changes_nothing_below() -> anyhow::Result<()> {
    let parts =
        ["HARDFAULT: stack overflow", "pc and lr are lost; the last call on the stack is at 0x", "cfsr 0x000000"];
    BOARDS.iter().filter(|board| board.is_guarded()).try_for_each(|board| {
        says(board, SceneName::Butterfly, &parts, |probe, elf| {
            let statics = address(elf, "_ram_start")..address(elf, "__euninit");
            let before = probe.read(statics.clone())?;
            assert!(before.len() > 1024, "there is something to damage");
            probe.divert(&[(Register::Sp, UNUSED), (Register::Pc, address(elf, "Player::execute"))])?;
            probe.run_to(address(elf, "HardFault"))?;
            assert!(probe.read(statics)? == before, "the statics are damaged");
            Ok(())
        })
    })
}

/// The name of the function at the address that the report gives after `what`.
fn function_after(what: &str, report: &str, image: &Image) -> String {
    let digits = report.split_once(what).and_then(|(_, rest)| rest.trim_start().strip_prefix("0x"));
    let address = digits.and_then(|digits| u32::from_str_radix(digits.get(..8)?, 16).ok());
    let address = address.unwrap_or_else(|| panic!("no address after {what:?} in\n{report}"));
    image.function_at(address).map_or(String::new(), |function| function.name.clone())
}

#[test]
fn a_panic_tells_where_and_why_and_ends_the_run_as_a_failure() -> anyhow::Result<()> {
    let toolchain = toolchain();
    for board in &BOARDS {
        let elf = toolchain.build("inject-panic", board.target)?;
        let report = last_words(&mut Machine::start(&settings(&toolchain, board, &elf))?)?;
        let parts =
            ["boot: about to panic", "PANIC", "inject-panic.rs:", "injected with the number 42", "cfsr 0x00000000"];
        assert_said(board, &report, &parts);
        let image = Image::read(&elf)?;
        for (what, name) in [("pc", "panic_fmt"), ("lr", "main")] {
            let caller = function_after(what, &report, &image);
            assert!(caller.contains(name), "{}: {what} in {caller}\n{report}", board.name);
        }
    }
    Ok(())
}

/// A board that nothing restarts is given up after this long, by the host's clock: many times what a restart takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// Each board whose watchdog is emulated, with a debugger that takes its log or without, in the middle of a frame of `scene`, and
/// that frame's predecessor.
fn watched(
    scene: SceneName,
    debugger: bool,
    mut check: impl FnMut(&Board, &Path, Lockstep, Frame) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    for board in BOARDS.iter().filter(|board| **board != STM32F405) {
        let elf = application(board);
        let start = |settings: &Settings| Lockstep::start(&Settings { debugger, limit: PATIENCE, ..*settings });
        let mut probe = on(board, start)?;
        let before = within(&mut probe, &elf, scene)?;
        check(board, &elf, probe, before)?;
    }
    Ok(())
}

#[test]
fn a_board_that_hangs_comes_back_where_it_was_and_says_why() -> anyhow::Result<()> {
    watched(SceneName::Butterfly, true, |board, _, mut probe, before| {
        execute(&mut probe, HANG)?;
        let machine = probe.run()?;
        let Restarted { cause, restarts, pc, scene, step, .. } = machine.wait_for(ToHost::restarted)?;
        assert_eq!((cause, restarts, pc), (Some(Cause::Hang), 1, UNUSED), "{}", board.name);
        assert_eq!((scene, step), (SceneName::Butterfly, before.report.step), "{}", board.name);
        for sequence in 0..FRAMES as u32 {
            let frame = machine.next_frame()?;
            let step = u64::from(sequence) + 1;
            assert_eq!((frame.sequence, frame.report.step), (sequence, step), "{}", board.name);
            assert_eq!((frame.scene, frame.mass_ratio), (before.scene, MASS_RATIO), "{}", board.name);
        }
        assert_eq!((machine.serial.counts().damaged, machine.serial.counts().lost), (0, 0), "{}", board.name);
        let (pc, place) = (format!("pc {UNUSED:#010x}"), format!("scene butterfly, step {}\n", before.report.step));
        let last = format!("restarted after a hang, 1 in a row: {pc}");
        assert_said(board, &machine.said(), &["HANG: no frame finished for 1 s\n", &pc, &place, &last]);
        Ok(())
    })
}

#[test]
fn without_a_debugger_a_fault_restarts_the_board() -> anyhow::Result<()> {
    watched(SceneName::Figure7, false, |board, elf, mut probe, before| {
        for restarts in 1..=MOST_RESTARTS + 1 {
            execute(&mut probe, UNDEFINED)?;
            // To the first frame after the restart.
            let stopwatch = address(elf, STOPWATCH);
            let (mut restarted, mut frame) = (None, None);
            while frame.is_none() {
                probe.run_to(stopwatch)?;
                for message in probe.machine().serial.all_arrived() {
                    restarted = restarted.or(message.restarted());
                    frame = frame.or(message.frame());
                }
            }
            let restarted = restarted.expect("said before the first frame");
            let cfsr = if board.is_guarded() { 1 << 16 } else { 0 };
            assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
            assert_eq!((restarted.restarts, restarted.pc, restarted.cfsr), (restarts, UNUSED, cfsr), "{}", board.name);
            assert_eq!(restarted.scene, before.scene, "{}", board.name);
            // What ends the board each time is given up.
            let scene = if restarts <= MOST_RESTARTS { SceneName::Figure7 } else { SceneName::Page };
            assert_eq!(frame.map(|frame| frame.scene), Some(scene), "{}: restart {restarts}", board.name);
        }
        Ok(())
    })
}

/// The watchdog's call that cannot be masked comes in the middle of a report that takes long: the fault stays the reason.
#[test]
fn a_report_that_takes_long_is_no_hang() -> anyhow::Result<()> {
    watched(SceneName::Butterfly, true, |board, elf, mut probe, _| {
        execute(&mut probe, UNDEFINED)?;
        probe.run_to(address(elf, "crash::say"))?;
        execute(&mut probe, HANG)?;
        let machine = probe.run()?;
        let restarted = machine.wait_for(ToHost::restarted)?;
        assert_eq!(restarted.cause, Some(Cause::Fault), "{}", board.name);
        let log = machine.said();
        assert!(!log.contains("HANG"), "{}: {log}", board.name);
        Ok(())
    })
}
