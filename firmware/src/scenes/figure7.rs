//! Figure 7: the page's chaotic motion by the right equations and by the ones it prints, side by side.

use double_pendulum::{Error, Parameters, State, rk4};

use crate::brush::{Spot, Stroke};
use crate::canvas::{Canvas, HEIGHT, WIDTH};
use crate::config::{STEP, STEPS_PER_TICK};
use crate::ink::Ink;
use crate::label;
use crate::scene::{Report, Scene};
use crate::settings::Settings;
use crate::simulation::Simulation;
use crate::swing::Directions;
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
    misprinted: Misprinted,
    views: [View; 2],
    /// The bobs of both pendulums.
    bobs: [[Spot; 2]; 2],
    ink: Ink,
    trust: Trust,
}

impl Figure7 {
    /// Where the bobs of both pendulums are, pixels.
    fn places(&self) -> [[(f32, f32); 2]; 2] {
        let [left_view, right_view] = &self.views;
        [left_view.bobs(self.right.directions()), right_view.bobs(self.misprinted.directions())]
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
        let start = right.state();
        let misprinted = Misprinted::new(settings.parameters, &start);
        let trust = Trust::new(&settings.parameters, &start)?;
        let mut scene = Self { right, misprinted, views, bobs: Default::default(), ink: Ink::default(), trust };
        scene.bobs = spots(scene.places());
        Ok(scene)
    }

    fn tick(&mut self) {
        self.right.tick();
        self.misprinted.tick();
        let places = self.places();
        let [shown, _] = places;
        let [view, _] = &self.views;
        self.trust.tick(self.right.time(), shown, |directions| view.bobs(directions));
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
        let states = [self.right.state(), self.misprinted.state()];
        let energies = states.map(|state| self.right.energy().pendulum().energy(&state));
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

/// A motion by the equal-rod equations exactly as the page prints them: the denominator of a2' lacks the factor
/// mu = m2/m1. Unless mu = 1 they are not Hamilton's equations of anything, and what should be the energy is not kept.
/// Nothing but this scene uses them.
#[derive(Clone, Copy, Debug)]
struct Misprinted {
    parameters: Parameters<f32>,
    /// sin a1, cos a1, sin D, cos D, p1, p2 with D = a1 - a2: nothing here needs an angle.
    z: [f32; 6],
}

impl Misprinted {
    fn new(parameters: Parameters<f32>, start: &State<f32>) -> Self {
        let (sin1, cos1) = libm::sincosf(start.a1);
        let (sin_d, cos_d) = libm::sincosf(start.a1 - start.a2);
        Self { parameters, z: [sin1, cos1, sin_d, cos_d, start.p1, start.p2] }
    }

    fn tick(&mut self) {
        for _ in 0..STEPS_PER_TICK {
            self.z = rk4::step(|z| self.derivatives(z), &self.z, STEP);
        }
        let [sin1, cos1, sin_d, cos_d, p1, p2] = self.z;
        let ([sin1, cos1], [sin_d, cos_d]) = (unit([sin1, cos1]), unit([sin_d, cos_d]));
        self.z = [sin1, cos1, sin_d, cos_d, p1, p2];
    }

    fn directions(&self) -> Directions {
        let [sin1, cos1, sin_d, cos_d, ..] = self.z;
        [[sin1, cos1], [sin1 * cos_d - cos1 * sin_d, cos1 * cos_d + sin1 * sin_d]]
    }

    fn state(&self) -> State<f32> {
        let [.., p1, p2] = self.z;
        let [a1, a2] = self.directions().map(|[sin, cos]| libm::atan2f(sin, cos));
        State { a1, a2, p1, p2 }
    }

    fn derivatives(&self, &[sin1, cos1, sin_d, cos_d, p1, p2]: &[f32; 6]) -> [f32; 6] {
        let Parameters { m1, m2, l1: l, g, .. } = self.parameters;
        let mu = m2 / m1;
        let inertia = m1 * l * l;
        let sin2 = sin1 * cos_d - cos1 * sin_d;
        let inverse = 1.0 / (inertia * (1.0 + mu * sin_d * sin_d));
        let w1 = (p1 - p2 * cos_d) * inverse;
        let w2 = (p2 * (1.0 + mu) - p1 * mu * cos_d) * inverse;
        let term1 = p1 * p2 * sin_d * inverse;
        let bracket = p1 * p1 * mu - 2.0 * p1 * p2 * mu * cos_d + p2 * p2 * (1.0 + mu);
        let term2 = inertia * bracket * sin_d * cos_d * inverse * inverse;
        let w = w1 - w2;
        [
            cos1 * w1,
            -sin1 * w1,
            cos_d * w,
            -sin_d * w,
            -m1 * (1.0 + mu) * g * l * sin1 - term1 + term2,
            -m1 * mu * g * l * sin2 + term1 - term2,
        ]
    }
}

/// A direction made as long as 1 again, to first order in what it misses.
fn unit([sin, cos]: [f32; 2]) -> [f32; 2] {
    let gain = 1.5 - 0.5 * (sin * sin + cos * cos);
    [gain * sin, gain * cos]
}
