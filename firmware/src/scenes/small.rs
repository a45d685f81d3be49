//! Figures 3 to 5: small oscillations, both angles as scrolling curves within their envelopes, in closed form.

use double_pendulum::plan::Way;
use double_pendulum::{Error, Method, Modes, Motion, Oscillation, Parameters, Pendulum, Real, SmallOscillations};

use crate::config::{PAGE_GRAVITY, TICK_RATE};
use crate::graphics::{Anchor, Canvas, FadeLayer, Fading, Height, LINE, LOWEST, WIDTH, label, plot, text};
use crate::motion::{Means, Settings};
use crate::scenes::{Report, Scene, scene};

/// The rows of rest of angle 1 and angle 2, pixels from the top, and the greatest swing about them.
const ROWS: [f32; 2] = [20.5, 43.5];
const SWING: f32 = 10.5;
/// The plots begin right of their names and scales.
const LEFT: i32 = 18;
const RIGHT: i32 = WIDTH as i32 - 1;
/// An exchange of energy between the rods and back takes about this many columns.
const COLUMNS_PER_EXCHANGE: f32 = 60.0;
/// The bar that tells a length of time is at least this long, columns.
const LEAST_BAR: f32 = 16.0;
const CURVE: u8 = 255;
const ENVELOPE_GREY: u8 = 5;

/// The scene shows the linear model and does not follow the plan.
const CLOSED_FORM: Way = Way { method: Method::ClosedFormF32, steps: 1 };

/// The page's worked example: equal rods of 0.25 m, g = 9.8 m/s^2, a1 = 0, a2 = 30 degrees, let go from rest.
pub fn example(mass_ratio: f32) -> Settings {
    let parameters = Parameters::equal_rods(mass_ratio, 0.25, PAGE_GRAVITY as f32);
    Settings { parameters, degrees: [0.0, 30.0], velocities: [0.0; 2] }
}

/// Both angles over time, by the linear model. The clock says until when the exact motion has them there, too.
#[derive(Clone, Debug)]
pub struct Small {
    settings: Settings,
    pendulum: Pendulum<f32>,
    motion: SmallOscillations<f32>,
    envelopes: Envelopes,
    /// Pixels per radian.
    scale: f32,
    ticks_per_column: u32,
    ticks: u64,
    /// Where the curves end.
    ends: Option<[Height; 2]>,
}

impl Small {
    /// Scrolls the curves and their envelopes, and adds a column.
    fn extend(&mut self, ink: &mut Canvas) {
        ink.scroll(LEFT);
        let time = scene::time(self.ticks);
        let Motion { a1, a2, .. } = self.motion.at(time);
        let height = |(angle, row): (f32, f32)| plot::height(angle, row, self.scale);
        let [envelope1, envelope2] = self.envelopes.at(time);
        for envelope in [(envelope1, ROWS[0]), (envelope2, ROWS[1])] {
            let mirrored = plot::height(0.0, 2.0 * envelope.1, 0.0).saturating_sub(height(envelope));
            plot::dot(ink, RIGHT, height(envelope), ENVELOPE_GREY);
            plot::dot(ink, RIGHT, mirrored, ENVELOPE_GREY);
        }
        let heights = [(a1, ROWS[0]), (a2, ROWS[1])].map(height);
        for (before, now) in self.ends.unwrap_or(heights).into_iter().zip(heights) {
            plot::column(ink, RIGHT, before, now, CURVE);
        }
        self.ends = Some(heights);
    }

    /// Draws a bar as long as a round time, and says which.
    fn draw_seconds(&self, canvas: &mut Canvas) {
        let columns_per_second = TICK_RATE as f32 / self.ticks_per_column as f32;
        let time = plot::scale_step(LEAST_BAR / columns_per_second);
        let (end, row) = (LEFT + (time * columns_per_second) as i32, LOWEST + LINE / 2);
        plot::bar(canvas, (LEFT, row), (end, row));
        text::write(canvas, &label::tick(time, " s"), Anchor::At(end + 4, LOWEST));
    }
}

impl Scene for Small {
    const FADING: Fading = Fading::NEVER;

