//! Beats that close. If the two frequencies have a ratio of whole numbers, small oscillations
//! return to their start after a few periods, and their Lissajous figure closes. The exact motion
//! from the same start does not return.

use double_pendulum::plan::Costs;
use double_pendulum::{Error, Modes, Parameters, SmallOscillations};

use crate::config::{GRAVITY, ROD};
use crate::graphics::{Anchor, Canvas, Disc, Format, Spot, Stroke, label, plot, text};
use crate::motion::{Resources, Settings, Simulation};
use crate::scenes::{Report, Scene, Shows, draw_clock};

/// Half the width of the line, the radius of the moving spot, and the gap around it, subpixels of
/// a unit.
const HALF_WIDTH: i32 = 18;
const SPOT_RADIUS: i32 = 60;
const GAP: i32 = 6;
/// The amplitude of angle 2 in each mode, degrees.
const AMPLITUDE: f64 = 12.0;

/// Returns the settings of equal rods of 1 m, m1 = 1 kg and mass ratio m2/m1 at 9.81 m/s^2. Both
/// modes have the same amplitude of angle 2, 12 degrees. The slow mode starts at its turning point,
/// where both angles are positive. The fast mode starts at angle 0, and turns rod 2 to positive
/// angles. The figure closes only if the ratio of the frequencies is rational, as in the scenes of
/// the catalogue.
///
/// Not checked: the mass ratio is positive and finite. Otherwise numbers may be infinite or NaN.
pub fn closing(mass_ratio: f64) -> Settings {
    let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY);
    let shape = libm::sqrt((1.0 + mass_ratio) / mass_ratio);
    let root = libm::sqrt((1.0 + mass_ratio) * mass_ratio);
    let fast = libm::sqrt(GRAVITY / ROD * (1.0 + mass_ratio + root));
    let velocity = fast * AMPLITUDE.to_radians();
    Settings {
        parameters,
        degrees: [AMPLITUDE / shape, AMPLITUDE],
        velocities: [-velocity / shape, velocity],
    }
}

/// The places of the two figures and of the words.
#[derive(Clone, Copy, Debug)]
struct Layout {
    format: Format,
    /// The middles of the two figures, and the largest swing of a mode in them, pixels.
    middles: [(f32, f32); 2],
    reach: f32,
    /// The places of the names of the axes, of the scale, of the time and of the horizon.
    words: [Anchor; 5],
}

impl Layout {
    fn of(format: Format) -> Self {
        let line = format.line();
        let lowest = format.lowest();
        if !format.is_large() {
            return Self {
                format,
                middles: [(23.5, 32.5), (104.5, 32.5)],
                reach: 21.5,
                words: [3 * line, 4 * line, 5 * line, line + 2, lowest].map(Anchor::Middle),
            };
        }

        // Above the figures is a line of text, and below them are two.
        let top = format.units(10) as f32;
        let bottom = (lowest - format.units(10)) as f32;
        let width = format.right() as f32;
        let reach = (0.5 * (bottom - top)).min(0.25 * width - format.units(3) as f32);
        let legend = lowest - format.units(9);
        let y = 0.5 * (top + bottom);
        Self {
            format,
            middles: [(0.25 * width, y), (0.75 * width, y)],
            reach,
            words: [
                Anchor::Left(legend),
                Anchor::Middle(legend),
                Anchor::Right(legend),
                Anchor::Left(lowest),
                Anchor::Right(lowest),
            ],
        }
    }

    /// Returns this number of subpixels of a unit in subpixels.
    fn subpixels(&self, of_unit: i32) -> u16 {
        self.format.units(of_unit) as u16
    }
}

/// A plot of the part of angle 2 in the fast mode (upwards) against the part in the slow mode
/// (across): the linear motion on the left, the exact motion on the right.
///
/// The horizon that is shown with the time is that of the exact motion. The linear motion is not
/// accurate; its difference is the subject of the scene. `±` and a number of degrees is the larger
/// amplitude of angle 2. Where an exact angle passes straight up, its curve is interrupted.
///
/// A pendulum without gravity is refused, and so is everything that [`Simulation::new`] refuses.
/// Unequal rods are accepted. A pendulum that hangs at rest at the start is shown as two spots in
/// the middles of the figures, and is not planned.
#[derive(Clone, Debug)]
pub struct Beats {
    simulation: Simulation,
    layout: Layout,
    linear: SmallOscillations<f32>,
    /// The amplitude of angle 2 relative to angle 1, in the fast mode and in the slow mode.
    shape: [f32; 2],
    /// Pixels per radian.
    scale: f32,
    /// The ends of the two curves.
    spots: [Spot; 2],
    mass_ratio: f32,
    /// The angles of the exact motion, within half a turn either way, rad.
    exact: [f32; 2],
}

