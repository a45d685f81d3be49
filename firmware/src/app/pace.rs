//! The pace of a scene: at full speed, slower, faster, or step by step.

use crate::config::GREATEST_SPEED;
use crate::protocol::Field;

/// The number of parts of a tick. One part per tick is the smallest speed.
const WHOLE_TICK: u32 = 100;

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
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            paused: false,
            steps: 0,
            speed: WHOLE_TICK,
            part: 0,
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
