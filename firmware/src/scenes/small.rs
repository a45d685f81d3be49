//! Figures 3 to 5 of the page: small oscillations in closed form. Both angles are scrolling curves
//! within their envelopes.

use double_pendulum::plan::Stepping;
use double_pendulum::{Error, Method, Modes, Parameters, Pendulum, SmallOscillations, sin_cos};

use crate::config::{PAGE_GRAVITY, TICK_RATE};
use crate::graphics::{
    Anchor, Canvas, FadeLayer, Fading, Height, LINE, LOWEST, SUBPIXELS, WIDTH, label, plot, text,
};
use crate::motion::{Resources, Settings};
use crate::scenes::{Report, Scene, Shows, draw_clock, time};

/// The rows of angle 0 for angle 1 and angle 2, pixels from the top, and the largest swing about
/// them.
const ROWS: [f32; 2] = [20.5, 43.5];
const SWING: f32 = 10.5;
/// The first column of the plots, right of their names and scales.
const LEFT: i32 = 18;
const RIGHT: i32 = WIDTH as i32 - 1;
/// The approximate period of the exchange of energy between the rods, columns.
const COLUMNS_PER_EXCHANGE: f32 = 60.0;
/// The smallest length of the scale bar for time, columns.
const LEAST_BAR: f32 = 16.0;
const ENVELOPE_GREY: u8 = 5;

/// The method of the scene. It shows the linear model, and does not follow the plan.
const CLOSED_FORM: Stepping = Stepping {
    method: Method::ClosedFormF32,
    steps: 1,
};

/// Returns the worked example of the page: equal rods of 0.25 m, m1 = 1 kg, g = 9.8 m/s^2, a1 = 0,
/// a2 = 30 degrees, released from rest, with the mass ratio m2/m1, which is not checked.
pub fn example(mass_ratio: f32) -> Settings {
    let parameters = Parameters::equal_rods(mass_ratio, 0.25, PAGE_GRAVITY as f32);
    Settings {
        parameters,
        degrees: [0.0, 30.0],
        velocities: [0.0; 2],
    }
}

/// The two angles over time, by the linear model. The horizon that is shown with the time is the
/// time until which the exact motion has the same angles, to half a pixel of the curves. The scale
/// is in degrees. A requested method is ignored.
///
/// Settings that describe no pendulum or no finite start are refused, and so is a pendulum without
/// gravity. One that hangs at rest at the start has level curves, and is not planned.
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
    /// The heights of the ends of the curves.
    ends: Option<[Height; 2]>,
}

impl Small {
    /// Returns the envelopes of both angles at time `t`, rad.
    ///
    /// The amplitude of C1 cos(w1 t + f1) + C2 cos(w2 t + f2) is sqrt(C1^2 + C2^2 + 2 C1 C2 cos((w1
    /// - w2) t + f1 - f2)).
    fn envelopes(&self, t: f64) -> [f32; 2] {
        // The turns are exact for hours, so they are reduced in 64 bits.
        let turns = self.exchange * t;
        let exchanged = (turns - libm::rint(turns)) as f32 * core::f32::consts::TAU;
        let phase = exchanged + self.phase;
        let (_, cos) = sin_cos(phase);
        self.amplitudes
            .map(|[c1, c2]| libm::sqrtf((c1 * c1 + c2 * c2 + 2.0 * c1 * c2 * cos).max(0.0)))
    }

    /// Scrolls the curves and their envelopes, and adds a column.
    fn extend(&mut self, time: f64, ink: &mut Canvas) {
        ink.scroll(LEFT);
        // Heights are measured from the row of angle 0.
        let [row1, row2] = ROWS;
        let height = |(angle, row): (f32, f32)| plot::height(angle, row, self.scale);

        // Each envelope has a point above and one below.
        let [envelope1, envelope2] = self.envelopes(time);
        for envelope in [(envelope1, row1), (envelope2, row2)] {
            let mirrored =
                plot::height(0.0, 2.0 * envelope.1, 0.0).saturating_sub(height(envelope));
            for height in [height(envelope), mirrored] {
                ink.lighten(
                    RIGHT,
                    i32::from(height).div_euclid(SUBPIXELS),
                    ENVELOPE_GREY,
                );
            }
        }

        // The curves.
        let [a1, a2] = self.motion.at(time).angles();
        let heights = [(a1, row1), (a2, row2)].map(height);
        for (before, now) in self.ends.unwrap_or(heights).into_iter().zip(heights) {
            plot::column(ink, RIGHT, before, now, u8::MAX);
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

    fn new(settings: &Settings, _: &Resources) -> Result<(Self, Option<f32>), Error> {
        let (pendulum, _) = settings.start()?;
        let modes = Modes::new(&settings.parameters.cast())?;
        let motion = SmallOscillations::new(modes, &settings.motion());

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
        let [fast_phase, slow_phase] = motion.phases();
        let exchange = core::f32::consts::TAU / modes.exchange() as f32;
        let ticks_per_column = (exchange * TICK_RATE as f32 / COLUMNS_PER_EXCHANGE) as u32;
        let scale = if greatest > 0.0 {
            SWING / greatest
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
            ends: None,
        };
        Ok((scene, (scale > 0.0).then(|| planned_height(scale))))
    }

    fn tick(&mut self, ticks: u64, ink: &mut FadeLayer) {
        if self.ends.is_none() {
            self.extend(0.0, &mut ink.frame);
        }
        if ticks.is_multiple_of(self.ticks_per_column.into()) {
            self.extend(time(ticks), &mut ink.frame);
        }
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        // The axes, with their names and the largest angle.
        let greatest = if self.scale > 0.0 {
            (SWING / self.scale).to_degrees()
        } else {
            0.0
        };
        for (row, name) in ROWS.map(|row| row as i32).into_iter().zip(["α₁", "α₂"]) {
            let swing = SWING as i32;
            plot::axis(canvas, LEFT, WIDTH as i32, row);
            plot::bar(canvas, (LEFT - 1, row - swing), (LEFT - 1, row + swing));
            text::write(canvas, name, Anchor::EndingAt(LEFT - 2, row - LINE / 2));
            text::write(
                canvas,
                &label::label("", greatest, 0, "°"),
                Anchor::EndingAt(LEFT - 2, row - swing),
            );
        }

        // A scale bar as long as a round time.
        let columns_per_second = TICK_RATE as f32 / self.ticks_per_column as f32;
        let seconds = plot::scale_step(LEAST_BAR / columns_per_second);
        let end = LEFT + (seconds * columns_per_second) as i32;
        let row = LOWEST + LINE / 2;
        plot::bar(canvas, (LEFT, row), (end, row));
        text::write(
            canvas,
            &label::tick(seconds, " s"),
            Anchor::At(end + 4, LOWEST),
        );

        // The mass ratio, and the model.
        text::write(
            canvas,
            &label::mass_ratio(self.pendulum.parameters().mass_ratio()),
            Anchor::Left(0),
        );
        text::write(canvas, "linear", Anchor::Middle(0));
        draw_clock(canvas, report, Anchor::Right(LOWEST), Anchor::Right(0));
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
