//! Figure 7: the page's chaotic motion by the right equations and by the ones it prints, side by side.

use double_pendulum::{Error, Parameters};

use crate::config::PAGE_GRAVITY;
use crate::graphics::{Anchor, Canvas, FadeLayer, LINE, LOWEST, Place, Spot, Stroke, View, WIDTH, label, text};
use crate::motion::{Means, Misprinted, Settings, Simulation, Viewport};
use crate::scenes::{Report, Scene, horizon};

/// Half the width of a trace, subpixels.
const HALF_WIDTH: u8 = 30;

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
    bobs: [[Spot; 2]; 2],
}

impl Figure7 {
    fn places(&self) -> [[Spot; 2]; 2] {
        let [left_view, right_view] = &self.views;
        [left_view.spots(self.right.directions()), right_view.spots(self.misprinted.directions())]
    }
}

impl Scene for Figure7 {
    /// Never inlined: all scenes' preparations would stand side by side on the stack.
    #[inline(never)]
    fn new(settings: &Settings, means: &Means) -> Result<Self, Error> {
        let &Parameters { l1, l2, .. } = &settings.parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods { l1: l1.into(), l2: l2.into() });
        }
        let right = Simulation::new(settings, means)?;
        let views = Place::HALVES.map(|place| View::new(&settings.parameters, place));
        let start = right.state();
        let misprinted = Misprinted::new(&settings.parameters, &start);
        let mut scene = Self { right, misprinted, views, bobs: Default::default() };
        scene.bobs = scene.places();
        Ok(scene)
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        self.right.tick();
        self.misprinted.tick();
        let bobs = self.places();
        for ([_, from], [_, to]) in self.bobs.into_iter().zip(bobs) {
            ink.add(Stroke { from, to, radius: HALF_WIDTH }, u8::MAX);
        }
        self.bobs = bobs;
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        for (view, bobs) in self.views.iter().zip(self.bobs) {
            view.draw(canvas, bobs, u8::MAX);
        }
        let (right, misprinted) = (self.right.energy().of_error(report.energy_error), self.misprinted.energy());
        let [right, misprinted] = [label::energy("true", right), label::energy("book", misprinted)];
        text::write(canvas, &right, Anchor::TopLeft);
        text::write(canvas, &misprinted, Anchor::TopRight);
        let middle = |row| Anchor::Centred(WIDTH as i32 / 2, row);
        horizon::draw_clock(canvas, report, middle(LINE + 1), middle(LOWEST));
    }

    fn report(&self) -> Report {
        Report::of(&self.right)
    }

    fn viewport(&self) -> Option<Viewport> {
        Viewport::pendulum(self.right.given(), Place::HALVES[0].reach)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.right)
    }
}
