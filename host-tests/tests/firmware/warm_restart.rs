//! The record that is kept across a reset is trusted only if it is intact, and is played again
//! unchanged.

use boards::host::Show;
use fastrand::Rng;
use firmware::app::{Journal, MOST_RESTARTS, Player, Record, SOUND_FRAMES};
use firmware::display::{BUILT_FOR, Controller};
use firmware::motion::Settings;
use firmware::protocol::{Cause, Command, Field, MAX_WIRE, Restarted, Status, encode};
use firmware::scenes::SceneName;

fn player() -> Player<'static> {
    Show::new(SceneName::Page, &Settings::default())
        .expect("good")
        .player
}

fn status() -> Status {
    let mut player = player();
    for command in [
        Command::Choose(SceneName::Butterfly),
        Command::Set {
            field: Field::MassRatio,
            value: 0.7,
        },
    ] {
        player.execute(command).expect("possible");
    }
    player.status()
}

fn record() -> Record {
    let played = status();
    let cause = Some(Cause::Fault);
    let end = Restarted {
        cause,
        restarts: 1,
        pc: 0x456,
        lr: 0x1234,
        cfsr: 1 << 16,
        scene: played.scene,
        step: 480,
    };
    Record { played, end }
}

fn ended(end: Restarted) -> Record {
    Record { end, ..record() }
}

#[test]
fn a_record_is_read_as_it_was_written() {
    let kept = Record::read(&record().write()).expect("intact");
    assert_eq!(kept, record());
    assert_eq!(
        kept.restart(false),
        Some(ended(Restarted {
            restarts: 2,
            ..kept.end
        }))
    );
    assert_eq!(kept.end.to_string(), "scene butterfly, step 480");
}

#[test]
fn a_record_for_another_panel_is_not_trusted() {
    let is_read = |bytes: &[u8]| {
        let mut kept = [0; MAX_WIRE];
        kept[..bytes.len()].copy_from_slice(bytes);
        Record::read(&kept).is_some()
    };
    assert!(is_read(encode(&(record(), BUILT_FOR), &mut [0; MAX_WIRE])));
    assert!(!is_read(encode(&record(), &mut [0; MAX_WIRE])));
    for other in Controller::ALL
        .iter()
        .copied()
        .map(Some)
        .filter(|other| *other != BUILT_FOR)
    {
        assert!(!is_read(encode(&(record(), other), &mut [0; MAX_WIRE])));
    }
}

#[test]
fn memory_after_power_on_is_not_trusted() {
    let mut rng = Rng::with_seed(11);
    for byte in [0x00, 0xff, 0xcc, 0x55] {
        assert_eq!(Record::read(&[byte; MAX_WIRE]), None);
    }
    for _ in 0..100_000 {
        assert_eq!(Record::read(&std::array::from_fn(|_| rng.u8(..))), None);
    }
}

#[test]
fn any_flipped_bit_is_noticed() {
    let kept = record().write();
    let end = kept.iter().rposition(|byte| *byte > 0).expect("a message");
    for bit in 0..8 * (end + 2) {
        let mut flipped = kept;
        flipped[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(Record::read(&flipped), None, "bit {bit}");
    }
}

#[test]
fn only_a_reset_by_the_watchdog_resumes_the_scene() {
    let running = ended(Restarted {
        cause: None,
        ..record().end
    });
    assert_eq!(running.restart(false), None);
    assert_eq!(
        running.restart(true).map(|hung| hung.end.cause),
        Some(Some(Cause::Hang))
    );
}

#[test]
fn a_scene_that_ends_the_board_each_time_is_given_up() {
    for restarts in [0, 1, MOST_RESTARTS - 1, MOST_RESTARTS, u8::MAX] {
        let restart = ended(Restarted {
            restarts,
            ..record().end
        })
        .restart(false)
        .expect("a fault");
        assert_eq!(restart.end.restarts, restarts.saturating_add(1));
        assert_eq!(
            restart.is_given_up(),
            restarts >= MOST_RESTARTS,
            "after {restarts}"
        );
    }
}

#[test]
fn a_minute_without_a_restart_clears_the_count() {
    assert_eq!(SOUND_FRAMES, 3600);
    let played = status();
    let restart = record().restart(false);
    let mut journal = Journal::new(restart.as_ref());
    for frame in 1..=SOUND_FRAMES + 10 {
        let restarts = if frame < SOUND_FRAMES { 2 } else { 0 };
        let step = 480 + u64::from(frame);
        let end = Restarted {
            restarts,
            scene: SceneName::Butterfly,
            step,
            ..Restarted::default()
        };
        assert_eq!(
            journal.note(played, step),
            Record { played, end },
            "frame {frame}"
        );
    }
}

#[test]
fn every_scene_is_resumed_with_its_settings() {
    for &name in SceneName::ALL {
        let mut player = self::player();
        let mut resumed = self::player();
        let speed = |value| Command::Set {
            field: Field::Speed,
            value,
        };
        for value in [0.01, 0.7, 4.0] {
            for command in [
                Command::Choose(name),
                Command::TurnLeft,
                speed(value),
                Command::Step(7),
            ] {
                player.execute(command).expect("possible");
            }
            let status = player.status();
            resumed.resume(&status).expect("it was possible before");
            assert_eq!(resumed.status(), status, "{}", name.name());
        }
    }
}
