//! The largest mass ratio that the keys reach, on the emulated board that is slowest with it. The
//! command of the key up is sent until nothing changes any more.

use boards::LM3S6965EVB;
use boards::host::Show;
use boards::qemu::Machine;
use firmware::config::{MASS_RATIOS, TICK_RATE};
use firmware::motion::Settings;
use firmware::protocol::{Answer, Command, PlayState};
use firmware::scenes::SceneName;

use crate::support::on;

/// The duration, ticks. With steps that do not resolve the motion, it diverged after 2.6 s, and
/// `figure-7` after 1 s.
const FOLLOWED: u64 = 4 * TICK_RATE as u64;

/// Relative. An error of 1 % becomes visible after some seconds.
const ENERGY: f32 = 1e-3;

#[test]
fn up_held_down_shows_the_hosts_motion_at_mass_ratio_100() -> anyhow::Result<()> {
    let board = &LM3S6965EVB;
    let mut machine = on(board, Machine::start)?;
    machine.next_frame()?;

    for name in [SceneName::Page, SceneName::Figure7] {
        let heavier = |settings: Settings, _| settings.heavier();
        let settings = MASS_RATIOS.iter().fold(name.first_settings(), heavier);
        assert_eq!(settings.mass_ratio(), 100.0);

        // The host plans first, because the board drops frames while the host does not read.
        let mut show = Show::on(board.processor(), name, &settings)?;

        machine.send(1, Command::Choose(name))?;
        assert_eq!(machine.next_answer()?, (1, Answer::Done));
        for _ in MASS_RATIOS {
            machine.send(1, Command::Heavier)?;
            assert_eq!(machine.next_answer()?, (1, Answer::Done));
        }
        loop {
            let frame = machine.next_frame()?;
            let place = format!("{}, step {}", name.name(), frame.report.step);
            assert_eq!(frame, show.expected(&frame), "{place}");
            assert_eq!(
                (frame.state, frame.dropped),
                (PlayState::Playing, 0),
                "{place}"
            );
            assert!(
                frame.report.energy_error.abs() <= ENERGY,
                "{place}: {:e}",
                frame.report.energy_error
            );
            if frame.report.step >= FOLLOWED {
                break;
            }
        }
    }

    let bad: Vec<_> = machine
        .lines()
        .into_iter()
        .filter(|line| line.is_bad())
        .collect();
    assert!(bad.is_empty(), "{bad:#?}");
    Ok(())
}
