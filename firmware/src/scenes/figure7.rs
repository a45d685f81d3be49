//! Figure 7: the page's chaotic motion by the right equations and by the ones it prints, side by side.

use double_pendulum::trig::{DefaultTrig, SinCos};
use double_pendulum::{Error, Parameters, Pendulum, State, rk4};

use crate::brush::{Spot, Stroke};
use crate::canvas::{Canvas, HEIGHT, WIDTH};
use crate::config::{STEP, STEPS_PER_TICK};
use crate::ink::Ink;
use crate::label;
use crate::scene::{Report, Scene};
use crate::settings::Settings;
use crate::simulation::Simulation;
use crate::text::{self, Anchor, LINE};
use crate::trust::{self, Trust};
use crate::view::{Place, View};

/// Half the width of a trace, subpixels.
const HALF_WIDTH: u8 = 30;

/// The figure's start: mass ratio 2.75, both rods at 171 degrees, l = 1 m, g = 9.8 m/s^2, let go from rest.
pub fn figure() -> Settings {
    Settings { parameters: Parameters::equal_rods(2.75, 1.0, 9.8), degrees: [171.0; 2], velocities: [0.0; 2] }
}

/// Both motions with bob 2's whole trace, and their energies. The honest clock is that of the right equations.
#[derive(Clone, Debug)]
pub struct Figure7 {
    right: Simulation,
    misprinted: State<f32>,
    views: [View; 2],
    /// The bobs of both pendulums.
    bobs: [[Spot; 2]; 2],
    ink: Ink,
    trust: Trust,
}

impl Figure7 {
    /// Where the bobs of both pendulums are, pixels.
    fn places(&self) -> [[(f32, f32); 2]; 2] {
        let pendulum = self.right.pendulum();
        let [left_view, right_view] = &self.views;
        [left_view.bobs(pendulum, &self.right.state()), right_view.bobs(pendulum, &self.misprinted)]
    }
}

fn spots(places: [[(f32, f32); 2]; 2]) -> [[Spot; 2]; 2] {
    places.map(|bobs| bobs.map(|(x, y)| Spot::at(x, y)))
}

impl Scene for Figure7 {
    fn new(settings: &Settings) -> Result<Self, Error> {
        let &Parameters { l1, l2, .. } = &settings.parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods { l1: l1.into(), l2: l2.into() });
        }
        let right = Simulation::new(settings)?;
        let views = Place::HALVES.map(|place| View::new(&settings.parameters, place));
        let misprinted = right.state();
        let trust = Trust::new(misprinted);
        let mut scene = Self { right, misprinted, views, bobs: Default::default(), ink: Ink::default(), trust };
        scene.bobs = spots(scene.places());
        Ok(scene)
    }

    fn tick(&mut self) {
        self.right.tick();
        for _ in 0..STEPS_PER_TICK {
            let state = rk4::step(|z| misprinted(self.right.pendulum(), z), &self.misprinted.into(), STEP);
            self.misprinted = state.into();
        }
        let places = self.places();
        let [shown, _] = places;
        let (pendulum, [view, _]) = (self.right.pendulum(), &self.views);
        let places_of = |state: &_| view.bobs(pendulum, state);
        self.trust.tick(self.right.time(), shown, |z| pendulum.derivatives(z), places_of);
        let bobs = spots(places);
        for ([_, from], [_, to]) in self.bobs.into_iter().zip(bobs) {
            self.ink.add(Stroke { from, to, radius: HALF_WIDTH });
        }
        self.bobs = bobs;
        self.ink.tick();
    }

    fn draw(&self, canvas: &mut Canvas) {
        canvas.clone_from(self.ink.picture());
        for (view, bobs) in self.views.iter().zip(self.bobs) {
            view.draw(canvas, bobs, u8::MAX);
        }
        let energies = [self.right.state(), self.misprinted].map(|state| self.right.pendulum().energy(&state));
        let [right, misprinted] = energies.map(|energy| label::tenths(energy, " J"));
        text::write(canvas, &right, Anchor::TopLeft);
        text::write(canvas, &misprinted, Anchor::TopRight);
        let middle = |row| Anchor::Centred(WIDTH as i32 / 2, row);
        trust::draw_clock(canvas, self.right.time(), self.trust.until(), middle(0), middle(HEIGHT as i32 - LINE));
    }

    fn report(&self) -> Report {
        Report::of(&self.right, self.trust.until())
    }
}

/// The equal-rod equations exactly as the page prints them: the denominator of a2' lacks the factor mu = m2/m1. Unless
/// mu = 1 they are not Hamilton's equations of anything, and what should be the energy is not kept. Nothing but this
/// scene uses them.
fn misprinted(pendulum: &Pendulum<f32>, &[a1, a2, p1, p2]: &[f32; 4]) -> [f32; 4] {
    let &Parameters { m1, m2, l1: l, g, .. } = pendulum.parameters();
    let mu = m2 / m1;
    let (sin1, cos1) = DefaultTrig::sin_cos(a1);
    let (sin2, cos2) = DefaultTrig::sin_cos(a2);
    let sin_d = sin1 * cos2 - cos1 * sin2;
    let cos_d = cos1 * cos2 + sin1 * sin2;
    let den = m1 * l * l * (1.0 + mu * sin_d * sin_d);
    let term1 = p1 * p2 * sin_d / den;
    let bracket = p1 * p1 * mu - 2.0 * p1 * p2 * mu * cos_d + p2 * p2 * (1.0 + mu);
    let term2 = m1 * l * l * bracket * sin_d * cos_d / (den * den);
    [
        (p1 - p2 * cos_d) / den,
        (p2 * (1.0 + mu) - p1 * mu * cos_d) / den,
        -m1 * (1.0 + mu) * g * l * sin1 - term1 + term2,
        -m1 * mu * g * l * sin2 + term1 - term2,
    ]
}
