//! One button, debounced, and repeated while held.

use crate::config::{DEBOUNCE_TICKS, REPEAT_DELAY_TICKS, REPEAT_PERIOD_TICKS};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    Pressed,
    /// Held long enough to count as pressed again.
    Repeated,
    Released,
}

#[derive(Clone, Debug, Default)]
pub struct Button {
    phase: Phase,
    /// Readings in a row that contradict the phase.
    contradictions: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// Not yet seen released: a line that reads pressed from the first may be stuck or not driven, so it is ignored.
    #[default]
    Unproven,
    Released,
    /// Held, with this many ticks left until it counts as pressed again.
    Held {
        repeats_in: u8,
    },
}

impl Button {
    pub fn is_held(&self) -> bool {
        matches!(self.phase, Phase::Held { .. })
    }

    pub fn tick(&mut self, pressed: bool) -> Option<Change> {
        let contradicts = if self.phase == Phase::Unproven { !pressed } else { pressed != self.is_held() };
        self.contradictions = if contradicts { self.contradictions.saturating_add(1) } else { 0 };
        if self.contradictions >= DEBOUNCE_TICKS {
            self.contradictions = 0;
            let proven = self.phase != Phase::Unproven;
            self.phase = if pressed { Phase::Held { repeats_in: REPEAT_DELAY_TICKS } } else { Phase::Released };
            return proven.then_some(if pressed { Change::Pressed } else { Change::Released });
        }
        let Phase::Held { repeats_in } = &mut self.phase else { return None };
        *repeats_in = repeats_in.saturating_sub(1);
        (*repeats_in == 0).then(|| {
            *repeats_in = REPEAT_PERIOD_TICKS;
            Change::Repeated
        })
    }
}
