//! The pace of a scene: at full speed, slower, faster, or step by step.

use crate::config::{GREATEST_SPEED, MOST_TICKS_PER_FRAME, TICK_RATE};
use crate::protocol::Field;

/// The number of parts of a tick. One part per tick is the smallest speed.
const WHOLE_TICK: u32 = 100;
/// The number of ticks without a frame that make a second of the clock late.
const LATE: u32 = 4;

/// The pace of a scene. The default is full speed, not paused.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// True if the scene advances only by `steps`.
    pub paused: bool,
    /// The number of ticks of the scene left to advance while paused, one in each tick of the
    /// clock. Otherwise it has no effect and stays; it acts again at the next pause unless it is
    /// set to 0.
    pub steps: u32,
    /// The number of ticks of the scene in [`WHOLE_TICK`] ticks of the clock, 100.
    speed: u32,
    /// The parts of the scene's next tick that have passed.
    part: u32,
    /// The ticks of the present second of the clock, and those of them without a frame.
    ticks: u32,
    dropped: u32,
    /// True if the second before was late.
    was_late: bool,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            paused: false,
            steps: 0,
            speed: WHOLE_TICK,
            part: 0,
            ticks: 0,
            dropped: 0,
            was_late: false,
        }
    }
}

impl Pace {
    /// Returns the speed, simulated time per real time, also while paused; 1 is full speed.
    pub fn speed(&self) -> f32 {
        self.speed as f32 / WHOLE_TICK as f32
    }

    /// Returns the number of ticks of the scene that are due in this tick of the clock, and counts
    /// them as done. Not paused, it is 0 to [`GREATEST_SPEED`]. Paused, it is 1 while `steps` are
    /// left, and then 0. To be called once in each tick of the clock.
    pub fn tick(&mut self) -> u32 {
        if self.paused {
            let due = self.steps.min(1);
            self.steps -= due;
            return due;
        }

        self.part += self.speed;
        let ticks = self.part / WHOLE_TICK;
        self.part %= WHOLE_TICK;
        ticks
    }

    /// Returns the largest number of ticks of the clock that a frame may complete, so that the scene
    /// advances by [`MOST_TICKS_PER_FRAME`] at most.
    pub fn most_ticks(&self) -> u32 {
        MOST_TICKS_PER_FRAME / self.speed.div_ceil(WHOLE_TICK).max(1)
    }

    /// Notes a frame that completes this number of ticks of the clock.
    pub fn note_frame(&mut self, ticks: u32) {
        self.ticks = self.ticks.saturating_add(ticks);
        self.dropped = self.dropped.saturating_add(ticks - 1);
    }

    /// Halves a speed above full speed, to full speed at least, after two late seconds in a row, and
    /// returns the new one. After one, the board may only have to catch up, with the start of a
    /// scene or with what a higher speed has left.
    pub fn lower(&mut self) -> Option<f32> {
        if self.ticks < TICK_RATE {
            return None;
        }

        let is_late = self.dropped >= LATE;
        let is_too_fast = is_late && self.was_late && self.speed > WHOLE_TICK && !self.paused;
        self.ticks = 0;
        self.dropped = 0;
        self.was_late = is_late && !is_too_fast;
        is_too_fast.then(|| {
            self.speed = (self.speed / 2).max(WHOLE_TICK);
            self.speed()
        })
    }

    /// Pauses, with this number of ticks left to advance, or continues.
    pub fn pause(&mut self, paused: bool, steps: u32) {
        self.paused = paused;
        self.steps = steps;
    }

    /// Sets the speed, simulated time per real time, rounded to the nearest hundredth, a half
    /// upwards. A pause stays.
    ///
    /// Returns [`Field::Speed`], and keeps the old speed, if the rounded one is below 0.01 or above
    /// [`GREATEST_SPEED`], 4, or is NaN.
    pub fn set_speed(&mut self, speed: f64) -> Result<(), Field> {
        let parts = (speed * f64::from(WHOLE_TICK) + 0.5) as u32;
        self.speed = (1..=GREATEST_SPEED * WHOLE_TICK)
            .contains(&parts)
            .then_some(parts)
            .ok_or(Field::Speed)?;
        Ok(())
    }
}
