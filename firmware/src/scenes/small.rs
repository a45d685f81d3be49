//! Figures 3 to 5 of the page: small oscillations in closed form. Both angles are scrolling curves
//! within their envelopes.

use double_pendulum::plan::Stepping;
use double_pendulum::{Error, Method, Modes, Parameters, Pendulum, SmallOscillations, sin_cos};

use crate::config::{PAGE_GRAVITY, TICK_RATE};
use crate::graphics::{Anchor, Canvas, Fading, Format, Height, SUBPIXELS, label, plot, text};
use crate::motion::{Resources, Settings};
use crate::scenes::{Report, Scene, Shows, draw_clock, time};

/// The approximate number of exchanges of energy between the rods in the width of a plot.
const EXCHANGES: f32 = 110.0 / 60.0;
/// The smallest length of the scale bar for time, units.
const LEAST_BAR: i32 = 16;
/// The width of the dark gap in front of the newest column of a sweep, units.
const SWEEP_GAP: i32 = 4;
const ENVELOPE_GREY: u8 = 5;

#[derive(Clone, Copy, Debug)]
struct Layout {
    /// The rows of angle 0 for angle 1 and angle 2, pixels from the top, and the largest swing
    /// about them.
    rows: [f32; 2],
    swing: f32,
    left: i32,
    columns: i32,
}

impl Layout {
    fn of(format: Format) -> Self {
        let top = format.units(9) as f32;
        let bottom = format.lowest() as f32;
        let quarter = 0.25 * (bottom - top);
        let left = format.units(18);
        Self {
            rows: [top + quarter, bottom - quarter],
            swing: quarter - format.units(1) as f32,
            left,
            columns: format.right() - left,
        }
    }
}

/// The method of the scene. It shows the linear model, and does not follow the plan.
const CLOSED_FORM: Stepping = Stepping {
    method: Method::ClosedFormF32,
    steps: 1,
};

/// Returns the worked example of the page.
pub fn example(mass_ratio: f64) -> Settings {
    let parameters = Parameters::equal_rods(mass_ratio, 0.25, PAGE_GRAVITY);
    Settings {
        parameters,
        degrees: [0.0, 30.0],
        velocities: [0.0; 2],
    }
}

/// The two angles over time, by the linear model. On an OLED the curves scroll. On a larger panel,
/// where that would take half of a tick, the newest column replaces the oldest one, as on an
/// oscilloscope. The horizon that is shown with the time is the time until which the exact motion
/// has the same angles, to half a pixel of the curves. A requested method is ignored.
#[derive(Clone, Debug)]
pub struct Small {
    pendulum: Pendulum<f32>,
    motion: SmallOscillations<f32>,
    /// The amplitudes of the fast and the slow mode in angle 1 and in angle 2, rad. They have the
    /// same sign if the modes are in phase.
    amplitudes: [[f32; 2]; 2],
    /// The differences of the modes: w1 - w2, turns per second, and f1 - f2, rad.
    exchange: f64,
    phase: f32,
    /// Pixels per radian.
    scale: f32,
    ticks_per_column: u32,
    layout: Layout,
    /// The next column of a sweep, from the left of the plot.
    next: i32,
    ends: Option<[Height; 2]>,
}

impl Small {
    /// The amplitude of C1 cos(w1 t + f1) + C2 cos(w2 t + f2) is sqrt(C1^2 + C2^2 + 2 C1 C2 cos((w1
    /// - w2) t + f1 - f2)).
    fn envelopes(&self, t: f64) -> [f32; 2] {
        // Reduced in 64 bits, in which turns are accurate for hours.
        let turns = self.exchange * t;
        let exchanged = (turns - libm::rint(turns)) as f32 * core::f32::consts::TAU;
        let phase = exchanged + self.phase;
        let (_, cos) = sin_cos(phase);
        self.amplitudes
            .map(|[c1, c2]| libm::sqrtf((c1 * c1 + c2 * c2 + 2.0 * c1 * c2 * cos).max(0.0)))
    }

    fn extend(&mut self, time: f64, ink: &mut Canvas) {
        let Layout {
            rows: [row1, row2],
            left,
            columns,
            ..
        } = self.layout;
        let unit = ink.format.units(1);
        let mut x = left + columns - 1;
        if ink.format.is_large() {
            if self.next >= columns {
                self.next = 0;
            }
            x = left + self.next;
            let end = left + columns;
            let gap = ink.format.units(SWEEP_GAP);
            ink.clear_columns(x..(x + gap).min(end));
            // At the right edge the gap continues at the left one.
            ink.clear_columns(left..left + (x + gap - end).max(0));
            if x == left {
                self.ends = None;
            }
            self.next += 1;
        } else {
            ink.scroll(left);
        }
        let height = |(angle, row): (f32, f32)| plot::height(angle, row, self.scale);

        // Each envelope has a point above and one below.
        let [envelope1, envelope2] = self.envelopes(time);
        for envelope in [(envelope1, row1), (envelope2, row2)] {
            let mirrored =
                plot::height(0.0, 2.0 * envelope.1, 0.0).saturating_sub(height(envelope));
            for height in [height(envelope), mirrored] {
                let top = i32::from(height).div_euclid(SUBPIXELS);
                ink.lighten(x..x + 1, top..top + unit, ENVELOPE_GREY);
            }
        }

        // The curves.
        let [a1, a2] = self.motion.at(time).angles();
        let heights = [(a1, row1), (a2, row2)].map(height);
        for (before, now) in self.ends.unwrap_or(heights).into_iter().zip(heights) {
            plot::column(ink, x, before, now, u8::MAX);
        }
        self.ends = Some(heights);
    }
}

