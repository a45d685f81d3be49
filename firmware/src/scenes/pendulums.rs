//! Pendulums with bob 2's trace. The page's animation; and two motions side by side: figure 7, the page's chaotic motion by the right
//! equations and by the ones it prints, and upright, both rods at exactly 180 degrees, where the pendulum would stand for ever if the
//! number pi could be held.

use double_pendulum::plan::Stepping;
use double_pendulum::{DirectionF32, Error, Method, Parameters, Pendulum, Real, Run, State};

use crate::config::{
    HALF_PIXEL, PAGE_GRAVITY, Processor, STEPS_PER_TICK, TICK_RATE, TRAIL_BRIGHTNESS, TRAIL_FADING,
    TRAIL_HALF_WIDTH,
};
use crate::graphics::{
    Anchor, Canvas, FadeLayer, Fading, HEIGHT, LINE, LOWEST, Place, RodDirections, SUBPIXELS,
    TRACE_HALF_WIDTH, View, label, text,
};
use crate::motion::{Horizon, Misprinted, Resources, Settings, Simulation};
use crate::scenes::{Report, Scene, draw_clock, time};

/// One pendulum, bob 2's trail, and settings and time in the corners, the one place the motion never reaches.
#[derive(Clone, Debug)]
pub struct Page {
    settings: Settings,
    simulation: Simulation,
    view: View,
}

impl Scene for Page {
    const FADING: Fading = Fading {
        rows: TRAIL_FADING,
        last: 0,
    };

    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let simulation = Simulation::new(settings, resources)?;
        let view = View::new(
            &settings.parameters,
            Place::WHOLE,
            simulation.motion.directions(),
        );
        Ok((
            Self {
                settings: *settings,
                simulation,
                view,
            },
            Some(2.0 * Place::WHOLE.reach),
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut FadeLayer) {
        self.simulation.tick();
        let half_width = (TRAIL_HALF_WIDTH * SUBPIXELS as f32) as u8;
        self.view.trace(
            self.simulation.motion.directions(),
            ink,
            half_width,
            TRAIL_BRIGHTNESS,
        );
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.view.draw(canvas, u8::MAX);
        let [degrees1, degrees2] = self.settings.degrees;
        text::write(
            canvas,
            &label::mass_ratio(self.settings.mass_ratio()),
            Anchor::Left(0),
        );
        if degrees1 == degrees2 {
            text::write(
                canvas,
                &label::degrees("α ", degrees1),
                Anchor::Left(LOWEST),
            );
        } else {
            text::write(
                canvas,
                &label::degrees("α₁ ", degrees1),
                Anchor::Left(LOWEST - LINE),
            );
            text::write(
                canvas,
                &label::degrees("α₂ ", degrees2),
                Anchor::Left(LOWEST),
            );
        }
        draw_clock(canvas, report, Anchor::Right(0), Anchor::Right(LOWEST));
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.simulation)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.simulation)
    }

    fn is_too_fast(&self) -> bool {
        self.simulation.is_too_fast
    }
}

/// Two motions in their halves of the frame, each with bob 2's whole trace.
#[derive(Clone, Debug)]
struct Halves([View; 2]);

impl Halves {
    fn new(settings: &Settings, [left, right]: [RodDirections; 2]) -> Self {
        let view = |place, directions| View::new(&settings.parameters, place, directions);
        let [left_half, right_half] = Place::HALVES;
        Self([view(left_half, left), view(right_half, right)])
    }

    fn trace(&mut self, directions: [RodDirections; 2], ink: &mut FadeLayer) {
        for (view, directions) in self.0.iter_mut().zip(directions) {
            view.trace(directions, ink, TRACE_HALF_WIDTH, u8::MAX);
        }
    }

    /// Draws both pendulums or, if the right one `is_lost`, the left one.
    fn draw(&self, [left, right]: [&str; 2], is_lost: bool, report: &Report, canvas: &mut Canvas) {
        let Self([left_view, right_view]) = self;
        left_view.draw(canvas, u8::MAX);
        if !is_lost {
            right_view.draw(canvas, u8::MAX);
        }
        text::write(canvas, left, Anchor::Left(0));
        text::write(canvas, right, Anchor::Right(0));
        draw_clock(
            canvas,
            report,
            Anchor::Middle(LINE + 1),
            Anchor::Middle(LOWEST),
        );
    }
}

/// The figure's start: mass ratio 2.75, both rods at 171 degrees, let go from rest. The page gives no more; gravity is that
/// of its worked example, and the rods are 1 m.
pub fn figure_7() -> Settings {
    let parameters = Parameters::equal_rods(2.75, 1.0, PAGE_GRAVITY as f32);
    Settings {
        parameters,
        degrees: [171.0; 2],
        velocities: [0.0; 2],
    }
}

/// Both motions and their energies. The clock is that of the right equations.
#[derive(Clone, Debug)]
pub struct Figure7 {
    right: Simulation,
    misprinted: Misprinted,
    halves: Halves,
}

