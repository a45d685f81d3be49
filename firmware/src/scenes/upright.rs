//! Upright: both rods at exactly 180 degrees, where the pendulum would stand for ever if the number pi could be held.

use double_pendulum::{DirectionF32, Error, Real, Run, State};

use crate::config::{DT, HALF_PIXEL, STEPS_PER_TICK};
use crate::graphics::{Anchor, Canvas, FadeLayer, LINE, LOWEST, Place, RodDirections, Spot, Stroke, View, WIDTH, text};
use crate::motion::{Energy, Means, Settings};
use crate::scenes::horizon::{self, LastRight};
use crate::scenes::{Report, Scene, scene};

/// Half the width of a trace, subpixels.
const HALF_WIDTH: u8 = 30;
/// Straight up is this many degrees.
const STRAIGHT_UP: f32 = 180.0;

/// Both rods straight up, let go from rest.
pub fn straight_up() -> Settings {
    Settings::equal_rods(1.0, STRAIGHT_UP)
}

/// The same motion in plain `f32` on the left and in compensated `f32` on the right. The clock is that of the left one,
/// beside the right one. There is no plan: both are shown for what their arithmetic does.
///
/// The `f32` nearest to pi is 8.7e-8 too large, so the true motion from there falls after about 3 s. Plain `f32` drops
/// the first tiny increments altogether and stands for minutes: it looks perfect and is wrong. What is kept beside the
/// state on the right is just what was dropped.
#[derive(Clone, Debug)]
pub struct Upright {
    plain: State<f32>,
    plain_directions: RodDirections,
    compensated: Run<DirectionF32>,
    energy: Energy,
    ticks: u64,
    views: [View; 2],
    bobs: [[Spot; 2]; 2],
    horizon: LastRight,
}

impl Upright {
    fn places(&self) -> [[Spot; 2]; 2] {
        let [left, right] = &self.views;
        [left.spots(self.plain_directions), right.spots(self.compensated.directions())]
    }

    /// Whether the plain motion is no longer shown where the compensated one is.
    fn have_parted(&self) -> bool {
        let [left, _] = &self.views;
        let [plain, compensated] = [self.plain_directions, self.compensated.directions()].map(|to| left.bobs(to));
        horizon::are_apart(plain, compensated, HALF_PIXEL)
    }
}

fn directions(state: &State<f32>) -> RodDirections {
    state.angles().map(|angle| angle.own_sin_cos().into())
}

impl Scene for Upright {
    fn new(settings: &Settings, _: &Means) -> Result<Self, Error> {
        let pendulum = settings.pendulum()?;
        pendulum.check_step(DT)?;
        let plain = settings.start(&pendulum)?;
        let views = Place::HALVES.map(|place| View::new(&settings.parameters, place));
        let compensated = pendulum.run(&plain, DT)?;
        let (plain_directions, horizon, ticks) = (directions(&plain), LastRight::default(), 0);
        let energy = Energy::new(pendulum, pendulum.energy_at(plain_directions, [plain.p1, plain.p2]));
        let bobs = Default::default();
        let mut scene = Self { plain, plain_directions, compensated, energy, ticks, views, bobs, horizon };
        scene.bobs = scene.places();
        Ok(scene)
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        for _ in 0..STEPS_PER_TICK {
            self.plain = self.energy.pendulum().step(&self.plain, DT as f32);
        }
        self.plain_directions = directions(&self.plain);
        // One that is lost stands still.
        let _stays = self.compensated.advance(STEPS_PER_TICK);
        self.ticks = self.ticks.wrapping_add(1);
        let is_right = !self.have_parted();
        self.horizon.note(scene::time(self.ticks), is_right);
        let places = self.places();
        for ([_, from], [_, to]) in self.bobs.into_iter().zip(places) {
            ink.add(Stroke { from, to, radius: HALF_WIDTH }, u8::MAX);
        }
        self.bobs = places;
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        for (view, bobs) in self.views.iter().zip(self.bobs) {
            view.draw(canvas, bobs, u8::MAX);
        }
        text::write(canvas, "plain", Anchor::TopLeft);
        text::write(canvas, "compensated", Anchor::TopRight);
        let middle = |row| Anchor::Centred(WIDTH as i32 / 2, row);
        horizon::draw_clock(canvas, report, middle(LINE + 1), middle(LOWEST));
    }

    fn report(&self) -> Report {
        let energy = self.energy.pendulum().energy_at(self.plain_directions, [self.plain.p1, self.plain.p2]);
        let (energy_error, horizon) = (self.energy.error(energy), self.horizon.until());
        Report { state: self.plain, energy_error, horizon, ..Report::of_figure(self.ticks) }
    }
}