    fn new(settings: &Settings, _: &Means) -> Result<Self, Error> {
        let (pendulum, _) = settings.start()?;
        let modes = Modes::new(&settings.parameters.cast())?;
        let motion = SmallOscillations::new(modes, &settings.motion());
        let envelopes = Envelopes::new(&modes, &motion);
        let greatest = envelopes.greatest().into_iter().fold(0.0, f32::max);
        let exchange = core::f32::consts::TAU / modes.exchange() as f32;
        let ticks_per_column = (exchange * TICK_RATE as f32 / COLUMNS_PER_EXCHANGE) as u32;
        Ok(Self {
            settings: *settings,
            pendulum,
            motion,
            envelopes,
            scale: if greatest > 0.0 { SWING / greatest } else { 0.0 },
            ticks_per_column: ticks_per_column.max(1),
            ticks: 0,
            ends: None,
        })
    }

    fn tick(&mut self, ink: &mut FadeLayer) {
        if self.ends.is_none() {
            self.extend(&mut ink.frame);
        }
        self.ticks = self.ticks.wrapping_add(1);
        if self.ticks.is_multiple_of(self.ticks_per_column.into()) {
            self.extend(&mut ink.frame);
        }
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let greatest = if self.scale > 0.0 { (SWING / self.scale).to_degrees() } else { 0.0 };
        for (row, name) in ROWS.map(|row| row as i32).into_iter().zip(["α₁", "α₂"]) {
            let swing = SWING as i32;
            plot::axis(canvas, LEFT, WIDTH as i32, row);
            plot::bar(canvas, (LEFT - 1, row - swing), (LEFT - 1, row + swing));
            text::write(canvas, name, Anchor::EndingAt(LEFT - 2, row - LINE / 2));
            text::write(canvas, &label::label("", greatest, 0, "°"), Anchor::EndingAt(LEFT - 2, row - swing));
        }
        self.draw_seconds(canvas);
        text::write(canvas, &label::mass_ratio(self.settings.mass_ratio()), Anchor::TopLeft);
        text::write(canvas, "linear", Anchor::Middle(0));
        scene::draw_clock(canvas, report, Anchor::BottomRight, Anchor::TopRight);
    }

    fn report(&self) -> Report {
        let state = self.pendulum.to_state(&self.motion.at(scene::time(self.ticks)));
        Report { state, way: Some(CLOSED_FORM), ..Report::of_figure(self.ticks) }
    }

    fn height(&self) -> Option<f32> {
        (self.scale > 0.0).then_some(4.0 * self.scale)
    }
}

/// How far each angle can swing while its two modes beat: of C1 cos(w1 t + f1) + C2 cos(w2 t + f2) the amplitude is
/// sqrt(C1^2 + C2^2 + 2 C1 C2 cos((w1 - w2) t + f1 - f2)).
#[derive(Clone, Copy, Debug)]
struct Envelopes {
    /// Amplitudes of the fast and the slow mode in angle 1 and in angle 2, rad; of one sign if the modes are in phase.
    amplitudes: [[f32; 2]; 2],
    /// w1 - w2, turns per second.
    exchange: f64,
    /// f1 - f2, rad.
    phase: f32,
}

impl Envelopes {
    fn new(modes: &Modes<f64>, motion: &SmallOscillations<f32>) -> Self {
        let (fast, slow) = (motion.fast, motion.slow);
        let [c1, c2] = [fast, slow].map(|part: Oscillation<f32>| part.amplitude());
        let amplitudes = [[c1, c2], [modes.fast.shape as f32 * c1, modes.slow.shape as f32 * c2]];
        Self { amplitudes, exchange: modes.exchange() / core::f64::consts::TAU, phase: fast.phase() - slow.phase() }
    }

    /// The amplitudes of angle 1 and angle 2 at time `t`, rad.
    fn at(&self, t: f64) -> [f32; 2] {
        let turns = self.exchange * t;
        let exchanged = (turns - libm::rint(turns)) as f32 * core::f32::consts::TAU;
        let (_, cos) = (exchanged + self.phase).own_sin_cos();
        self.amplitudes.map(|[c1, c2]| libm::sqrtf((c1 * c1 + c2 * c2 + 2.0 * c1 * c2 * cos).max(0.0)))
    }

    /// The greatest they become, rad.
    fn greatest(&self) -> [f32; 2] {
        self.amplitudes.map(|[c1, c2]| c1.abs() + c2.abs())
    }
}
