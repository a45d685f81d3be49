//! Upright: both rods at exactly 180 degrees, where the pendulum would stand for ever if the number pi could be held.

use double_pendulum::{DirectionF32, Error, Real, Run, State};

use crate::config::{DT, HALF_PIXEL, STEPS_PER_TICK};
use crate::graphics::{Anchor, Canvas, FadeLayer, LINE, LOWEST, Place, RodDirections, TRACE_HALF_WIDTH, View, text};
use crate::motion::{Energy, Means, Settings};
use crate::scenes::{Report, Scene, scene};

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
    /// The time of the last right frame; infinity as long as all are.
    horizon: f32,
}

impl Upright {
    /// Whether the plain motion is no longer shown where the compensated one is.
    fn have_parted(&self) -> bool {
        let [left, _] = &self.views;
        let [plain, compensated] = [self.plain_directions, self.compensated.directions()].map(|to| left.bobs(to));
        let is_near = |((x, y), (exact_x, exact_y)): ((f32, f32), (f32, f32))| {
            let (dx, dy) = (x - exact_x, y - exact_y);
            dx * dx + dy * dy <= HALF_PIXEL * HALF_PIXEL
        };
        !plain.into_iter().zip(compensated).all(is_near)
    }
}

fn directions(state: &State<f32>) -> RodDirections {
    state.angles().map(|angle| angle.own_sin_cos().into())
}

impl Scene for Upright {
    fn new(settings: &Settings, _: &Means) -> Result<Self, Error> {
        let (pendulum, plain) = settings.start()?;
        pendulum.check_step(DT)?;
        let compensated = pendulum.run(&plain, DT)?;
        let (plain_directions, horizon, ticks) = (directions(&plain), f32::INFINITY, 0);
        let view = |place, directions| View::new(&settings.parameters, place, directions);
        let [left, right] = Place::HALVES;
        let views = [view(left, plain_directions), view(right, compensated.directions())];
        let energy = Energy::new(pendulum, plain_directions, &plain);
        Ok(Self { plain, plain_directions, compensated, energy, ticks, views, horizon })
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        for _ in 0..STEPS_PER_TICK {
            self.plain = self.energy.pendulum.step(&self.plain, DT as f32);
        }
        self.plain_directions = directions(&self.plain);
        // One that is lost stands still.
        let _stays = self.compensated.advance(STEPS_PER_TICK);
        if self.horizon.is_infinite() && self.have_parted() {
            self.horizon = scene::time(self.ticks) as f32;
        }
        self.ticks = self.ticks.wrapping_add(1);
        let [left, right] = &mut self.views;
        left.trace(self.plain_directions, ink, TRACE_HALF_WIDTH, u8::MAX);
        right.trace(self.compensated.directions(), ink, TRACE_HALF_WIDTH, u8::MAX);
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.views.iter().for_each(|view| view.draw(canvas, u8::MAX));
        text::write(canvas, "plain", Anchor::TopLeft);
        text::write(canvas, "compensated", Anchor::TopRight);
        scene::draw_clock(canvas, report, Anchor::Middle(LINE + 1), Anchor::Middle(LOWEST));
    }

    fn report(&self) -> Report {
        let (energy_error, horizon) = (self.energy.error(self.plain_directions, &self.plain), self.horizon);
        Report { state: self.plain, energy_error, horizon, ..Report::of_figure(self.ticks) }
    }
}
