//! A board that is late by ever more frames.

use emulator::boards::LM3S6965EVB;
use emulator::qemu::Machine;
use firmware::protocol::{Answer, Command, Field, ToHost};
use firmware::scenes::SceneName;

use crate::support::on;

/// The number of ticks without a frame after which the command is sent. It is reached before the map
/// is finished; 1,500 is not.
const DROPPED: u32 = 1_000;
/// The largest number of frames before the answer. A board that catches up before it receives
/// sends more.
const MOST_FRAMES: u32 = 4;

/// A board that needs twice the time of a frame for the scene, the map of flips at fourfold speed,
/// answers a command within [`MOST_FRAMES`] frames.
#[test]
fn a_board_that_is_always_late_answers() -> anyhow::Result<()> {
    let mut machine = on(&LM3S6965EVB, Machine::start)?;
    machine.send(1, Command::Choose(SceneName::Flips))?;
    assert_eq!(machine.next_answer()?, (1, Answer::Done));
    let fast = Command::Set {
        field: Field::Speed,
        value: 4.0,
    };
    machine.send(2, fast)?;
    machine.wait_for(|message| message.frame().filter(|frame| frame.dropped > DROPPED))?;

    // The board is stopped while the command is sent, so that no frame comes in between.
    machine.stop()?;
    machine.messages()?;
    machine.send(3, Command::Ask)?;
    machine.run()?;
    let mut frames = 0;
    loop {
        match machine.receive()? {
            ToHost::Frame(_) => frames += 1,
            ToHost::Answer(3, answer) => {
                assert!(matches!(answer, Answer::Status(_)), "{answer:?}");
                break;
            }
            _ => {}
        }
    }
    assert!(frames <= MOST_FRAMES, "{frames} frames before the answer");
    Ok(())
}
