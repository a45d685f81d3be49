//! An emulator that may be faster than the board, held to its pace.

use std::thread::sleep;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;

/// When the next frame is due.
#[derive(Debug)]
pub struct Pace(Instant);

impl Pace {
    /// From now on.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Waits until it is time for one more frame; what is late is not made up for.
    pub fn keep(&mut self) {
        sleep(self.0.saturating_duration_since(Instant::now()));
        self.0 = self.0.max(Instant::now()) + Duration::from_secs(1) / TICK_RATE;
    }
}
