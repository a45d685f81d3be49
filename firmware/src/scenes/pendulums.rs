//! Pendulums with the trace of bob 2. There are three scenes:
//!
//! - `page`: the animation of the page;
//! - `figure-7`: the page's chaotic motion, by the correct equations and by the misprinted ones;
//! - `upright`: both rods start at the `f32` nearest to pi, 180.000005 degrees. At 180 degrees the
//!   pendulum would stand for ever.

use double_pendulum::plan::{Costs, Stepping};
use double_pendulum::{DirectionF32, Error, Method, Parameters, Pendulum, Run, State, sin_cos};

use crate::config::{
    GREATEST_ANGLE, HALF_PIXEL, PAGE_GRAVITY, Processor, STEPS_PER_TICK, TICK_RATE,
    TRAIL_BRIGHTNESS, TRAIL_FADING, TRAIL_HALF_WIDTH,
};
use crate::graphics::label::Label;
use crate::graphics::{
    Anchor, Canvas, Fading, Format, Place, RodDirections, SUBPIXELS, TRACE_HALF_WIDTH, View, label,
    text,
};
use crate::motion::{Horizon, Misprinted, Resources, Settings, Simulation};
use crate::scenes::{Report, Scene, Shows, draw_clock, time};

/// A pendulum and the trail of bob 2, which fades in 2.3 s of the scene. The mass ratio, the start
/// angles (degrees), the time and the horizon are in the corners, which the motion never reaches.
/// The scene refuses what [`Simulation::new`] refuses.
#[derive(Clone, Debug)]
pub struct Page {
    simulation: Simulation,
    view: View,
    /// The labels of the settings. They are formatted only once, because that takes a part of every
    /// frame.
    mass_ratio: Label,
    angles: [Label; 2],
}