impl Beats {
    /// Returns both angles of the exact motion, within half a turn either way, rad.
    fn exact_angles(&self) -> [f32; 2] {
        let directions = self.simulation.motion.directions();
        directions.map(|[sin, cos]| libm::atan2f(sin, cos))
    }

    /// Returns the positions of the linear and of the exact motion, each in its figure.
    fn spots(&self) -> [Spot; 2] {
        let [fast_shape, slow_shape] = self.shape;
        let spot = |(x, y): (f32, f32), [a1, a2]: [f32; 2]| {
            // The part in the slow mode is drawn across, the part in the fast mode upwards.
            let across = slow_shape * (a2 - fast_shape * a1) / (slow_shape - fast_shape);
            let down = y - self.scale * (a2 - across);
            Spot::at(x + self.scale * across, down, self.layout.format)
        };
        let [left, right] = self.layout.middles;
        let linear = self.linear.at(self.simulation.motion.time()).angles();
        [spot(left, linear), spot(right, self.exact)]
    }
}

impl Scene for Beats {
    const SHOWS: Shows = Shows::Motion;
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let simulation = Simulation::new(settings, resources)?;

        // Scale the larger amplitude to the figure.
        let modes = Modes::new(&settings.parameters)?;
        let linear = SmallOscillations::<f32>::new(modes, &settings.motion().cast());
        let shape = [modes.fast.shape, modes.slow.shape].map(|shape| shape as f32);
        let [fast, slow] = linear.amplitudes();
        let greatest = (fast * shape[0].abs()).max(slow * shape[1].abs());
        let layout = Layout::of(resources.format);
        let scale = if greatest > 0.0 {
            layout.reach / greatest
        } else {
            0.0
        };

        let spots = [Spot::default(); 2];
        let mut scene = Self {
            simulation,
            layout,
            linear,
            shape,
            scale,
            spots,
            mass_ratio: settings.mass_ratio(),
            exact: [0.0; 2],
        };
        scene.exact = scene.exact_angles();
        scene.spots = scene.spots();

        // If both angles have an error, a spot moves by less than the error of one times this gain.
        let [fast_shape, _] = shape;
        let gain = libm::sqrtf(0.5 * (1.0 + fast_shape * fast_shape));
        Ok((scene, (scale > 0.0).then_some(4.0 * scale * gain)))
    }

    fn tick(&mut self, _: u64, ink: &mut Canvas) {
        self.simulation.tick();
        let before = self.exact;
        self.exact = self.exact_angles();
        let spots = self.spots();

        // A curve whose angle passes straight up continues at the other edge of the figure, without
        // a line across it.
        let wraps = |(from, to): (f32, f32)| (from - to).abs() > core::f32::consts::PI;
        let is_cut = [false, before.into_iter().zip(self.exact).any(wraps)];
        for ((from, to), is_cut) in self.spots.into_iter().zip(spots).zip(is_cut) {
            Stroke {
                from: if is_cut { to } else { from },
                to,
                radius: self.layout.subpixels(HALF_WIDTH),
            }
            .lighten(ink, u8::MAX);
        }
        self.spots = spots;
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let Layout {
            middles,
            reach,
            words: [fast, slow, scale, time, trust],
            ..
        } = self.layout;
        let unit = canvas.format.units(1);
        for (x, y) in middles.map(|(x, y)| (x as i32, y as i32)) {
            plot::axis(canvas, x - reach as i32, x + reach as i32 + unit, y);
            plot::upright_axis(canvas, x, y - reach as i32, y + reach as i32 + unit);
        }

        for centre in self.spots {
            Disc {
                centre,
                radius: self.layout.subpixels(SPOT_RADIUS),
                gap: self.layout.subpixels(GAP),
            }
            .draw(canvas, u8::MAX);
        }

        text::write(canvas, "linear", Anchor::Left(0));
        text::write(canvas, "exact", Anchor::Right(0));
        let mass_ratio = label::mass_ratio(self.mass_ratio);
        text::write(canvas, &mass_ratio, Anchor::Middle(0));
        let swing = if self.scale > 0.0 {
            (reach / self.scale).to_degrees()
        } else {
            0.0
        };
        text::write(canvas, "↑ fast", fast);
        text::write(canvas, "→ slow", slow);
        text::write(canvas, &label::label("±", swing, 0, "°"), scale);
        draw_clock(canvas, report, time, trust);
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.simulation)
    }

    fn cost(&self, costs: &Costs) -> f32 {
        self.simulation.cost(costs)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.simulation)
    }

    fn is_too_fast(&self) -> bool {
        self.simulation.is_too_fast
    }
}
