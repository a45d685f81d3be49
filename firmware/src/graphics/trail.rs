//! Where bob 2 has been: a line that fades and thins with age.

use core::iter;

use crate::config::{TRAIL_PERIOD_TICKS, TRAIL_POINTS};
use crate::graphics::brush::{Spot, Stroke};
use crate::graphics::canvas::Canvas;
use crate::graphics::history::History;

/// Brightness of the trail, of 255, and half its width, subpixels, at its far end and at the bob.
const BRIGHTNESS: [u8; 2] = [24, 184];
const HALF_WIDTH: [u8; 2] = [20, 44];

/// Places of bob 2, one kept every [`TRAIL_PERIOD_TICKS`] whether or not a frame was drawn.
#[derive(Clone, Debug)]
pub struct Trail {
    kept: History<Spot, TRAIL_POINTS>,
    newest: Spot,
    /// Ticks since a place was kept.
    ticks: u8,
}

impl Trail {
    /// A trail that begins at `start`.
    pub fn new(start: Spot) -> Self {
        let mut kept = History::new(start);
        kept.write(start);
        Self { kept, newest: start, ticks: 0 }
    }

    /// Where bob 2 is one tick later.
    pub fn push(&mut self, spot: Spot) {
        self.newest = spot;
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks >= TRAIL_PERIOD_TICKS {
            self.ticks = 0;
            self.kept.write(spot);
        }
    }

    /// The places from the oldest to the newest.
    pub fn spots(&self) -> impl Iterator<Item = Spot> + Clone {
        self.kept.oldest_first().copied().chain(iter::once(self.newest))
    }

    /// Draws it, the youngest piece brightest and widest.
    pub fn draw(&self, canvas: &mut Canvas) {
        let missing = TRAIL_POINTS.saturating_sub(self.kept.len());
        let pieces = self.spots().zip(self.spots().skip(1));
        for (number, (from, to)) in pieces.enumerate() {
            let youth = missing + number + 1;
            Stroke { from, to, radius: fade(youth, HALF_WIDTH) }.lighten(canvas, fade(youth, BRIGHTNESS));
        }
    }
}

/// From `old` at a youth of 0 to `young` at [`TRAIL_POINTS`], in proportion.
fn fade(youth: usize, [old, young]: [u8; 2]) -> u8 {
    let gain = youth.min(TRAIL_POINTS) * usize::from(young.saturating_sub(old)) / TRAIL_POINTS;
    old.saturating_add(gain as u8)
}
