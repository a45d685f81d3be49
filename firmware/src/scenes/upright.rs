//! Upright: both rods at exactly 180 degrees, where the pendulum would stand for ever if the number pi could be held.

use double_pendulum::Error;

use crate::brush::{Spot, Stroke};
use crate::canvas::{Canvas, HEIGHT, WIDTH};
use crate::compensated::Compensated;
use crate::config::{STEP, STEPS_PER_TICK};
use crate::ink::Ink;
use crate::scene::{Report, Scene};
use crate::settings::Settings;
use crate::simulation::Simulation;
use crate::text::{self, Anchor, LINE};
use crate::trust::{self, HALF_PIXEL};
use crate::view::{Place, View};

/// Half the width of a trace, subpixels.
const HALF_WIDTH: u8 = 30;
/// Straight up is this many degrees.
const STRAIGHT_UP: f32 = 180.0;

/// Both rods straight up, let go from rest.
pub fn straight_up() -> Settings {
    Settings::equal_rods(1.0, STRAIGHT_UP)
}

/// The same motion in plain `f32` on the left and in compensated `f32` on the right.
///
/// The `f32` nearest to pi is 8.7e-8 too large, so the true motion from there falls after about 3 s. Plain `f32` drops
/// the first tiny increments altogether and stands for minutes: it looks perfect and is wrong. What is kept beside the
/// state on the right is just what was dropped.
#[derive(Clone, Debug)]
pub struct Upright {
    plain: Simulation,
    compensated: Compensated,
    views: [View; 2],
    bobs: [[Spot; 2]; 2],
    ink: Ink,
    trusted_until: f32,
}

impl Upright {
    fn places(&self) -> [[Spot; 2]; 2] {
        let pendulum = self.plain.pendulum();
        let [left, right] = &self.views;
        [left.spots(pendulum, &self.plain.state()), right.spots(pendulum, &self.compensated.state())]
    }

    /// Whether the plain motion is no longer shown where the compensated one is.
    fn have_parted(&self) -> bool {
        let [left, _] = &self.views;
        let bobs = |state| left.bobs(self.plain.pendulum(), &state);
        trust::are_apart(bobs(self.plain.state()), bobs(self.compensated.state()), HALF_PIXEL)
    }
}

impl Scene for Upright {
    fn new(settings: &Settings) -> Result<Self, Error> {
        let plain = Simulation::new(settings)?;
        let views = Place::HALVES.map(|place| View::new(&settings.parameters, place));
        let compensated = Compensated::new(plain.state());
        let (bobs, ink) = (Default::default(), Ink::default());
        let mut scene = Self { plain, compensated, views, bobs, ink, trusted_until: f32::INFINITY };
        scene.bobs = scene.places();
        Ok(scene)
    }

    fn tick(&mut self) {
        self.plain.tick();
        for _ in 0..STEPS_PER_TICK {
            self.compensated = self.compensated.step(|z| self.plain.pendulum().derivatives(z), STEP);
        }
        if self.trusted_until.is_infinite() && self.have_parted() {
            self.trusted_until = self.plain.time() as f32;
        }
        let places = self.places();
        for ([_, from], [_, to]) in self.bobs.into_iter().zip(places) {
            self.ink.add(Stroke { from, to, radius: HALF_WIDTH });
        }
        self.bobs = places;
        self.ink.tick();
    }

    fn draw(&self, canvas: &mut Canvas) {
        canvas.clone_from(self.ink.picture());
        for (view, bobs) in self.views.iter().zip(self.bobs) {
            view.draw(canvas, bobs, u8::MAX);
        }
        text::write(canvas, "plain", Anchor::TopLeft);
        text::write(canvas, "compensated", Anchor::TopRight);
        let middle = |row| Anchor::Centred(WIDTH as i32 / 2, row);
        let (time, until) = (self.plain.time(), self.trusted_until);
        trust::draw_clock(canvas, time, until, middle(LINE), middle(HEIGHT as i32 - LINE));
    }

    fn report(&self) -> Report {
        Report::of(&self.plain, self.trusted_until)
    }
}