/// Returns the height, pixels, of the picture that the scene is planned for. In this picture of
/// both rods, a bob is half a pixel off if the curve of its angle is half a pixel off.
///
/// The curve is off by half a pixel if the angle is off by 1/(2 `scale`). The bob of a rod of
/// length l is then off by the chord 2 l sin(1/(4 `scale`)). A picture of this height shows 2 l in
/// half its height, for equal rods.
fn planned_height(scale: f32) -> f32 {
    let half_angle = (0.25 / scale).min(core::f32::consts::FRAC_PI_2);
    1.0 / libm::sinf(half_angle)
}

impl Scene for Small {
    const SHOWS: Shows = Shows::LinearMotion;
    const FADING: Fading = Fading::NEVER;

    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        settings.start()?;
        let pendulum = Pendulum::new(&settings.parameters.cast())?;
        let modes = Modes::new(&settings.parameters)?;
        let motion = SmallOscillations::<f32>::new(modes, &settings.motion().cast());

        // The amplitudes, and the largest value of an angle, rad.
        let [c1, c2] = motion.amplitudes();
        let amplitudes = [
            [c1, c2],
            [modes.fast.shape as f32 * c1, modes.slow.shape as f32 * c2],
        ];
        let greatest = amplitudes
            .map(|[c1, c2]| c1.abs() + c2.abs())
            .into_iter()
            .fold(0.0, f32::max);

        // The scales.
        let layout = Layout::of(resources.format);
        let columns_per_exchange = layout.columns as f32 / EXCHANGES;
        let [fast_phase, slow_phase] = motion.phases();
        let exchange = core::f32::consts::TAU / modes.exchange() as f32;
        let ticks_per_column = (exchange * TICK_RATE as f32 / columns_per_exchange) as u32;
        let scale = if greatest > 0.0 {
            layout.swing / greatest
        } else {
            0.0
        };
        let scene = Self {
            pendulum,
            amplitudes,
            exchange: modes.exchange() / core::f64::consts::TAU,
            phase: fast_phase - slow_phase,
            motion,
            scale,
            ticks_per_column: ticks_per_column.max(1),
            layout,
            next: 0,
            ends: None,
        };
        Ok((scene, (scale > 0.0).then(|| planned_height(scale))))
    }

    fn tick(&mut self, ticks: u64, ink: &mut Canvas) {
        if self.ends.is_none() {
            self.extend(0.0, ink);
        }
        if ticks.is_multiple_of(self.ticks_per_column.into()) {
            self.extend(time(ticks), ink);
        }
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let format = canvas.format;
        let units = |units| format.units(units);
        let lowest = format.lowest();
        let Layout {
            rows, swing, left, ..
        } = self.layout;

        // The axes, with their names and the largest angle.
        let greatest = if self.scale > 0.0 {
            (swing / self.scale).to_degrees()
        } else {
            0.0
        };
        let bar = left - units(1);
        let name_end = left - units(2);
        let swing = swing as i32;
        for (row, name) in rows.map(|row| row as i32).into_iter().zip(["α₁", "α₂"]) {
            plot::axis(canvas, left, format.right(), row);
            plot::bar(canvas, (bar, row - swing), (bar, row + swing));
            let middle = Anchor::EndingAt(name_end, row - format.line() / 2);
            text::write(canvas, name, middle);
            let top = Anchor::EndingAt(name_end, row - swing);
            text::write(canvas, &label::label("", greatest, 0, "°"), top);
        }

        // A scale bar as long as a round time.
        let columns_per_second = TICK_RATE as f32 / self.ticks_per_column as f32;
        let seconds = plot::scale_step(units(LEAST_BAR) as f32 / columns_per_second);
        let end = left + (seconds * columns_per_second) as i32;
        let row = lowest + format.line() / 2;
        plot::bar(canvas, (left, row), (end, row));
        let at = Anchor::At(end + units(4), lowest);
        text::write(canvas, &label::tick(seconds, " s"), at);

        // The mass ratio, and the model.
        let mass_ratio = label::mass_ratio(self.pendulum.parameters().mass_ratio());
        text::write(canvas, &mass_ratio, Anchor::Left(0));
        let model = if format.is_large() {
            Anchor::At(units(37), 0)
        } else {
            Anchor::Middle(0)
        };
        text::write(canvas, "linear", model);
        draw_clock(canvas, report, Anchor::Right(lowest), Anchor::Right(0));
    }

    fn report(&self, ticks: u64) -> Report {
        let state = self.pendulum.to_state(&self.motion.at(time(ticks)));
        // The energy of the linear motion contains no information about its arithmetic.
        Report {
            state,
            stepping: Some(CLOSED_FORM),
            ..Report::at(ticks)
        }
    }
}
