//! What is kept across a reset is trusted only if it is intact, and is played again as it was.

use fastrand::Rng;
use firmware::app::{Cause, Command, Journal, Kept, LastShown, MOST_RESTARTS, Player, SOUND_FRAMES, WarmRestart};
use firmware::motion::Settings;
use firmware::protocol::{Field, MAX_WIRE, Message, Restarted, Status, encode};
use firmware::scenes::SceneName;
use host_tests::emulator::host::Show;

fn kept<M: Message>(message: &M) -> Kept {
    let mut kept = [0; MAX_WIRE];
    encode(message, &mut kept);
    kept
}

fn recall(played: &Status, end: &Restarted, by_watchdog: bool) -> Option<WarmRestart> {
    WarmRestart::recall(&kept(played), &kept(end), by_watchdog)
}

fn player() -> Player<'static> {
    Show::new(SceneName::Page, &Settings::default()).expect("good").player
}

fn status() -> Status {
    let mut player = player();
    for command in [Command::Choose(SceneName::Butterfly), Command::Set { field: Field::MassRatio, value: 0.7 }] {
        player.execute(command).expect("possible");
    }
    player.status(0)
}

fn end() -> Restarted {
    let cause = Cause::Fault.code();
    Restarted { cause, restarts: 1, pc: 0x456, lr: 0x1234, cfsr: 1 << 16, scene: status().scene, step: 480 }
}

#[test]
fn it_is_recalled_as_it_was_kept() {
    let restart = recall(&status(), &end(), false).expect("intact");
    let expected = WarmRestart { played: Some(status()), end: Restarted { restarts: 2, ..end() }, cause: Cause::Fault };
    assert_eq!(restart, expected);
    assert_eq!(LastShown(Some(restart.end)).to_string(), "scene butterfly, step 480");
    assert_eq!(LastShown(None).to_string(), "no scene yet");
}

#[test]
fn what_memory_holds_when_it_is_switched_on_is_not_trusted() {
    let mut rng = Rng::with_seed(11);
    let mut noise = || std::array::from_fn(|_| rng.u8(..));
    for byte in [0x00, 0xff, 0xcc, 0x55] {
        assert_eq!(WarmRestart::recall(&[byte; MAX_WIRE], &[byte; MAX_WIRE], true), None);
    }
    for _ in 0..100_000 {
        let (played, end): (Kept, Kept) = (noise(), noise());
        assert_eq!(WarmRestart::recall(&played, &end, true), None);
    }
    // Each in the other's place is not what it should be, either.
    assert_eq!(WarmRestart::recall(&kept(&end()), &kept(&status()), true), None);
}

#[test]
fn a_reset_from_outside_starts_anew_and_one_by_the_watchdog_does_not() {
    for no_cause in [0, 77] {
        let running = Restarted { cause: no_cause, ..end() };
        assert_eq!(recall(&status(), &running, false), None);
        let hung = recall(&status(), &running, true).expect("intact");
        assert_eq!((hung.cause, hung.end.cause), (Cause::Hang, Cause::Hang.code()));
    }
}

#[test]
fn what_ends_the_board_each_time_is_given_up() {
    for restarts in [0, 1, MOST_RESTARTS - 1, MOST_RESTARTS, u8::MAX] {
        let restart = recall(&status(), &Restarted { restarts, ..end() }, false).expect("intact");
        assert_eq!(restart.end.restarts, restarts.saturating_add(1));
        assert_eq!(restart.played.is_some(), restarts < MOST_RESTARTS, "after {restarts}");
    }
}

#[test]
fn a_minute_without_a_restart_forgets_those_before() {
    let (mut player, restart) = (player(), recall(&status(), &end(), false).expect("intact"));
    let mut journal = Journal::new(Some(&restart));
    for frame in 1..=SOUND_FRAMES + 10 {
        let (played, end) = journal.note(&player);
        let restarts = if frame < SOUND_FRAMES { 2 } else { 0 };
        assert_eq!((end.cause, end.restarts, end.scene), (0, restarts, SceneName::Page.code()), "frame {frame}");
        assert_eq!(played, (frame == 1).then(|| player.status(0)), "frame {frame}");
    }
    player.execute(Command::TurnLeft).expect("possible");
    assert_eq!(journal.note(&player).0, Some(player.status(0)));
}

#[test]
fn every_scene_is_resumed_with_its_settings() {
    for &name in SceneName::ALL {
        let (mut player, mut resumed) = (player(), player());
        let speed = |value| Command::Set { field: Field::Speed, value };
        for value in [0.01, 0.7, 4.0] {
            for command in [Command::Choose(name), Command::TurnLeft, speed(value), Command::Step(7)] {
                player.execute(command).expect("possible");
            }
            let status = player.status(0);
            resumed.resume(&status).expect("it was possible before");
            assert_eq!(resumed.status(0), status, "{}", name.name());
        }
    }
}

#[test]
fn what_cannot_be_played_changes_nothing() {
    let mut player = player();
    let before = player.status(0);
    let good = status();
    for impossible in
        [Status { scene: 200, ..good }, Status { parameters: [-1.0; 5], ..good }, Status { speed: f32::NAN, ..good }]
    {
        assert!(player.resume(&impossible).is_err());
        assert_eq!(player.status(0), before);
    }
}

#[test]
fn any_flipped_bit_is_noticed() {
    let (played, end) = (kept(&status()), kept(&end()));
    for bit in 0..8 * MAX_WIRE {
        let is_kept = |kept: &Kept| kept[(bit / 8).saturating_sub(1)..].iter().any(|byte| *byte > 0);
        let flipped = |mut kept: Kept| {
            kept[bit / 8] ^= 1 << (bit % 8);
            kept
        };
        assert!(!is_kept(&played) || WarmRestart::recall(&flipped(played), &end, true).is_none(), "played, bit {bit}");
        assert!(!is_kept(&end) || WarmRestart::recall(&played, &flipped(end), true).is_none(), "end, bit {bit}");
    }
}