impl Scene for Page {
    const SHOWS: Shows = Shows::Motion;
    const FADING: Fading = Fading {
        rows: TRAIL_FADING,
        last: 0,
    };

    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let simulation = Simulation::new(settings, resources)?;
        let place = Place::whole(resources.format);
        let directions = simulation.motion.directions();
        let view = View::new(&settings.parameters, place, directions);
        let [degrees1, degrees2] = settings.degrees;
        let angles = if degrees1 == degrees2 {
            // Two equal angles need only one label.
            [Label::new(), label::degrees("α ", degrees1)]
        } else {
            [("α₁ ", degrees1), ("α₂ ", degrees2)].map(|(name, angle)| label::degrees(name, angle))
        };
        Ok((
            Self {
                simulation,
                view,
                mass_ratio: label::mass_ratio(settings.mass_ratio()),
                angles,
            },
            Some(2.0 * place.reach),
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut Canvas) {
        // Bob 2 leaves its trail.
        self.simulation.tick();
        let half_width = (TRAIL_HALF_WIDTH * SUBPIXELS as f32) as u16;
        self.view.trace(
            self.simulation.motion.directions(),
            ink,
            half_width,
            TRAIL_BRIGHTNESS,
        );
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let lowest = canvas.format.lowest();
        let above_lowest = lowest - canvas.format.line();
        self.view.draw(canvas, u8::MAX);

        text::write(canvas, &self.mass_ratio, Anchor::Left(0));
        for (angle, top) in self.angles.iter().zip([above_lowest, lowest]) {
            text::write(canvas, angle, Anchor::Left(top));
        }
        draw_clock(canvas, report, Anchor::Right(0), Anchor::Right(lowest));
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

/// Two motions in the two halves of the frame, each with the whole trace of bob 2.
#[derive(Clone, Debug)]
struct Halves {
    views: [View; 2],
    format: Format,
}

impl Halves {
    /// Creates both pendulums in their initial directions.
    fn new(settings: &Settings, [left, right]: [RodDirections; 2], format: Format) -> Self {
        let view = |place, directions| View::new(&settings.parameters, place, directions);
        let [left_half, right_half] = Place::halves(format);
        Self {
            views: [view(left_half, left), view(right_half, right)],
            format,
        }
    }

    /// Turns both pendulums to these directions, and draws the traces of bob 2 on the way.
    fn trace(&mut self, directions: [RodDirections; 2], ink: &mut Canvas) {
        for (view, directions) in self.views.iter_mut().zip(directions) {
            view.trace(directions, ink, TRACE_HALF_WIDTH, u8::MAX);
        }
    }

    /// Draws both pendulums, with a label for each. If `is_lost`, draws only the left one.
    fn draw(&self, [left, right]: [&str; 2], is_lost: bool, report: &Report, canvas: &mut Canvas) {
        let [left_view, right_view] = &self.views;
        // A lost motion has no position.
        left_view.draw(canvas, u8::MAX);
        if !is_lost {
            right_view.draw(canvas, u8::MAX);
        }
        text::write(canvas, left, Anchor::Left(0));
        text::write(canvas, right, Anchor::Right(0));

        let format = self.format;
        let lowest = format.lowest();
        if format.is_large() {
            draw_clock(canvas, report, Anchor::Left(lowest), Anchor::Right(lowest));
        } else {
            let below_labels = format.line() + 1;
            draw_clock(
                canvas,
                report,
                Anchor::Middle(below_labels),
                Anchor::Middle(lowest),
            );
        }
    }
}

/// Returns the settings of figure 7: mass ratio 2.75, both rods at 171 degrees, released from
/// rest.
///
/// The page gives no more. The gravity, 9.8 m/s^2, is from its worked example. The rods are 1 m
/// long, and bob 1 has 1 kg.
pub fn figure_7() -> Settings {
    let parameters = Parameters::equal_rods(2.75, 1.0, PAGE_GRAVITY);
    Settings {
        parameters,
        degrees: [171.0; 2],
        velocities: [0.0; 2],
    }
}

/// The cost of a step of the misprinted motion, in steps by RK4 in `f32`: 1.55 on a Cortex-M3 and 1.58
/// on a Cortex-M0+, counted in figure 7. It is 2.4 on a Cortex-M4F, where such a motion takes 1 % of
/// a tick.
const OTHER_STEP: f32 = 1.6;

/// The correct motion on the left, the misprinted one on the right, and their energies, J, with the
/// potential zero at the pivot. The horizon that is shown with the time, and a requested method,
/// belong to the correct motion. Unequal rods are refused, because the misprinted equations are for
/// equal ones, and so is everything that [`Simulation::new`] refuses. A misprinted motion that is
/// too fast for its steps is no longer drawn, and `book too fast` replaces its energy.
#[derive(Clone, Debug)]
pub struct Figure7 {
    right: Simulation,
    misprinted: Misprinted,
    halves: Halves,
}

impl Scene for Figure7 {
    const SHOWS: Shows = Shows::Motion;
    #[inline(never)] // As for the butterfly, and 224 bytes of flash (M3).
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let &Parameters { l1, l2, .. } = &settings.parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods { l1, l2 });
        }

        let right = Simulation::new(settings, resources)?;
        let (_, start) = settings.start()?;
        let misprinted = Misprinted::new(&settings.parameters.cast(), &start);
        let halves = Halves::new(
            settings,
            [right.motion.directions(), misprinted.directions()],
            resources.format,
        );
        Ok((
            Self {
                right,
                misprinted,
                halves,
            },
            Some(2.0 * Place::halves(resources.format)[0].reach),
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut Canvas) {
        self.right.tick();
        self.misprinted.tick();
        // A motion that has diverged leaves no more trace.
        self.halves.trace(
            [self.right.motion.directions(), self.misprinted.directions()],
            ink,
        );
    }

    fn cost(&self, costs: &Costs) -> f32 {
        self.right.cost(costs)
    }

    fn other_cost(&self, costs: &Costs) -> f32 {
        OTHER_STEP * costs.direction * self.misprinted.tried as f32
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        // The energy of the exact motion, and the energy of the misprinted motion.
        let right = self.right.energy.of_error(report.energy_error);
        let right = label::label("true ", right, 1, " J");
        let is_lost = self.misprinted.is_lost();
        let misprinted = if is_lost {
            Label::try_from("book too fast").unwrap_or_default()
        } else {
            label::label("book ", self.misprinted.energy(), 1, " J")
        };
        let energies = [right.as_str(), misprinted.as_str()];
        self.halves.draw(energies, is_lost, report, canvas);
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.right)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.right)
    }

    fn is_too_fast(&self) -> bool {
        self.right.is_too_fast
    }
}

/// A motion in plain `f32` on the left, and the same motion in compensated `f32` on the right.
///
/// The horizon that is shown with the time is that of the left motion. This is compared with the
/// same motion in 64 bits, which is not drawn, until a bob is half a pixel off. There is no plan,
/// because the scene shows two given arithmetics. A requested method is ignored. The scene is too
/// fast if a frame cannot pay for all three motions. It accepts every finite start, not only the
/// upright one. It refuses settings that describe no pendulum or no such start, and steps that a
/// method cannot make. A compensated motion that has diverged stands still; a plain one stops the
/// scene, once its state is not finite.
///
/// The `f32` nearest to pi is too large by 8.7e-8, so that the exact motion from there falls after
/// about 3 s. Plain `f32` drops the first tiny increments completely, so that the pendulum does not
/// move for minutes: it looks perfect and is wrong. The compensation on the right keeps the dropped
/// parts.
#[derive(Clone, Debug)]
pub struct Upright {
    pendulum: Pendulum<f32>,
    plain: State<f32>,
    /// The directions of `plain`.
    plain_directions: RodDirections,
    compensated: Run<DirectionF32>,
    /// The number of steps of both motions in a tick.
    steps: u32,
    /// The motion in 64 bits.
    exact: Simulation,
    halves: Halves,
    /// True if the start is the scene's own, the `f32` nearest to pi.
    is_pi: bool,
    horizon: Horizon,
}

