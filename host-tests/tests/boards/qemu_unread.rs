//! The host stops reading: the board's motion does not wait for it, and the stream goes on as soon as it reads again.

use std::thread::sleep;
use std::time::Duration;

use crate::support::on;
use firmware::motion::Settings;
use firmware::protocol::Frame;
use firmware::scenes::SceneName;
use host_tests::emulator::boards::BOARDS;
use host_tests::emulator::host::Show;
use host_tests::emulator::qemu::Machine;

/// How often the log is looked at.
const POLL: Duration = Duration::from_millis(20);
/// Frames read after the gap.
const FRAMES: usize = 120;

/// On the one board whose emulated port says that it is full; the others' stand still with the whole machine.
#[test]
fn a_host_that_stops_reading_loses_frames_and_nothing_else() -> anyhow::Result<()> {
    let board = BOARDS.iter().find(|board| board.name == "mps2-an386").expect("it is a board");
    let mut machine = on(board, Machine::start)?;
    let first: Frame = machine.wait_for()?;

    let stopped = machine.serial.stop_reading();
    let mut said = Vec::new();
    while !said.iter().any(|line: &String| line.contains("serial link")) {
        said.extend(machine.log.arrived().map(|line| line.to_string()));
        sleep(POLL);
    }
    drop(stopped);

    let mut show =
        Show::on(board.processor(), SceneName::Page, &Settings::default()).expect("a scene of the catalogue");
    let (mut last, mut after) = (first, 0);
    while after < FRAMES {
        let frame: Frame = machine.wait_for()?;
        assert_eq!(frame, show.expected(&frame));
        // No tick is left out, even if its frame is.
        assert_eq!(frame.step, frame.sequence + 1 + frame.dropped);
        after += usize::from(after > 0 || frame.sequence > last.sequence + 1);
        last = frame;
    }
    let counts = machine.serial.counts();
    assert!(counts.lost > 0, "{counts:?}");
    assert!(counts.damaged <= 1, "the frame that was cut short, no other: {counts:?}");
    said.extend(machine.log.arrived().map(|line| line.to_string()));
    let complaints = said.iter().filter(|line| line.contains("serial link")).count();
    assert_eq!(complaints, 1, "said once, not for every frame: {said:#?}");
    machine.quit()
}
