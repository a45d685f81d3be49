//! Pendulums with bob 2's trace. The page's animation; and two motions side by side: figure 7, the page's chaotic motion by the right
//! equations and by the ones it prints, and upright, both rods at exactly 180 degrees, where the pendulum would stand for ever if the
//! number pi could be held.

use double_pendulum::{DirectionF32, Error, Parameters, Real, Run, State};

use crate::config::{
    DT, HALF_PIXEL, PAGE_GRAVITY, STEPS_PER_TICK, TRAIL_BRIGHTNESS, TRAIL_FADING, TRAIL_HALF_WIDTH,
};
use crate::graphics::{
    Anchor, Canvas, FadeLayer, Fading, LINE, LOWEST, Place, RodDirections, SUBPIXELS,
    TRACE_HALF_WIDTH, View, label, text,
};
use crate::motion::{Energy, Misprinted, Resources, Settings, Simulation};
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

    fn draw(&self, [left, right]: [&str; 2], report: &Report, canvas: &mut Canvas) {
        self.0.iter().for_each(|view| view.draw(canvas, u8::MAX));
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
        self.halves.trace(
            [self.right.motion.directions(), self.misprinted.directions()],
            ink,
        );
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        let (right, misprinted) = (
            self.right.energy.of_error(report.energy_error),
            self.misprinted.energy(),
        );
        let energies = [("true ", right), ("book ", misprinted)]
            .map(|(name, energy)| label::label(name, energy, 1, " J"));
        self.halves.draw(
            energies.each_ref().map(|energy| energy.as_str()),
            report,
            canvas,
        );
    }

    fn report(&self, _: u64) -> Report {
        Report::of(&self.right)
    }

    fn planned(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.right)
    }
}

/// The same motion in plain `f32` on the left and in compensated `f32` on the right. The clock is that of the left one,
/// beside the right one. There is no plan: both are shown for what their arithmetic does.
///
/// The `f32` nearest to pi is 8.7e-8 too large, so the true motion from there falls after about 3 s. Plain `f32` drops
/// the first tiny increments altogether and stands for minutes: it looks perfect and is wrong. What is kept beside the
/// state on the right is just what was dropped.
#[derive(Clone, Debug)]
pub struct Upright {
    plain: State<f32>,
    plain_directions: RodDirections,
    compensated: Run<DirectionF32>,
    energy: Energy,
    halves: Halves,
    /// The time of the last right frame; infinity as long as all are.
    horizon: f32,
}

impl Upright {
    /// Whether the plain motion is no longer shown where the compensated one is.
    fn have_parted(&self) -> bool {
        let Halves([left, _]) = &self.halves;
        let [plain, compensated] =
            [self.plain_directions, self.compensated.directions()].map(|to| left.bobs(to));
        let is_near = |((x, y), (exact_x, exact_y)): ((f32, f32), (f32, f32))| {
            let (dx, dy) = (x - exact_x, y - exact_y);
            dx * dx + dy * dy <= HALF_PIXEL * HALF_PIXEL
        };
        !plain.into_iter().zip(compensated).all(is_near)
    }
}

fn directions(state: &State<f32>) -> RodDirections {
    state.angles().map(|angle| angle.own_sin_cos().into())
}

impl Scene for Upright {
    fn new(settings: &Settings, _: &Resources) -> Result<(Self, Option<f32>), Error> {
        let (pendulum, plain) = settings.start()?;
        pendulum.check_step(DT)?;
        let compensated = pendulum.run(&plain, DT)?;
        let plain_directions = directions(&plain);
        let halves = Halves::new(settings, [plain_directions, compensated.directions()]);
        let energy = Energy::new(pendulum, plain_directions, &plain);
        Ok((
            Self {
                plain,
                plain_directions,
                compensated,
                energy,
                halves,
                horizon: f32::INFINITY,
            },
            None,
        ))
    }

    fn tick(&mut self, ticks: u64, ink: &mut FadeLayer) {
        for _ in 0..STEPS_PER_TICK {
            self.plain = self.energy.pendulum.step(&self.plain, DT as f32);
        }
        self.plain_directions = directions(&self.plain);
        // One that is lost stands still.
        let _stays = self.compensated.advance(STEPS_PER_TICK);
        if self.horizon.is_infinite() && self.have_parted() {
            self.horizon = time(ticks.wrapping_sub(1)) as f32;
        }
        self.halves
            .trace([self.plain_directions, self.compensated.directions()], ink);
    }

    fn draw(&self, report: &Report, canvas: &mut Canvas) {
        self.halves.draw(["plain", "compensated"], report, canvas);
    }

    fn report(&self, ticks: u64) -> Report {
        let energy_error = self.energy.error(self.plain_directions, &self.plain);
        Report {
            state: self.plain,
            energy_error,
            horizon: self.horizon,
            ..Report::at(ticks)
        }
    }
}
