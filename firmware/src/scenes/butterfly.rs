//! The butterfly: two pendulums that start a millionth of a radian apart, and how that grows.

use double_pendulum::{Error, State};

use crate::config::{DT, STEPS_PER_SECOND, STEPS_PER_TICK};
use crate::graphics::brush::{SUBPIXELS, Spot, Stroke};
use crate::graphics::canvas::{Canvas, WIDTH};
use crate::graphics::fade_layer::FadeLayer;
use crate::graphics::label;
use crate::graphics::plot::{self, Strip};
use crate::graphics::text::{self, Anchor, LINE, LOWEST};
use crate::graphics::view::{Place, View};
use crate::motion::direction_stepper::DirectionStepper;
use crate::motion::planner::Shown;
use crate::motion::settings::Settings;
use crate::motion::simulation::Simulation;
use crate::scenes::horizon::{self, AccuracyHorizon};
use crate::scenes::scene::{Report, Scene};

/// Angle 1 of the second twin ahead of the first's at the start, rad.
const APART: f32 = 1e-6;
/// The plot takes the right half but for a gap, columns.
const PLOT_COLUMNS: usize = 60;
const PLOT_LEFT: i32 = (WIDTH - PLOT_COLUMNS) as i32;
/// The row of e-folding 0, and pixels per e-folding: ln(sqrt 2 pi/1e-6) = 15.3 is as far apart as twins can get.
const ZERO_ROW: f32 = 53.0;
const SCALE: f32 = 2.6;
const CURVE: u8 = 255;
/// The plot holds 60 columns of a quarter of a second: 15 s.
const COLUMNS_PER_SECOND: u64 = 4;
const STEPS_PER_COLUMN: u64 = STEPS_PER_SECOND as u64 / COLUMNS_PER_SECOND;
/// Half the width of the first twin's trace, subpixels.
const HALF_WIDTH: u8 = 30;
/// Brightness of the second twin, of 255.
const SECOND: u8 = 110;

/// Both pendulums at one pivot, and the e-foldings of their separation over time.
///
/// A millionth of a radian is 4 of the last digits that an `f32` angle of 2 rad has, and rounding would soon hide
/// it; the direction form carries what each addition loses.
#[derive(Clone, Debug)]
pub struct Butterfly {
    first: Simulation,
    second: DirectionStepper,
    view: View,
    /// The twins' separation at the start, rad: [`APART`] as far as the digits of an `f32` angle allow.
    apart: f64,
    /// ln(separation/`apart`), as last put down.
    e_foldings: f32,
    horizon: AccuracyHorizon,
    bobs: [Spot; 2],
    strip: Strip<PLOT_COLUMNS>,
}

impl Butterfly {
    /// The distance of the twins in the plane of the angles, rad; whole turns do not count.
    fn separation(&mut self) -> f64 {
        let ([first, second], turn) = ([self.first.precise_state(), self.second.state()], core::f64::consts::TAU);
        let [d1, d2] =
            [second.a1 - first.a1, second.a2 - first.a2].map(|apart| apart - turn * libm::rint(apart / turn));
        libm::sqrt(d1 * d1 + d2 * d2)
    }

    fn put_down(&mut self) {
        let ratio = (self.separation() / self.apart) as f32;
        self.e_foldings = libm::logf(ratio.max(f32::MIN_POSITIVE));
        self.strip.push(plot::height(self.e_foldings, ZERO_ROW, SCALE));
    }
}

impl Scene for Butterfly {
    fn new(settings: &Settings) -> Result<Self, Error> {
        let first = Simulation::new(settings)?;
        let start = first.state();
        let beside = State { a1: start.a1 + APART, ..start };
        let view = View::new(&settings.parameters, Place::HALVES[0]);
        let mut scene = Self {
            second: DirectionStepper::new(&settings.parameters, &beside, DT)?,
            horizon: AccuracyHorizon::new(&settings.parameters, &start)?,
            bobs: view.spots(first.directions()),
            first,
            view,
            apart: f64::from(beside.a1) - f64::from(start.a1),
            e_foldings: 0.0,
            strip: Strip::default(),
        };
        scene.put_down();
        Ok(scene)
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        self.first.tick();
        self.second.advance(STEPS_PER_TICK);
        let shown = self.view.bobs(self.first.directions());
        let bobs = shown.map(|(x, y)| Spot::at(x, y));
        let ([_, from], [_, to]) = (self.bobs, bobs);
        ink.add(Stroke { from, to, radius: HALF_WIDTH }, u8::MAX);
        self.bobs = bobs;
        self.horizon.tick(self.first.time(), shown, |directions| self.view.bobs(directions));
        if self.first.step().is_multiple_of(STEPS_PER_COLUMN) {
            self.put_down();
        }
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.view.draw(canvas, self.view.spots(self.second.directions()), SECOND);
        self.view.draw(canvas, self.bobs, u8::MAX);
        for e_foldings in [0.0, 5.0, 10.0, 15.0] {
            let row = i32::from(plot::height(e_foldings, ZERO_ROW, SCALE)) / SUBPIXELS;
            plot::axis(canvas, PLOT_LEFT, WIDTH as i32, row);
            text::write(canvas, &label::tick(e_foldings, ""), Anchor::EndingAt(PLOT_LEFT, row - LINE / 2));
        }
        self.strip.draw(canvas, PLOT_LEFT, CURVE);
        let span = (PLOT_COLUMNS as u64 / COLUMNS_PER_SECOND) as f32;
        let end = (self.first.time() as f32).max(span);
        text::write(canvas, &label::tick(end - span, ""), Anchor::At(PLOT_LEFT, LOWEST));
        text::write(canvas, &label::tick(end, " s"), Anchor::BottomRight);
        text::write(canvas, "e-folds", Anchor::TopRight);
        horizon::draw_clock(canvas, report, Anchor::TopLeft, Anchor::Centred(WIDTH as i32 / 2, 0));
    }

    fn report(&self) -> Report {
        Report::of(&self.first, self.horizon.until())
    }

    fn shown(&self) -> Option<Shown> {
        Shown::pendulum(Place::HALVES[0].reach)
    }
}
