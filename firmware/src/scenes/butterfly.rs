//! The butterfly effect: two pendulums that start a millionth of a radian apart, and the growth of
//! their separation.

use double_pendulum::Error;
use double_pendulum::plan::{Costs, PlannedRun};
use heapless::Deque;

use crate::config::{Processor, TICK_RATE};
use crate::graphics::{
    Anchor, Canvas, Format, Height, Palette, Place, TRACE_HALF_WIDTH, View, label, plot, text,
};
use crate::motion::{Resources, Settings, Simulation};
use crate::scenes::{Report, Scene, Shows, draw_clock};

/// The initial difference of angle 1 between the second pendulum and the first, rad.
const APART: f64 = 1e-6;
/// The number of values in the plot.
const VALUES: usize = 60;
/// The e-foldings with an axis, and their labels. The largest possible separation is ln(sqrt 2
/// pi/1e-6) = 15.3 e-foldings.
const AXES: [(f32, &str); 4] = [(0.0, "0"), (5.0, "5"), (10.0, "10"), (15.0, "15")];
/// The largest number of e-foldings in the plot.
const GREATEST: f32 = 15.5;
/// The number of values per second. The 60 values of the plot are 15 s.
const VALUES_PER_SECOND: u64 = 4;
const TICKS_PER_VALUE: u64 = TICK_RATE as u64 / VALUES_PER_SECOND;
/// The cost of the second pendulum's picture, in steps by RK4 in `f32`, estimated on a Cortex-M3. A
/// Cortex-M0+ without it was late at mass ratio 100.
const PICTURE: f32 = 2.0;
/// The brightness of the second pendulum, of 255.
const SECOND: u8 = 110;

/// The places of the pendulums, the plot and the words.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// The place of both pendulums.
    pub place: Place,
    /// The first column of the plot; its last is that of the panel.
    left: i32,
    /// The row of e-folding 0, and the number of pixels per e-folding.
    zero: f32,
    scale: f32,
    /// The places of the time, of the horizon, and of the name of the plot.
    time: Anchor,
    trust: Anchor,
    name: Anchor,
}

impl Layout {
    /// Returns the layout for a panel: the plot at the right of the pendulums or, on a tall one,
    /// below them.
    pub fn of(format: Format) -> Self {
        let width = format.right();
        let height = format.bottom();
        let zero = (height - format.units(11)) as f32;

        if format.is_tall() {
            // The pendulums are above the middle, below a line of text.
            let top = format.units(9);
            let radius = (0.5 * height as f32 - top as f32) / 2.0;
            let pivot = (0.5 * width as f32, top as f32 + radius);
            let above_plot = height / 2 - format.line();
            return Self {
                place: Place::within(radius, pivot, format),
                left: format.units(11),
                zero,
                scale: (zero - 0.5 * height as f32 - format.units(4) as f32) / GREATEST,
                time: Anchor::Left(0),
                trust: Anchor::Right(0),
                name: Anchor::Left(above_plot),
            };
        }

        let [place, _] = Place::halves(format);
        Self {
            place,
            left: width / 2 + format.units(4),
            zero,
            scale: if format.is_large() {
                (zero - format.units(12) as f32) / GREATEST
            } else {
                2.6
            },
            time: Anchor::Left(0),
            trust: if format.is_large() {
                Anchor::Left(format.lowest())
            } else {
                Anchor::Middle(0)
            },
            name: Anchor::Right(0),
        }
    }
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
    layout: Layout,
    /// The curve in the plot, the oldest value first.
    strip: Deque<Height, VALUES>,
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
        let Layout { zero, scale, .. } = self.layout;
        let height = plot::height(e_foldings, zero, scale);
        let _there_is_room = self.strip.push_back(height);
    }
}

impl Scene for Butterfly {
    const SHOWS: Shows = Shows::Motion;
    const PALETTE: Palette = Palette::Two;
    // With all scenes inlined, `play_by` has a stack frame of 7,604 bytes.
    #[inline(never)]
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        // A frame pays for both motions.
        let &Resources {
            processor,
            method,
            format,
        } = resources;
        let each = Processor {
            frame: 0.5 * processor.frame,
            ..processor
        };
        let resources = Resources {
            processor: each,
            method,
            format,
        };
        let first = Simulation::new(settings, &resources)?;
        let second = settings.run(APART, first.motion.stepping())?;

        let layout = Layout::of(format);
        let views = [first.motion.directions(), second.directions()]
            .map(|directions| View::new(&settings.parameters, layout.place, directions));
        let mut scene = Self {
            first,
            second,
            views,
            layout,
            strip: Deque::new(),
        };
        scene.put_down();
        Ok((scene, Some(2.0 * layout.place.reach)))
    }

    fn tick(&mut self, ticks: u64, ink: &mut Canvas) {
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

        if ticks.is_multiple_of(TICKS_PER_VALUE) {
            self.put_down();
        }
    }

    fn cost(&self, costs: &Costs) -> f32 {
        2.0 * self.first.cost(costs)
    }

    fn other_cost(&self, costs: &Costs) -> f32 {
        PICTURE * costs.direction
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let [first, second] = &self.views;
        second.draw(canvas, SECOND);
        first.draw(canvas, u8::MAX);

        let Layout {
            left,
            zero,
            scale,
            time,
            trust,
            name,
            ..
        } = self.layout;
        let format = canvas.format;
        let lowest = format.lowest();
        let columns = format.right() - left;
        for (e_foldings, label) in AXES {
            let row = (zero - scale * e_foldings) as i32;
            plot::axis(canvas, left, format.right(), row);
            let at = Anchor::EndingAt(left, row - format.line() / 2);
            text::write(canvas, label, at);
        }

        // The curve. Between two values it is straight.
        let column = |value: usize| left + (value as i32 * columns) / VALUES as i32;
        let mut before = self.strip.front();
        for (value, now) in self.strip.iter().enumerate() {
            let from = i32::from(*before.unwrap_or(now));
            let rise = i32::from(*now) - from;
            let first = column(value);
            let count = column(value + 1) - first;
            let height = |part: i32| (from + rise * part / count.max(1)) as Height;
            for part in 0..count {
                plot::column(
                    canvas,
                    first + part,
                    height(part),
                    height(part + 1),
                    u8::MAX,
                );
            }
            before = Some(now);
        }

        // The times at both ends of the plot.
        let span = (VALUES as u64 / VALUES_PER_SECOND) as f32;
        let end = (report.time as f32).max(span);
        let start = Anchor::At(left, lowest);
        text::write(canvas, &label::tick(end - span, ""), start);
        text::write(canvas, &label::tick(end, " s"), Anchor::Right(lowest));
        text::write(canvas, "e-folds", name);
        draw_clock(canvas, report, time, trust);
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.first)
    }

    fn is_too_fast(&self) -> bool {
        self.first.is_too_fast
    }
}
