//! Figure 7: the page's chaotic motion by the right equations and by the ones it prints, side by side.

use double_pendulum::trig::{Own, SinCos};
use double_pendulum::{Error, Parameters, State, rk4};

use crate::config::{DT, PAGE_GRAVITY, STEPS_PER_TICK};
use crate::graphics::brush::{Spot, Stroke};
use crate::graphics::canvas::{Canvas, WIDTH};
use crate::graphics::fade_layer::FadeLayer;
use crate::graphics::label;
use crate::graphics::text::{self, Anchor, LINE, LOWEST};
use crate::graphics::view::{Place, View};
use crate::motion::direction_stepper::Directions;
use crate::motion::planner::Shown;
use crate::motion::settings::Settings;
use crate::motion::simulation::{Means, Simulation};
use crate::scenes::horizon;
use crate::scenes::scene::{Report, Scene};

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
    /// The bobs of both pendulums.
    bobs: [[Spot; 2]; 2],
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
        scene.bobs = spots(scene.places());
        Ok(scene)
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        self.right.tick();
        self.misprinted.tick();
        let bobs = spots(self.places());
        for ([_, from], [_, to]) in self.bobs.into_iter().zip(bobs) {
            ink.add(Stroke { from, to, radius: HALF_WIDTH }, u8::MAX);
        }
        self.bobs = bobs;
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        for (view, bobs) in self.views.iter().zip(self.bobs) {
            view.draw(canvas, bobs, u8::MAX);
        }
        let states = [report.state, self.misprinted.state()];
        let energies = states.map(|state| self.right.energy().pendulum().energy(&state));
        let [right, misprinted] = energies;
        let [right, misprinted] = [label::energy("true", right), label::energy("book", misprinted)];
        text::write(canvas, &right, Anchor::TopLeft);
        text::write(canvas, &misprinted, Anchor::TopRight);
        let middle = |row| Anchor::Centred(WIDTH as i32 / 2, row);
        horizon::draw_clock(canvas, report, middle(LINE + 1), middle(LOWEST));
    }

    fn report(&self) -> Report {
        Report::of(&self.right)
    }

    fn shown(&self) -> Option<Shown> {
        Shown::pendulum(self.right.given(), Place::HALVES[0].reach)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.right)
    }
}

/// A motion by the equal-rod equations that the page prints: the denominator of a2' lacks the factor mu = m2/m1. Unless
/// mu = 1 they are not Hamilton's equations of anything, and what should be the energy is not kept. Nothing but this
/// scene uses them.
///
/// With q = p/(m1 l^2), r = 1/(1 + mu sin^2 D), D = a1 - a2:
///
/// - a1' = u = (q1 - q2 cos D) r; a2' = v = (q2 (1 + mu) - q1 mu cos D) r
/// - q1' = -(1 + mu) g/l sin a1 - F; q2' = -mu g/l sin a2 + F
///
/// F = u v sin D is, term by term, the two long fractions of the page in one.
#[derive(Clone, Copy, Debug)]
struct Misprinted {
    /// mu and 1 + mu.
    masses: [f32; 2],
    /// (1 + mu) g/l and mu g/l.
    gravity: [f32; 2],
    /// m1 l^2.
    inertia: f32,
    /// sin a1, cos a1, sin D, cos D, q1, q2: nothing here needs an angle.
    z: [f32; 6],
}

impl Misprinted {
    fn new(parameters: &Parameters<f32>, start: &State<f32>) -> Self {
        let &Parameters { m1, m2, l1: l, g, .. } = parameters;
        let (mu, inertia) = (m2 / m1, m1 * l * l);
        let (sin1, cos1) = Own::sin_cos(start.a1);
        let (sin_d, cos_d) = Own::sin_cos(start.a1 - start.a2);
        Self {
            masses: [mu, 1.0 + mu],
            gravity: [(1.0 + mu) * g / l, mu * g / l],
            inertia,
            z: [sin1, cos1, sin_d, cos_d, start.p1 / inertia, start.p2 / inertia],
        }
    }

    fn tick(&mut self) {
        for _ in 0..STEPS_PER_TICK {
            self.z = rk4::step(|z| self.derivatives(z), &self.z, DT as f32);
        }
        let [sin1, cos1, sin_d, cos_d, q1, q2] = self.z;
        let ([sin1, cos1], [sin_d, cos_d]) = (unit([sin1, cos1]), unit([sin_d, cos_d]));
        self.z = [sin1, cos1, sin_d, cos_d, q1, q2];
    }

    fn directions(&self) -> Directions {
        let [sin1, cos1, sin_d, cos_d, ..] = self.z;
        [[sin1, cos1], [sin1 * cos_d - cos1 * sin_d, cos1 * cos_d + sin1 * sin_d]]
    }

    fn state(&self) -> State<f32> {
        let [.., q1, q2] = self.z;
        let [a1, a2] = self.directions().map(|[sin, cos]| libm::atan2f(sin, cos));
        State { a1, a2, p1: q1 * self.inertia, p2: q2 * self.inertia }
    }

    fn derivatives(&self, &[sin1, cos1, sin_d, cos_d, q1, q2]: &[f32; 6]) -> [f32; 6] {
        let ([mu, total], [gravity1, gravity2]) = (self.masses, self.gravity);
        let r = 1.0 / (1.0 + mu * sin_d * sin_d);
        let u = (q1 - q2 * cos_d) * r;
        let v = (q2 * total - q1 * mu * cos_d) * r;
        let force = u * v * sin_d;
        let sin2 = sin1 * cos_d - cos1 * sin_d;
        let w = u - v;
        [cos1 * u, -sin1 * u, cos_d * w, -sin_d * w, -gravity1 * sin1 - force, force - gravity2 * sin2]
    }
}

/// A direction made as long as 1 again, to first order in what it misses.
fn unit([sin, cos]: [f32; 2]) -> [f32; 2] {
    let gain = 1.5 - 0.5 * (sin * sin + cos * cos);
    [gain * sin, gain * cos]
}
