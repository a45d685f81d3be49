//! What a board streams is what the host's kernel computes, bit for bit.

use crate::support::on;
use firmware::protocol::Frame;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Lockstep, Machine, QemuError};
use host_tests::link::Counts;
use host_tests::oracle::stream::Expected;

/// 12 s of the board's time: the motion has turned over and become chaotic long before.
const FRAMES: u32 = 720;

#[test]
fn every_board_streams_the_kernels_bits() -> Result<(), QemuError> {
    BOARDS.iter().try_for_each(streams_the_kernels_bits)
}

fn streams_the_kernels_bits(board: &Board) -> Result<(), QemuError> {
    let mut machine = on(board, Machine::start)?;
    let mut expected: Option<Expected> = None;
    for sequence in 0..FRAMES {
        let frame: Frame = machine.wait_for()?;
        let expected = expected.get_or_insert_with(|| Expected::new(frame.mass_ratio, frame.start_angle));
        expected.tick();
        assert_eq!(
            frame.state.map(f32::to_bits),
            expected.state().map(f32::to_bits),
            "{}, frame {sequence}",
            board.name
        );
        assert_eq!((frame.sequence, frame.dropped, frame.step), (sequence, 0, sequence + 1), "{}", board.name);
    }
    let Counts { damaged, lost, .. } = machine.serial.counts();
    assert_eq!((damaged, lost), (0, 0), "{}", board.name);
    machine.quit()
}

#[test]
fn standing_still_between_frames_changes_nothing() -> Result<(), QemuError> {
    const FRAMES: usize = 120;
    let mut stopped = on(&BOARDS[0], Lockstep::start)?;
    let mut running = on(&BOARDS[0], Machine::start)?;
    for _ in 0..FRAMES {
        let frame = stopped.next_frame()?;
        stopped.screenshot()?;
        assert_eq!(frame, running.wait_for()?);
    }
    Ok(())
}
