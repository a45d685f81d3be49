//! The board's buttons, pressed through QEMU, change the mass ratio and the start angle and restart
//! the motion.

use crate::support::on;
use boards::qemu::Machine;
use boards::{BOARDS, Board};
use firmware::app::Key;
use firmware::config::{ANGLE_STEP, MASS_RATIOS};
use firmware::protocol::Frame;
use firmware::scenes::SceneName;

/// Enough frames for the firmware to notice a released button, even if the host is slow.
const SETTLING: usize = 60;
const PATIENCE: usize = 2000;

#[test]
fn buttons_choose_and_restart() -> anyhow::Result<()> {
    BOARDS
        .iter()
        .filter(|board| board.has_panel)
        .try_for_each(choose_and_restart)
}

fn choose_and_restart(board: &Board) -> anyhow::Result<()> {
    let mut machine = on(board, Machine::start)?;
    // The emulated buttons work only after they were pressed once.
    settle(&mut machine)?;
    machine.wake_keys()?;
    let start = settle(&mut machine)?;
    assert!(
        start.report.step > SETTLING as u64,
        "waking the buttons must not restart"
    );
    let place = |frame: &Frame| {
        MASS_RATIOS
            .iter()
            .position(|ratio| *ratio as f32 == frame.mass_ratio)
            .expect("one of them")
    };
    let degrees = |frame: &Frame| f64::from(frame.start_angle).to_degrees().round();

    for (key, ratios, turn) in [
        (Key::Up, 1, 0.0),
        (Key::Down, -1, 0.0),
        (Key::Right, 0, ANGLE_STEP),
        (Key::Left, 0, -ANGLE_STEP),
    ] {
        let (before, after) = press(&mut machine, key)?;
        let expected = (
            place(&before).checked_add_signed(ratios),
            degrees(&before) + turn,
        );
        assert_eq!(
            (Some(place(&after)), degrees(&after)),
            expected,
            "{}: {key:?}",
            board.name
        );
        let near = |angle: f32| (angle - after.start_angle).abs() < 0.01;
        assert!(
            near(after.report.state.a1) && near(after.report.state.a2),
            "{key:?}: both rods near the start angle"
        );
    }

    let (_, after) = press(&mut machine, Key::Select)?;
    assert_eq!(after.scene, SceneName::Page.next(), "{}", board.name);
    Ok(())
}

/// Holds a button until a motion starts. Returns the frames before and after the start.
fn press(machine: &mut Machine, key: Key) -> anyhow::Result<(Frame, Frame)> {
    let mut before = settle(machine)?;
    machine.set_key(key, true)?;
    for _ in 0..PATIENCE {
        let after = machine.next_frame()?;
        if after.report.step < before.report.step {
            machine.set_key(key, false)?;
            assert_eq!(
                after.report.step, 1,
                "{key:?}: restarted and moved by one tick"
            );
            return Ok((before, after));
        }
        before = after;
    }
    panic!("{key:?} had no effect")
}

/// Waits until nothing has restarted for a while.
fn settle(machine: &mut Machine) -> anyhow::Result<Frame> {
    let mut last = machine.next_frame()?;
    let mut quiet = 0;
    while quiet < SETTLING {
        let frame = machine.next_frame()?;
        quiet = if frame.report.step < last.report.step {
            0
        } else {
            quiet + 1
        };
        last = frame;
    }
    Ok(last)
}