impl Scene for Figure7 {
    #[inline(never)] // all scenes' preparations would stand side by side on the stack
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let &Parameters { l1, l2, .. } = &settings.parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods {
                l1: l1.into(),
                l2: l2.into(),
            });
        }
        let right = Simulation::new(settings, resources)?;
        let misprinted = Misprinted::new(&settings.parameters, &right.motion.rounded_state());
        let halves = Halves::new(
            settings,
            [right.motion.directions(), misprinted.directions()],
        );
        Ok((
            Self {
                right,
                misprinted,
                halves,
            },
            Some(2.0 * Place::HALVES[0].reach),
        ))
    }

    fn tick(&mut self, _: u64, ink: &mut FadeLayer) {
        self.right.tick();
        self.misprinted.tick();
        // A motion that is lost leaves no more trace.
        self.halves.trace(
            [self.right.motion.directions(), self.misprinted.directions()],
            ink,
        );
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let right = self.right.energy.of_error(report.energy_error);
        let right = label::label("true ", right, 1, " J");
        let is_lost = self.misprinted.is_lost();
        let misprinted = if is_lost {
            label::Label::try_from("book too fast").unwrap_or_default()
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

/// The same motion in plain `f32` on the left and in compensated `f32` on the right. The clock is
/// that of the left one, compared with the same motion in 64 bits, which is not drawn. There is no
/// plan: both are shown for what their arithmetic does.
///
/// The `f32` nearest to pi is 8.7e-8 too large, so the true motion from there falls after about 3 s. Plain `f32` drops
/// the first tiny increments altogether and stands for minutes: it looks perfect and is wrong. What is kept beside the
/// state on the right is just what was dropped.
#[derive(Clone, Debug)]
pub struct Upright {
    pendulum: Pendulum<f32>,
    plain: State<f32>,
    plain_directions: RodDirections,
    compensated: Run<DirectionF32>,
    /// Steps of both to a tick.
    steps: u32,
    exact: Simulation,
    halves: Halves,
    horizon: Horizon,
}

/// The number of times that a step in plain `f32` costs as much as the two sines and cosines of a
/// frame in closed form: RK4 evaluates the equations four times.
const PLAIN_STEP: f32 = 4.0;

/// The largest distance of a bob from that of the motion in 64 bits, pixels, that is less than half a
/// pixel from the exact one: steps of that motion may be the longest that resolve it.
const NEAR: f32 = HALF_PIXEL / 1.1;

impl Upright {
    /// Returns true if a bob of the plain motion may no longer be shown where the exact one is.
    fn have_parted(&self) -> bool {
        let Halves([left, _]) = &self.halves;
        let [plain, exact] =
            [self.plain_directions, self.exact.motion.directions()].map(|to| left.bobs(to));
        let is_near = |((x, y), (exact_x, exact_y)): ((f32, f32), (f32, f32))| {
            let (dx, dy) = (x - exact_x, y - exact_y);
            dx * dx + dy * dy <= NEAR * NEAR
        };
        !plain.into_iter().zip(exact).all(is_near)
    }
}

fn directions(state: &State<f32>) -> RodDirections {
    state.angles().map(|angle| angle.own_sin_cos().into())
}

impl Scene for Upright {
    #[inline(never)] // all scenes' preparations would stand side by side on the stack
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error> {
        let (pendulum, plain) = settings.start()?;

        // RK4 in steps that a search would try first, and no fewer than at power-on.
        let steps = Stepping::of(&settings.problem(HEIGHT as f32), Method::Rk4F32Direction)?.steps;
        let steps = steps.max(STEPS_PER_TICK);
        let dt = 1.0 / f64::from(TICK_RATE * steps);
        pendulum.check_step(dt)?;

        // The motion in 64 bits may take the rest of a frame.
        let Processor { costs, frame, .. } = &resources.processor;
        let both = steps as f32 * (PLAIN_STEP * costs.closed_form + costs.direction);
        let resources = Resources {
            processor: Processor {
                frame: frame - both,
                ..resources.processor
            },
            method: None,
        };
        let mut exact = Simulation::new(settings, &resources)?;
        exact.is_too_fast |= exact.motion.stepping().method != Method::Extrapolation10Fixed64;

        let compensated = pendulum.run(&plain, dt)?;
        let plain_directions = directions(&plain);
        let halves = Halves::new(settings, [plain_directions, compensated.directions()]);
        let scene = Self {
            pendulum,
            plain,
            plain_directions,
            compensated,
            steps,
            exact,
            halves,
            horizon: Horizon::AtLeast(0.0),
        };
        Ok((scene, None))
    }

    fn tick(&mut self, ticks: u64, ink: &mut FadeLayer) {
        let dt = 1.0 / (TICK_RATE * self.steps) as f32;
        for _ in 0..self.steps {
            self.plain = self.pendulum.step(&self.plain, dt);
        }
        self.plain_directions = directions(&self.plain);
        // One that is lost stands still.
        let _stays = self.compensated.advance(self.steps);
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
