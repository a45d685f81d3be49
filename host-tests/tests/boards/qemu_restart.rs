//! Things that go wrong in the running application: what is said of them, and how the board comes back.
//!
//! They are injected into the images that are flashed, from outside: a debugger stops the board in the middle of a frame
//! that is drawn but not yet sent, and sends its processor elsewhere.

use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use crate::support::{address, application, guarded, on};
use firmware::app::{Cause, MOST_RESTARTS};
use firmware::protocol::{Choose, Field, Frame, Restarted, Set};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board, STM32F405};
use host_tests::emulator::qemu::{Clock, Lockstep, Machine, Register, Settings};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

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
    serial.send(&Choose { request: 1, scene: scene.code() })?;
    serial.send(&Set { request: 2, field: Field::MassRatio.code(), value: MASS_RATIO.into() })?;
    // To stop rarely is quicker: a board that stands still takes no bytes.
    let execute = address(elf, "Player::execute");
    probe.run_to(execute)?;
    probe.run_to(execute)?;
    let mut seen = 0;
    loop {
        probe.run_to(stopwatch)?;
        let frame = probe.machine().serial.arrived::<Frame>().last();
        let Some(frame) = frame.filter(|frame| frame.scene == scene.code() && frame.mass_ratio == MASS_RATIO) else {
            continue;
        };
        seen += 1;
        if seen == FRAMES {
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

/// Spoils these boards in the middle of a frame of `scene`; they end as a failure, and their last words must hold all `parts`, and
/// where it was.
fn boards_say(
    boards: impl Iterator<Item = &'static Board>,
    scene: SceneName,
    parts: &[&str],
    spoil: impl Fn(&mut Lockstep, &Path) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    for board in boards {
        let elf = application(board);
        let mut probe = on(board, Lockstep::start)?;
        let frame = within(&mut probe, &elf, scene)?;
        spoil(&mut probe, &elf)?;
        let (status, lines) = probe.run()?.wait()?;
        let report = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
        assert_eq!(status.code(), Some(1), "{report}");
        let place = format!("scene {}, step {}\n", scene.name(), frame.step);
        for part in parts.iter().chain([&&*place]) {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
    }
    Ok(())
}

#[test]
fn a_fault_in_a_picture_tells_the_scene_and_the_step() -> anyhow::Result<()> {
    let registers = format!("pc {UNUSED:#010x}  lr 0x12345679");
    let spoil = |probe: &mut Lockstep, _: &Path| {
        execute(probe, UNDEFINED)?;
        probe.divert(&[(Register::Lr, 0x1234_5679)])
    };
    let parts = ["HARDFAULT: undefined instruction", &registers, "cfsr 0x00010000"];
    boards_say(guarded(), SceneName::Figure7, &parts, spoil)?;
    let parts = ["HARDFAULT: unknown cause (a Cortex-M0+ tells none)", &registers];
    boards_say(BOARDS.iter().filter(|board| !board.is_guarded()), SceneName::Figure7, &parts, spoil)
}

#[test]
fn a_stack_that_overflows_in_a_picture_meets_the_guard_and_changes_nothing_below() -> anyhow::Result<()> {
    let parts =
        ["HARDFAULT: stack overflow", "pc and lr are lost; the last call on the stack is at 0x", "cfsr 0x000000"];
    boards_say(guarded(), SceneName::Butterfly, &parts, |probe, elf| {
        let statics = address(elf, "_ram_start")..address(elf, "__euninit");
        let before = probe.read(statics.clone())?;
        assert!(before.len() > 1024, "there is something to damage");
        probe.divert(&[(Register::Sp, UNUSED), (Register::Pc, address(elf, "Player::execute"))])?;
        probe.run_to(address(elf, "HardFault"))?;
        assert!(probe.read(statics)? == before, "the statics are damaged");
        Ok(())
    })
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
        let Restarted { cause, restarts, pc, scene, step, .. } = machine.wait_for()?;
        assert_eq!((Cause::from_code(cause), restarts, pc), (Some(Cause::Hang), 1, UNUSED), "{}", board.name);
        assert_eq!((scene, step), (SceneName::Butterfly.code(), before.step), "{}", board.name);
        for sequence in 0..FRAMES as u32 {
            let frame: Frame = machine.wait_for()?;
            assert_eq!((frame.sequence, frame.step), (sequence, sequence + 1), "{}", board.name);
            assert_eq!((frame.scene, frame.mass_ratio), (before.scene, MASS_RATIO), "{}", board.name);
        }
        assert_eq!((machine.serial.counts().damaged, machine.serial.counts().lost), (0, 0), "{}", board.name);
        let log = machine.said();
        for part in [
            "HANG: no frame finished for 1 s\n",
            &format!("pc {UNUSED:#010x}"),
            &format!("scene butterfly, step {}\n", before.step),
            "restarted after a hang, 1 in a row: pc 0x20008000",
        ] {
            assert!(log.contains(part), "{}: no {part:?} in\n{log}", board.name);
        }
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
                    restarted = restarted.or(message.read::<Restarted>());
                    frame = frame.or(message.read::<Frame>());
                }
            }
            let restarted = restarted.expect("said before the first frame");
            let cfsr = if board.is_guarded() { 1 << 16 } else { 0 };
            assert_eq!(Cause::from_code(restarted.cause), Some(Cause::Fault), "{}", board.name);
            assert_eq!((restarted.restarts, restarted.pc, restarted.cfsr), (restarts, UNUSED, cfsr), "{}", board.name);
            assert_eq!(restarted.scene, before.scene, "{}", board.name);
            // What ends the board each time is given up.
            let scene = if restarts <= MOST_RESTARTS { SceneName::Figure7 } else { SceneName::Page };
            assert_eq!(frame.map(|frame| frame.scene), Some(scene.code()), "{}: restart {restarts}", board.name);
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
        let restarted: Restarted = machine.wait_for()?;
        assert_eq!(Cause::from_code(restarted.cause), Some(Cause::Fault), "{}", board.name);
        let log = machine.said();
        assert!(!log.contains("HANG"), "{}: {log}", board.name);
        Ok(())
    })
}

