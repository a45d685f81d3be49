//! The butterfly effect: two pendulums that start a millionth of a radian apart, and the growth of
//! their separation.

use double_pendulum::Error;
use double_pendulum::plan::PlannedRun;
use heapless::Deque;

use crate::config::{Processor, TICK_RATE};
use crate::graphics::{
    Anchor, Canvas, FadeLayer, Height, LINE, LOWEST, Place, SUBPIXELS, TRACE_HALF_WIDTH, View,
    WIDTH, label, plot, text,
};
use crate::motion::{Resources, Settings, Simulation};
use crate::scenes::{Report, Scene, Shows, draw_clock};

/// The initial difference of angle 1 between the second pendulum and the first, rad.
const APART: f64 = 1e-6;
/// The width of the plot, columns: the right half without a gap.
const PLOT_COLUMNS: usize = 60;
const PLOT_LEFT: i32 = (WIDTH - PLOT_COLUMNS) as i32;
/// The row of e-folding 0, and the number of pixels per e-folding. The largest possible separation
/// is ln(sqrt 2 pi/1e-6) = 15.3 e-foldings.
const ZERO_ROW: f32 = 53.0;
const SCALE: f32 = 2.6;
/// The rows of the scale, and their labels.
const AXES: [(i32, &str); 4] = [
    (row(0.0), "0"),
    (row(5.0), "5"),
    (row(10.0), "10"),
    (row(15.0), "15"),
];
/// The number of columns per second. The 60 columns of the plot are 15 s.
const COLUMNS_PER_SECOND: u64 = 4;
const TICKS_PER_COLUMN: u64 = TICK_RATE as u64 / COLUMNS_PER_SECOND;
/// The brightness of the second pendulum, of 255.
const SECOND: u8 = 110;

/// Returns the row of this number of e-foldings.
const fn row(e_foldings: f32) -> i32 {
    plot::height(e_foldings, ZERO_ROW, SCALE) as i32 / SUBPIXELS
}

/// Two pendulums at one pivot, and the e-foldings of their separation over time: ln(separation/1e-6
/// rad), 0 at the start. The separation is the distance in the plane of both angles, without whole
/// turns. The plot has four values per second, and shows the last 15 s. The largest possible
/// separation, 15.3 e-foldings, is in the plot; one below 1e-6 rad is drawn below its zero line, or
/// not at all. The first pendulum is bright and leaves a trace; angle 1 of the second starts 1e-6
/// rad larger, at the same angular velocities.
///
/// Both use the initial method, the most accurate one within half the budget of a frame, or the
/// method that the user has selected. The plan does not change it: a method that is accurate to
/// half a pixel can be off by far more than a millionth of a radian, and would soon hide the growth
/// of the separation. The scene refuses what [`Simulation::new`] refuses, among it a user's method
/// that costs more than half the budget.
#[derive(Clone, Debug)]
pub struct Butterfly {
    first: Simulation,
    second: PlannedRun,
    views: [View; 2],
    /// The curve in the plot, the oldest value first.
    strip: Deque<Height, PLOT_COLUMNS>,
}

impl Butterfly {
    /// Returns the distance of the two motions in the plane of the angles, rad. Whole turns are not
    /// counted, so that it is at most sqrt(2) pi.
    fn separation(&self) -> f64 {
        let first = self.first.motion.state();
        let second = self.second.state();
        let turn = core::f64::consts::TAU;

        let [d1, d2] = [second.a1 - first.a1, second.a2 - first.a2]
            .map(|apart| apart - turn * libm::rint(apart / turn));
        libm::sqrt(d1 * d1 + d2 * d2)
    }

    /// Appends the separation to the plot.
    fn put_down(&mut self) {
        let ratio = (self.separation() / APART) as f32;
        let e_foldings = libm::logf(ratio.max(f32::MIN_POSITIVE));
        if self.strip.is_full() {
            self.strip.pop_front();
        }
        let _there_is_room = self
            .strip
            .push_back(plot::height(e_foldings, ZERO_ROW, SCALE));
    }
}

impl Scene for Butterfly {
    const SHOWS: Shows = Shows::Motion;
    // With all scenes inlined, `play_by` has a stack frame of 7,604 bytes.
    #[inline(never)]
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        // A frame pays for both motions.
        let &Resources { processor, method } = resources;
        let each = Processor {
            frame: 0.5 * processor.frame,
            ..processor
        };
        let resources = Resources {
            processor: each,
            method,
        };
        let first = Simulation::new(settings, &resources)?;
        let second = settings.run(APART, first.motion.stepping())?;

        let views = [first.motion.directions(), second.directions()]
            .map(|directions| View::new(&settings.parameters, Place::HALVES[0], directions));
        let mut scene = Self {
            first,
            second,
            views,
            strip: Deque::new(),
        };
        scene.put_down();
        Ok((scene, Some(2.0 * Place::HALVES[0].reach)))
    }

    fn tick(&mut self, ticks: u64, ink: &mut FadeLayer) {
        self.first.tick();
        let _is_lost = self.second.advance(1);
        let [first, second] = &mut self.views;

        first.trace(
            self.first.motion.directions(),
            ink,
            TRACE_HALF_WIDTH,
            u8::MAX,
        );
        second.turn(self.second.directions());

        if ticks.is_multiple_of(TICKS_PER_COLUMN) {
            self.put_down();
        }
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let [first, second] = &self.views;
        second.draw(canvas, SECOND);
        first.draw(canvas, u8::MAX);

        for (row, e_foldings) in AXES {
            plot::axis(canvas, PLOT_LEFT, WIDTH as i32, row);
            text::write(
                canvas,
                e_foldings,
                Anchor::EndingAt(PLOT_LEFT, row - LINE / 2),
            );
        }

        // The curve.
        let mut before = self.strip.front();
        for (x, now) in (PLOT_LEFT..).zip(&self.strip) {
            plot::column(canvas, x, *before.unwrap_or(now), *now, u8::MAX);
            before = Some(now);
        }

        // The times at both ends of the plot.
        let span = (PLOT_COLUMNS as u64 / COLUMNS_PER_SECOND) as f32;
        let end = (report.time as f32).max(span);
        text::write(
            canvas,
            &label::tick(end - span, ""),
            Anchor::At(PLOT_LEFT, LOWEST),
        );
        text::write(canvas, &label::tick(end, " s"), Anchor::Right(LOWEST));
        text::write(canvas, "e-folds", Anchor::Right(0));
        draw_clock(canvas, report, Anchor::Left(0), Anchor::Middle(0));
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.first)
    }

    fn is_too_fast(&self) -> bool {
        self.first.is_too_fast
    }
}
