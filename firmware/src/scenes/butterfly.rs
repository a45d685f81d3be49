//! The butterfly: twins that start a millionth of a radian apart, and how that grows.

use double_pendulum::{Error, Pendulum};

use crate::brush::{SUBPIXELS, Spot, Stroke};
use crate::canvas::{Canvas, WIDTH};
use crate::compensated::Compensated;
use crate::config::{STEP, STEP_RATE, STEPS_PER_TICK, TICK_RATE};
use crate::ink::Ink;
use crate::label;
use crate::plot::{self, Strip};
use crate::scene::{Report, Scene};
use crate::settings::Settings;
use crate::text::{self, Anchor};
use crate::trust::{self, Trust};
use crate::view::{Place, View};

/// Angle 1 of the second twin ahead of the first's at the start, rad.
const APART: f32 = 1e-6;
/// The plot takes the right half but for a gap, columns.
const PLOT_COLUMNS: usize = 60;
const PLOT_LEFT: i32 = (WIDTH - PLOT_COLUMNS) as i32;
/// The row of e-folding 0, and pixels per e-folding: ln(2 pi/1e-6) = 15.7 is as far apart as twins can get.
const ZERO_ROW: f32 = 62.0;
const SCALE: f32 = 3.0;
const AXIS_GREY: u8 = 3;
const CURVE: u8 = 255;
/// The plot holds 60 columns of a quarter of a second: 15 s.
const TICKS_PER_COLUMN: u32 = TICK_RATE / 4;
/// Half the width of the first twin's trace, subpixels.
const HALF_WIDTH: u8 = 30;
/// Brightness of the second twin, of 255.
const SECOND: u8 = 110;

/// Both pendulums at one pivot, and the e-foldings of their separation over time.
///
/// A millionth of a radian is 4 of the last digits that an `f32` angle of 2 rad has, and rounding would soon hide
/// it; so the twins move in compensated arithmetic.
#[derive(Clone, Debug)]
pub struct Butterfly {
    pendulum: Pendulum<f32>,
    view: View,
    twins: [Compensated; 2],
    start_energy: f32,
    ticks: u32,
    trust: Trust,
    bobs: [Spot; 2],
    ink: Ink,
    strip: Strip<1, PLOT_COLUMNS>,
}

impl Butterfly {
    /// ln(separation/[`APART`]), the separation being the distance of the twins in the plane of the angles.
    fn e_foldings(&self) -> f32 {
        let [first, second] = &self.twins;
        let [d1, d2] = second.ahead_of(first).map(|apart| apart / APART);
        libm::logf(libm::sqrtf(d1 * d1 + d2 * d2).max(f32::MIN_POSITIVE))
    }

    fn time(&self) -> f64 {
        f64::from(self.ticks) / f64::from(TICK_RATE)
    }
}

impl Scene for Butterfly {
    fn new(settings: &Settings) -> Result<Self, Error> {
        let pendulum = settings.pendulum()?;
        pendulum.check_step(STEP)?;
        let start = settings.start(&pendulum)?;
        let view = View::new(&settings.parameters, Place::HALVES[0]);
        let first = Compensated::new(start);
        let bobs = view.spots(&pendulum, &start);
        let mut scene = Self {
            view,
            twins: [first, first.moved([APART, 0.0, 0.0, 0.0])],
            start_energy: pendulum.energy(&start),
            pendulum,
            ticks: 0,
            trust: Trust::new(start),
            bobs,
            ink: Ink::default(),
            strip: Strip::default(),
        };
        scene.strip.push([plot::height(0.0, ZERO_ROW, SCALE)]);
        Ok(scene)
    }

    fn tick(&mut self) {
        for twin in &mut self.twins {
            for _ in 0..STEPS_PER_TICK {
                *twin = twin.step(|z| self.pendulum.derivatives(z), STEP);
            }
        }
        self.ticks = self.ticks.wrapping_add(1);
        let [first, _] = self.twins;
        let shown = self.view.bobs(&self.pendulum, &first.state());
        let bobs = shown.map(|(x, y)| Spot::at(x, y));
        let ([_, from], [_, to]) = (self.bobs, bobs);
        self.ink.add(Stroke { from, to, radius: HALF_WIDTH });
        self.ink.tick();
        self.bobs = bobs;
        let places = |state: &_| self.view.bobs(&self.pendulum, state);
        let mut trust = self.trust;
        trust.tick(self.time(), shown, |z| self.pendulum.derivatives(z), places);
        self.trust = trust;
        if self.ticks.is_multiple_of(TICKS_PER_COLUMN) {
            self.strip.push([plot::height(self.e_foldings(), ZERO_ROW, SCALE)]);
        }
    }

    fn draw(&self, canvas: &mut Canvas) {
        canvas.clone_from(self.ink.picture());
        let [_, second] = &self.twins;
        self.view.draw(canvas, self.view.spots(&self.pendulum, &second.state()), SECOND);
        self.view.draw(canvas, self.bobs, u8::MAX);
        for e_foldings in [0.0, 5.0, 10.0, 15.0] {
            let row = i32::from(plot::height(e_foldings, ZERO_ROW, SCALE)) / SUBPIXELS;
            plot::axis(canvas, PLOT_LEFT, WIDTH as i32, row, AXIS_GREY);
        }
        self.strip.each(PLOT_LEFT + self.strip.columns() - 1, |x, &[now], &[before]| {
            plot::column(canvas, x, before, now, CURVE);
        });
        trust::draw_clock(canvas, self.time(), self.trust.until(), Anchor::TopLeft, Anchor::At(36, 0));
        text::write(canvas, &label::tenths(self.e_foldings(), ""), Anchor::TopRight);
        text::write(canvas, "e-folds", Anchor::At(PLOT_LEFT, 0));
    }

    fn report(&self) -> Report {
        let state = self.twins[0].state();
        let scale = self.start_energy - self.pendulum.least_energy();
        let change = self.pendulum.energy(&state) - self.start_energy;
        Report {
            step: self.ticks.wrapping_mul(STEP_RATE / TICK_RATE),
            time: self.time(),
            state,
            energy_error: if scale > 0.0 { change / scale } else { 0.0 },
            trusted_until: self.trust.until(),
        }
    }
}
