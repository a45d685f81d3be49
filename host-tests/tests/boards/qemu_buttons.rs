//! The board's buttons, pressed through QEMU, change the mass ratio and the start angle and restart the motion.

use crate::support::{application, settings, toolchain};
use firmware::app::controls::Key;
use firmware::config::{ANGLE_STEP, MASS_RATIOS};
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Machine, QemuError};

/// Frames until the firmware has noticed that a button is released, however late the host's word reaches it.
const SETTLING: usize = 60;
/// Frames for which a button is tapped: long enough to count and far from being held.
const TAP: usize = 6;
const ATTEMPTS: usize = 5;
/// Frames by which a press must have shown.
const PATIENCE: usize = 2000;

#[test]
fn buttons_choose_and_restart() -> Result<(), QemuError> {
    BOARDS.iter().filter(|board| board.has_panel).try_for_each(choose_and_restart)
}

fn choose_and_restart(board: &Board) -> Result<(), QemuError> {
    let (toolchain, elf) = (toolchain(), application(board));
    let mut machine = Machine::start(&settings(&toolchain, board, &elf))?;
    settle(&mut machine)?;
    machine.wake_keys()?;
    let start = settle(&mut machine)?;
    assert!(start.step > SETTLING as u32, "waking the buttons must not restart");

    let ratio = |offset: isize, before: &Frame| {
        let place = MASS_RATIOS.iter().position(|ratio| *ratio == before.mass_ratio);
        place.and_then(|place| MASS_RATIOS.get(place.checked_add_signed(offset)?)).copied()
    };
    let degrees = |frame: &Frame| frame.start_angle.to_degrees().round();

    let (before, after) = press(&mut machine, Key::Up)?;
    assert_eq!((Some(after.mass_ratio), after.start_angle), (ratio(1, &before), before.start_angle), "up");
    let (before, after) = press(&mut machine, Key::Down)?;
    assert_eq!((Some(after.mass_ratio), after.start_angle), (ratio(-1, &before), before.start_angle), "down");
    let (before, after) = press(&mut machine, Key::Right)?;
    assert_eq!((after.mass_ratio, degrees(&after)), (before.mass_ratio, degrees(&before) + ANGLE_STEP), "right");
    let (before, after) = press(&mut machine, Key::Left)?;
    assert_eq!((after.mass_ratio, degrees(&after)), (before.mass_ratio, degrees(&before) - ANGLE_STEP), "left");
    let (before, after) = tap(&mut machine, Key::Select)?;
    assert_eq!((after.mass_ratio, after.start_angle), (before.mass_ratio, before.start_angle), "select");
    machine.quit()
}

/// Holds a button until the motion restarts: the frames before and after that.
fn press(machine: &mut Machine, key: Key) -> Result<(Frame, Frame), QemuError> {
    let before = settle(machine)?;
    machine.set_key(key, true)?;
    let (before, after) = restart(machine, before)?.unwrap_or_else(|| panic!("{key:?} had no effect"));
    machine.set_key(key, false)?;
    assert_eq!(after.step, 1, "{key:?}: restarted and moved by one tick");
    let near = |angle: f32| (angle - after.start_angle).abs() < 0.01;
    assert!(near(after.state[0]) && near(after.state[1]), "{key:?}: both rods near the start angle");
    Ok((before, after))
}

/// Presses a button for a few frames, after which the motion restarts: the frames before and after that. Where the host
/// was so late to let go that the button counted as held, which changes the scene, it goes back and tries again.
fn tap(machine: &mut Machine, key: Key) -> Result<(Frame, Frame), QemuError> {
    for _ in 0..ATTEMPTS {
        machine.serial.send(&Choose { request: 0, scene: SceneName::Page.code() })?;
        settle(machine)?;
        machine.set_key(key, true)?;
        let mut before = next(machine)?;
        for _ in 0..TAP {
            before = next(machine)?;
        }
        machine.set_key(key, false)?;
        if let Some((before, after)) = restart(machine, before)?
            && [before, after].iter().all(|frame| frame.scene == SceneName::Page.code())
        {
            assert_eq!(after.step, 1, "{key:?}: restarted and moved by one tick");
            return Ok((before, after));
        }
    }
    panic!("{key:?} had no effect, or is never let go of in time");
}

/// Waits until the motion restarts, and the state with it: the frames before and after that.
fn restart(machine: &mut Machine, mut before: Frame) -> Result<Option<(Frame, Frame)>, QemuError> {
    for _ in 0..PATIENCE {
        let after = next(machine)?;
        if after.step < before.step {
            return Ok(Some((before, after)));
        }
        before = after;
    }
    Ok(None)
}

/// Lets go by what is under way; the last frame of it, since which nothing has restarted for a while.
fn settle(machine: &mut Machine) -> Result<Frame, QemuError> {
    let mut last = next(machine)?;
    let mut quiet = 0;
    while quiet < SETTLING {
        let frame = next(machine)?;
        quiet = if frame.step < last.step { 0 } else { quiet + 1 };
        last = frame;
    }
    Ok(last)
}

fn next(machine: &mut Machine) -> Result<Frame, QemuError> {
    machine.serial.next().ok_or_else(|| machine.silence())
}
