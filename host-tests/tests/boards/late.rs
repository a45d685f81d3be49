//! Boards that are late, or nearly late.

use boards::qemu::Machine;
use boards::{BOARDS, LM3S6965EVB, STM32F405};
use firmware::protocol::{Answer, Command, Field, ToHost};
use firmware::scenes::SceneName;

use crate::support::on;

/// The board is late for two seconds, and then lowers its speed.
const DROPPED: u32 = 60;
/// A board that catches up before it receives sends more.
const MOST_FRAMES: u32 = 4;

#[test]
fn a_late_board_answers() -> anyhow::Result<()> {
    let mut machine = on(&LM3S6965EVB, Machine::start)?;
    machine.send(1, Command::Choose(SceneName::Flips))?;
    assert_eq!(machine.next_answer()?, (1, Answer::Done));
    let fast = Command::Set {
        field: Field::Speed,
        value: 4.0,
    };
    machine.send(2, fast)?;
    machine.wait_for(|message| message.frame().filter(|frame| frame.dropped > DROPPED))?;

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

/// Planning gives way to both motions of the butterfly and to its second picture.
#[test]
fn two_fast_motions_leave_time_for_every_frame() -> anyhow::Result<()> {
    const FOLLOWED: u64 = 600;
    let [.., m0] = &BOARDS;
    for (board, mass_ratio, speed) in [(&STM32F405, 63.0, 2.0), (m0, 100.0, 1.0)] {
        let mut machine = on(board, Machine::start)?;
        machine.next_frame()?;
        let name = SceneName::Butterfly;
        let settings = name.first_settings().with_mass_ratio(mass_ratio);
        let speed = Command::Set {
            field: Field::Speed,
            value: speed,
        };
        for (request, command) in [(1, Command::Play(name, settings)), (2, speed)] {
            machine.send(request, command)?;
            assert_eq!(machine.next_answer()?, (request, Answer::Done));
        }

        let dropped = machine.next_frame()?.dropped;
        loop {
            let frame = machine.next_frame()?;
            let place = format!("{}, tick {}", board.name, frame.report.step);
            assert_eq!(frame.dropped, dropped, "{place}");
            if frame.report.step >= FOLLOWED {
                break;
            }
        }
    }
    Ok(())
}
