//! Figure 7: the page's chaotic motion by the right equations and by the ones it prints, side by side.

use double_pendulum::{Error, Parameters};

use crate::config::PAGE_GRAVITY;
use crate::graphics::{Anchor, Canvas, FadeLayer, LINE, LOWEST, Place, TRACE_HALF_WIDTH, View, label, text};
use crate::motion::{Means, Misprinted, Settings, Simulation};
use crate::scenes::{Report, Scene, scene};

/// The figure's start: mass ratio 2.75, both rods at 171 degrees, let go from rest. The page gives no more; gravity is that
/// of its worked example, and the rods are 1 m.
pub fn figure() -> Settings {
    let parameters = Parameters::equal_rods(2.75, 1.0, PAGE_GRAVITY as f32);
    Settings { parameters, degrees: [171.0; 2], velocities: [0.0; 2] }
}

/// Both motions with bob 2's whole trace, and their energies. The clock is that of the right equations.
#[derive(Clone, Debug)]
pub struct Figure7 {
    right: Simulation,
    misprinted: Misprinted,
    views: [View; 2],
}

impl Scene for Figure7 {
    #[inline(never)] // all scenes' preparations would stand side by side on the stack
    fn new(settings: &Settings, means: &Means) -> Result<Self, Error> {
        let &Parameters { l1, l2, .. } = &settings.parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods { l1: l1.into(), l2: l2.into() });
        }
        let right = Simulation::new(settings, means)?;
        let misprinted = Misprinted::new(&settings.parameters, &right.motion.rounded_state());
        let view = |place, directions| View::new(&settings.parameters, place, directions);
        let [left, right_half] = Place::HALVES;
        let views = [view(left, right.motion.directions()), view(right_half, misprinted.directions())];
        Ok(Self { right, misprinted, views })
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        self.right.tick();
        self.misprinted.tick();
        let [left, right] = &mut self.views;
        left.trace(self.right.motion.directions(), ink, TRACE_HALF_WIDTH, u8::MAX);
        right.trace(self.misprinted.directions(), ink, TRACE_HALF_WIDTH, u8::MAX);
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.views.iter().for_each(|view| view.draw(canvas, u8::MAX));
        let (right, misprinted) = (self.right.energy.of_error(report.energy_error), self.misprinted.energy());
        text::write(canvas, &label::label("true ", right, 1, " J"), Anchor::TopLeft);
        text::write(canvas, &label::label("book ", misprinted, 1, " J"), Anchor::TopRight);
        scene::draw_clock(canvas, report, Anchor::Middle(LINE + 1), Anchor::Middle(LOWEST));
    }

    fn report(&self) -> Report {
        Report::of(&self.right)
    }

    fn height(&self) -> Option<f32> {
        Some(2.0 * Place::HALVES[0].reach)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.right)
    }
}
