//! How a scene's time goes: at full speed, slower, faster, or step by step.

use crate::config::GREATEST_SPEED;
use crate::protocol::Field;

/// Full speed, in the parts that a tick is made of: one of them is the least speed.
const WHOLE_TICK: u32 = 100;

#[derive(Clone, Copy, Debug)]
pub struct Pace {
    pub paused: bool,
    /// Ticks still to do, one in each tick of the clock, while it is paused.
    pub steps: u32,
    /// Ticks of the scene in [`WHOLE_TICK`] ticks of the clock.
    speed: u32,
    /// The part of the scene's next tick that has passed.
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
    /// 1 is full speed.
    pub fn speed(&self) -> f32 {
        self.speed as f32 / WHOLE_TICK as f32
    }

    /// How many ticks the scene does in this tick of the clock.
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

    /// Sets the speed, to the nearest part; refuses one that is out of range.
    pub fn set_speed(&mut self, speed: f64) -> Result<(), Field> {
        let parts = (speed * f64::from(WHOLE_TICK) + 0.5) as u32;
        self.speed = (1..=GREATEST_SPEED * WHOLE_TICK)
            .contains(&parts)
            .then_some(parts)
            .ok_or(Field::Speed)?;
        Ok(())
    }
}
