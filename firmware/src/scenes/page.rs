//! The page's animation: one pendulum with bob 2's trail.

use double_pendulum::Error;

use crate::config::{TRAIL_BRIGHTNESS, TRAIL_FADING, TRAIL_HALF_WIDTH};
use crate::graphics::{Anchor, Canvas, FadeLayer, Fading, LINE, LOWEST, Place, SUBPIXELS, View, label, text};
use crate::motion::{Means, Settings, Simulation};
use crate::scenes::{Report, Scene, scene};

/// One pendulum, bob 2's trail, and settings and time in the corners, the one place the motion never reaches.
#[derive(Clone, Debug)]
pub struct Page {
    settings: Settings,
    simulation: Simulation,
    view: View,
}

impl Scene for Page {
    const FADING: Fading = Fading { rows: TRAIL_FADING, last: 0 };

    fn new(settings: &Settings, means: &Means) -> Result<Self, Error> {
        let simulation = Simulation::new(settings, means)?;
        let view = View::new(&settings.parameters, Place::WHOLE, simulation.motion.directions());
        Ok(Self { settings: *settings, simulation, view })
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        self.simulation.tick();
        let half_width = (TRAIL_HALF_WIDTH * SUBPIXELS as f32) as u8;
        self.view.trace(self.simulation.motion.directions(), ink, half_width, TRAIL_BRIGHTNESS);
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.view.draw(canvas, u8::MAX);
        let [degrees1, degrees2] = self.settings.degrees;
        text::write(canvas, &label::mass_ratio(self.settings.mass_ratio()), Anchor::TopLeft);
        if degrees1 == degrees2 {
            text::write(canvas, &label::degrees("α ", degrees1), Anchor::BottomLeft);
        } else {
            text::write(canvas, &label::degrees("α₁ ", degrees1), Anchor::At(1, LOWEST - LINE));
            text::write(canvas, &label::degrees("α₂ ", degrees2), Anchor::BottomLeft);
        }
        scene::draw_clock(canvas, report, Anchor::TopRight, Anchor::BottomRight);
    }

    fn report(&self) -> Report {
        Report::of(&self.simulation)
    }

    fn height(&self) -> Option<f32> {
        Some(2.0 * Place::WHOLE.reach)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.simulation)
    }
}