/// The cost of a step in plain `f32`, in units of the cost of the two sines and cosines of a frame
/// in closed form. It is 4 because RK4 evaluates the equations four times.
const PLAIN_STEP: f32 = 4.0;

/// The largest distance of a bob from the motion in 64 bits, pixels, that is certainly less than
/// half a pixel from the exact motion. The margin is for the steps of the motion in 64 bits, which
/// may be the longest that resolve it.
const NEAR: f32 = HALF_PIXEL / 1.1;

impl Upright {
    /// Returns true if a bob of the plain motion may no longer be within half a pixel of the exact
    /// one.
    fn have_parted(&self) -> bool {
        let [left, _] = &self.halves.views;
        // Both positions in the left half of the frame.
        let [plain, exact] =
            [self.plain_directions, self.exact.motion.directions()].map(|to| left.bobs(to));
        let is_near = |((x, y), (exact_x, exact_y)): ((f32, f32), (f32, f32))| {
            let dx = x - exact_x;
            let dy = y - exact_y;
            dx * dx + dy * dy <= NEAR * NEAR
        };
        !plain.into_iter().zip(exact).all(is_near)
    }
}

/// Returns the directions (sin, cos) of both rods.
fn directions(state: &State<f32>) -> RodDirections {
    state.angles().map(|angle| sin_cos(angle).into())
}

impl Scene for Upright {
    const SHOWS: Shows = Shows::Motion;
    #[inline(never)] // As for the butterfly, and 716 bytes of flash (M3).
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let is_pi = settings.degrees.map(f64::abs) == [GREATEST_ANGLE; 2];
        // Both motions in `f32` and the one in 64 bits start from the angles nearest in `f32`.
        let settings = &Settings {
            degrees: settings
                .angles()
                .map(|angle| f64::from(angle as f32).to_degrees()),
            ..*settings
        };
        let (_, start) = settings.start()?;
        let plain = start.cast();
        let pendulum = Pendulum::new(&settings.parameters.cast())?;

        // RK4 with the step count that a search would try first, and at least the one at power-on.
        let steps = Stepping::of(
            &settings.problem(resources.format.height.into()),
            Method::Rk4F32Direction,
        )?
        .steps;
        let steps = steps.max(STEPS_PER_TICK);
        let dt = 1.0 / f64::from(TICK_RATE * steps);
        pendulum.check_step(dt)?;

        // The motion in 64 bits may spend the rest of the budget of a frame.
        let format = resources.format;
        let Processor { costs, frame, .. } = &resources.processor;
        let both = steps as f32 * (PLAIN_STEP * costs.closed_form + costs.direction);
        let resources = Resources {
            processor: Processor {
                frame: frame - both,
                ..resources.processor
            },
            method: None,
            format,
        };
        let mut exact = Simulation::new(settings, &resources)?;
        exact.is_too_fast |= exact.motion.stepping().method != Method::Extrapolation10Fixed64;

        // The two motions that are drawn.
        let compensated = pendulum.run(&plain, dt)?;
        let plain_directions = directions(&plain);
        let directions = [plain_directions, compensated.directions()];
        let halves = Halves::new(settings, directions, format);
        let scene = Self {
            pendulum,
            plain,
            plain_directions,
            compensated,
            steps,
            exact,
            halves,
            is_pi,
            horizon: Horizon::AtLeast(0.0),
        };
        Ok((scene, None))
    }

    fn tick(&mut self, ticks: u64, ink: &mut Canvas) {
        // The plain motion.
        let dt = 1.0 / (TICK_RATE * self.steps) as f32;
        for _ in 0..self.steps {
            self.plain = self.pendulum.step(&self.plain, dt);
        }
        self.plain_directions = directions(&self.plain);

        // The compensated motion. If it has diverged, it does not move.
        let _stays = self.compensated.advance(self.steps);

        // Compare with the motion in 64 bits until the first difference.
        if self.horizon.is_open() {
            self.exact.tick();
            self.horizon = if self.have_parted() {
                Horizon::Until(time(ticks.wrapping_sub(1)) as f32)
            } else {
                Horizon::AtLeast(time(ticks) as f32)
            };
        }

        self.halves
            .trace([self.plain_directions, self.compensated.directions()], ink);
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let names = ["plain", "compensated"];
        self.halves.draw(names, false, report, canvas);
        if self.is_pi {
            // Between the two names.
            text::write(
                canvas,
                "f32 pi",
                Anchor::At(i32::from(9 * canvas.format.width / 32), 0),
            );
        }
    }

    fn report(&self, ticks: u64) -> Report {
        Report {
            state: self.plain,
            energy_error: self.exact.energy.error_of_state(&self.plain),
            horizon: self.horizon,
            ..Report::at(ticks)
        }
    }

    fn is_too_fast(&self) -> bool {
        self.exact.is_too_fast
    }
}