/// A host that stops QEMU, or has no time for it, is no fault of the firmware: its clock has not ticked meanwhile.
#[test]
fn a_board_whose_emulator_pauses_does_not_take_it_for_a_hang() -> anyhow::Result<()> {
    /// Longer than the watchdog's two stages.
    const PAUSE: Duration = Duration::from_millis(2500);
    for board in BOARDS.iter().filter(|board| **board != STM32F405) {
        let mut machine = on(board, |settings| Machine::start(&Settings { clock: Clock::Real, ..*settings }))?;
        let emulator = Pid::from_raw(machine.id().cast_signed());
        for pause in [true, false] {
            for _ in 0..FRAMES {
                machine.wait_for::<Frame>()?;
            }
            if pause {
                kill(emulator, Signal::SIGSTOP)?;
                sleep(PAUSE);
                kill(emulator, Signal::SIGCONT)?;
            }
        }
        let log = machine.said();
        assert!(!log.contains("HANG") && !log.contains("restarted"), "{}: {log}", board.name);
        machine.quit()?;
    }
    Ok(())
}

/// A host that sends faster than the board reads is told how much it has lost.
#[test]
fn received_bytes_that_are_lost_are_counted() -> anyhow::Result<()> {
    // Broken messages of a byte each, of which a board takes no more than four a tick: many times what its queue holds.
    let flood = [0, 1].repeat(10_000);
    for board in &BOARDS {
        let mut machine = on(board, Machine::start)?;
        assert_eq!(machine.wait_for::<Frame>()?.lost, 0, "{}", board.name);
        machine.serial.send_bytes(&flood)?;
        // The log comes by another way than the frames, and may be later.
        let (mut lost, mut log) = (0, String::new());
        while lost == 0 || !log.contains("received bytes lost") {
            lost = machine.wait_for::<Frame>()?.lost;
            log += &machine.said();
        }
        assert!(lost < flood.len() as u32, "{}: {lost}", board.name);
        machine.quit()?;
    }
    Ok(())
}
