//! Taps on the keyboard, on their way to the board's buttons one after another: none is lost, however quick they are.

use std::collections::VecDeque;

use crate::emulator::qemu::Key;

/// How long a button is held down for a tap, and let go after it, ticks: the firmware believes what it reads twice in a
/// row, and takes 24 for being held. What is in between allows for a host that is late.
const TICKS: u32 = 4;
/// More taps than this do not wait: 5 s of them, from a key of the keyboard that repeats while it is held.
const MOST: usize = 32;

/// Taps that wait, and the button that is down.
#[derive(Clone, Debug, Default)]
pub struct Taps {
    waiting: VecDeque<Key>,
    down: Option<Key>,
    /// The tick of the last change, known at the first look after it: a host that was held up just before the change
    /// would else take the time of that for time that the button was down.
    since: Option<u32>,
}

impl Taps {
    /// Takes a tap.
    pub fn add(&mut self, key: Key) {
        if self.waiting.len() < MOST {
            self.waiting.push_back(key);
        }
    }

    /// The button that changes at tick `now` of the board's clock, and whether it is pressed.
    pub fn change(&mut self, now: u32) -> Option<(Key, bool)> {
        if now.wrapping_sub(*self.since.get_or_insert(now)) < TICKS {
            return None;
        }
        let change = match self.down.take() {
            Some(key) => (key, false),
            None => {
                self.down = self.waiting.pop_front();
                (self.down?, true)
            }
        };
        self.since = None;
        Some(change)
    }

    /// Whether no tap waits and no button is down.
    pub fn are_done(&self) -> bool {
        self.waiting.is_empty() && self.down.is_none()
    }
}

#[cfg(test)]
mod tests {
    use firmware::app::command::Command;
    use firmware::app::controls::{Controls, Pressed};

    use super::*;

    /// What the firmware's buttons ask for while `taps`, added at the ticks given, reach it; the host looks every
    /// `period` ticks.
    fn commands(taps: impl IntoIterator<Item = (u32, Key)>, period: u32) -> Vec<Command> {
        let (mut queue, mut controls, mut pressed) = (Taps::default(), Controls::default(), Pressed::default());
        let mut taps = taps.into_iter().peekable();
        let mut commands = Vec::new();
        for now in 0..2000 {
            while let Some((_, key)) = taps.next_if(|(tick, _)| *tick <= now) {
                queue.add(key);
            }
            if now % period == 0
                && let Some((key, down)) = queue.change(now)
            {
                let button = match key {
                    Key::Up => &mut pressed.up,
                    Key::Down => &mut pressed.down,
                    Key::Left => &mut pressed.left,
                    Key::Right => &mut pressed.right,
                    Key::Select => &mut pressed.select,
                };
                *button = down;
            }
            commands.extend(controls.tick(pressed));
        }
        assert!(queue.are_done());
        commands
    }

    #[test]
    fn every_tap_is_one_step_however_quick_and_however_slow_the_host() {
        for period in [1, 2, 3, 5, 11] {
            let at_100_ms = (0..10).map(|number| (6 * number, Key::Right));
            assert_eq!(commands(at_100_ms, period), [Command::TurnRight; 10], "every {period} ticks");
            let at_once = [(7, Key::Down); 25];
            assert_eq!(commands(at_once, period), [Command::Lighter; 25], "every {period} ticks");
        }
    }

    #[test]
    fn taps_of_several_keys_keep_their_order_and_are_never_a_chord() {
        let mixed = [Key::Up, Key::Select, Key::Right, Key::Select, Key::Left].map(|key| (0, key));
        use Command::{Heavier, Restart, TurnLeft, TurnRight};
        assert_eq!(commands(mixed, 2), [Heavier, Restart, TurnRight, Restart, TurnLeft]);
    }

    #[test]
    fn a_key_that_repeats_for_long_does_not_run_on_for_ever() {
        assert_eq!(commands([(0, Key::Up); 1000], 1).len(), MOST);
    }
}
