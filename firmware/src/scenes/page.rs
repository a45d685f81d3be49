//! The page's animation: one pendulum with bob 2's trail.

use double_pendulum::Error;

use crate::graphics::brush::Spot;
use crate::graphics::canvas::Canvas;
use crate::graphics::fade_layer::FadeLayer;
use crate::graphics::label;
use crate::graphics::text::{self, Anchor, LINE, LOWEST};
use crate::graphics::trail::Trail;
use crate::graphics::view::{Place, View};
use crate::motion::planner::Shown;
use crate::motion::settings::Settings;
use crate::motion::simulation::Simulation;
use crate::scenes::horizon::{self, AccuracyHorizon};
use crate::scenes::scene::{Report, Scene};

/// One pendulum, bob 2's trail, and settings and time in the corners, the one place the motion never reaches.
#[derive(Clone, Debug)]
pub struct Page {
    settings: Settings,
    simulation: Simulation,
    horizon: AccuracyHorizon,
    view: View,
    trail: Trail,
}

impl Page {
    fn bobs(&self) -> [(f32, f32); 2] {
        self.view.bobs(self.simulation.directions())
    }

    fn spots(&self) -> [Spot; 2] {
        self.bobs().map(|(x, y)| Spot::at(x, y))
    }
}

impl Scene for Page {
    fn new(settings: &Settings) -> Result<Self, Error> {
        let simulation = Simulation::new(settings)?;
        let view = View::new(&settings.parameters, Place::WHOLE);
        let [_, bob2] = view.spots(simulation.directions());
        let horizon = AccuracyHorizon::new(&settings.parameters, &simulation.state())?;
        Ok(Self { settings: *settings, simulation, horizon, view, trail: Trail::new(bob2) })
    }

    fn tick(&mut self, _: &mut FadeLayer) {
        self.simulation.tick();
        let shown = self.bobs();
        let [_, (x, y)] = shown;
        self.trail.push(Spot::at(x, y));
        self.horizon.tick(self.simulation.time(), shown, |directions| self.view.bobs(directions));
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.trail.draw(canvas);
        self.view.draw(canvas, self.spots(), u8::MAX);
        let [degrees1, degrees2] = self.settings.degrees;
        text::write(canvas, &label::mass_ratio(self.settings.mass_ratio()), Anchor::TopLeft);
        if degrees1 == degrees2 {
            text::write(canvas, &label::degrees("α", degrees1), Anchor::BottomLeft);
        } else {
            let [name1, name2] = label::ANGLES;
            text::write(canvas, &label::degrees(name1, degrees1), Anchor::At(1, LOWEST - LINE));
            text::write(canvas, &label::degrees(name2, degrees2), Anchor::BottomLeft);
        }
        horizon::draw_clock(canvas, report, Anchor::TopRight, Anchor::BottomRight);
    }

    fn report(&self) -> Report {
        Report::of(&self.simulation, self.horizon.until())
    }

    fn shown(&self) -> Option<Shown> {
        Shown::pendulum(Place::WHOLE.reach)
    }
}
