//! What is played: a scene with its settings, and how its time goes.

use double_pendulum::{Error, Parameters};

use crate::app::command::Command;
use crate::config::{GREATEST_ANGLE, GREATEST_SPEED, LEAST_SPEED};
use crate::graphics::canvas::Canvas;
use crate::graphics::fade_layer::FadeLayer;
use crate::graphics::text;
use crate::motion::planner::Shown;
use crate::motion::settings::Settings;
use crate::protocol::{Field, Frame, Status};
use crate::scenes::scene::Report;
use crate::scenes::{AnyScene, SceneName};

/// Full speed, in the parts that a tick is made of.
const WHOLE_TICK: u32 = 100;

/// A scene under way.
#[derive(Debug)]
pub struct Player<'a> {
    name: SceneName,
    settings: Settings,
    scene: AnyScene,
    ink: &'a mut FadeLayer,
    pace: Pace,
    /// As of the last check.
    report: Report,
    /// The motion has left the finite numbers.
    stopped: bool,
}

impl<'a> Player<'a> {
    /// Plays the page with `settings`; the kernel's error if they describe no pendulum.
    pub fn new(settings: Settings, ink: &'a mut FadeLayer) -> Result<Self, Error> {
        let name = SceneName::Page;
        let scene = AnyScene::new(name, &settings)?;
        let report = scene.report();
        ink.clear();
        Ok(Self { name, settings, scene, ink, pace: Pace::default(), report, stopped: false })
    }

    /// Does what is asked; if that cannot be, nothing is changed and the error names what is wrong. Whether the scene
    /// was started again.
    ///
    /// Never inlined: what scenes need to start would be on the stack of every frame.
    #[inline(never)]
    pub fn execute(&mut self, command: Command) -> Result<bool, Field> {
        match command {
            Command::Heavier => return self.start(self.name, self.settings.heavier()),
            Command::Lighter => return self.start(self.name, self.settings.lighter()),
            Command::TurnLeft => return self.start(self.name, self.settings.turned(-1)),
            Command::TurnRight => return self.start(self.name, self.settings.turned(1)),
            Command::Restart => return self.start(self.name, self.settings),
            Command::NextScene => return self.choose(self.name.next()),
            Command::PreviousScene => return self.choose(self.name.previous()),
            Command::Choose(name) => return self.choose(name),
            Command::Set { field: Field::Speed, value } => self.pace.set_speed(value)?,
            // Whatever the new value makes impossible, it is the new value that is wrong.
            Command::Set { field, value } => return self.start(self.name, self.with(field, value)?).map_err(|_| field),
            Command::Pause(paused) => self.pace.pause(paused),
            Command::TogglePause => self.pace.pause(!self.pace.paused),
            Command::Step(ticks) => self.pace.step(ticks),
            Command::Ask | Command::AskPlan | Command::Identify | Command::Measure(_) => {}
        }
        Ok(false)
    }

    /// Advances by one tick of the clock, which may be any number of the scene's.
    #[inline(never)]
    pub fn tick(&mut self) {
        if self.stopped {
            return;
        }
        for _ in 0..self.pace.tick() {
            self.scene.tick(self.ink);
        }
    }

    /// Takes the scene's numbers if they are finite; else stops its time for good and says why, once. To be asked
    /// before each frame: what is drawn and reported stays at the last good one.
    #[inline(never)]
    pub fn check(&mut self) -> Result<(), Error> {
        if self.stopped {
            return Ok(());
        }
        let report = self.scene.report();
        report.state.finite().inspect_err(|_| self.stopped = true)?;
        self.report = report;
        Ok(())
    }

    /// Draws the scene over the canvas that holds its last frame, and a mark if its time stands still.
    #[inline(never)]
    pub fn draw(&self, canvas: &mut Canvas) {
        if !self.stopped {
            self.scene.draw(&self.report, self.ink, canvas);
        }
        if self.is_paused() {
            text::pause_mark(canvas);
        }
    }

    /// The scene played.
    pub fn name(&self) -> SceneName {
        self.name
    }

    /// What the scene was started with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// How the scene shows its motion, if it shows one.
    pub fn shown(&self) -> Option<Shown> {
        self.scene.shown()
    }

    /// The scene in numbers, as of the last check.
    pub fn report(&self) -> Report {
        self.report
    }

    /// Whether the scene's time stands still.
    pub fn is_paused(&self) -> bool {
        self.pace.paused || self.stopped
    }

    /// The frame as it is told to the host, but for what only the board's clock and link know.
    pub fn frame(&self) -> Frame {
        let [start_angle, _] = self.settings.angles();
        Frame {
            scene: self.name.code(),
            paused: self.is_paused().into(),
            step: self.report.step as u32,
            time: self.report.time,
            mass_ratio: self.settings.mass_ratio(),
            start_angle,
            state: self.report.state.into(),
            energy_error: self.report.energy_error,
            horizon: self.report.horizon,
            ..Frame::default()
        }
    }

    /// The answer to [`Command::Ask`].
    pub fn status(&self, request: u16) -> Status {
        let Settings { parameters, degrees, velocities } = self.settings;
        Status {
            request,
            scene: self.name.code(),
            paused: self.is_paused().into(),
            steps: self.pace.steps,
            speed: self.pace.speed as f32 / WHOLE_TICK as f32,
            parameters: [parameters.m1, parameters.m2, parameters.l1, parameters.l2, parameters.g],
            degrees,
            velocities,
        }
    }

    /// Plays what a status tells, from its start; if that cannot be, nothing is changed and the error names what is wrong.
    pub fn resume(&mut self, status: &Status) -> Result<(), Field> {
        let name = SceneName::from_code(status.scene).ok_or(Field::Scene)?;
        let [m1, m2, l1, l2, g] = status.parameters;
        let parameters = Parameters { m1, m2, l1, l2, g };
        self.start(name, Settings { parameters, degrees: status.degrees, velocities: status.velocities })?;
        let speed = ((status.speed * WHOLE_TICK as f32 + 0.5) as u32).clamp(1, GREATEST_SPEED as u32 * WHOLE_TICK);
        self.pace = Pace { paused: status.paused != 0, steps: status.steps, speed, part: 0 };
        Ok(())
    }

    fn choose(&mut self, name: SceneName) -> Result<bool, Field> {
        self.start(name, name.first_settings())
    }

    fn start(&mut self, name: SceneName, settings: Settings) -> Result<bool, Field> {
        self.scene.start(name, &settings)?;
        self.ink.clear();
        self.report = self.scene.report();
        self.stopped = false;
        self.name = name;
        self.settings = settings;
        Ok(true)
    }

    /// The settings with one of them changed; refuses an angle beyond straight up.
    fn with(&self, field: Field, value: f64) -> Result<Settings, Field> {
        let mut settings = self.settings;
        let Settings { parameters, degrees: [a1, a2], velocities: [w1, w2] } = &mut settings;
        let value = value as f32;
        match field {
            Field::M1 => parameters.m1 = value,
            Field::M2 => parameters.m2 = value,
            Field::L1 => parameters.l1 = value,
            Field::L2 => parameters.l2 = value,
            Field::G => parameters.g = value,
            Field::A1 => *a1 = value,
            Field::A2 => *a2 = value,
            Field::Angle => [*a1, *a2] = [value; 2],
            Field::W1 => *w1 = value,
            Field::W2 => *w2 = value,
            Field::MassRatio => parameters.m2 = parameters.m1 * value,
            _ => return Err(Field::Field),
        }
        let within = |degrees: f32| degrees.abs() <= GREATEST_ANGLE;
        if settings.degrees.into_iter().all(within) { Ok(settings) } else { Err(field) }
    }
}

/// How the scene's time goes.
#[derive(Clone, Copy, Debug)]
struct Pace {
    paused: bool,
    /// Ticks to do although paused.
    steps: u32,
    /// Ticks of the scene in [`WHOLE_TICK`] ticks of the clock.
    speed: u32,
    /// The part of the scene's next tick that has passed.
    part: u32,
}

impl Default for Pace {
    fn default() -> Self {
        Self { paused: false, steps: 0, speed: WHOLE_TICK, part: 0 }
    }
}

impl Pace {
    /// How many ticks the scene does in this tick of the clock.
    fn tick(&mut self) -> u32 {
        if self.paused {
            let due = self.steps.min(1);
            self.steps -= due;
            return due;
        }
        self.part += self.speed;
        let ticks = self.part / WHOLE_TICK;
        self.part %= WHOLE_TICK;
        ticks
    }

    fn pause(&mut self, paused: bool) {
        (self.paused, self.steps) = (paused, 0);
    }

    fn step(&mut self, ticks: u32) {
        (self.paused, self.steps) = (true, ticks);
    }

    fn set_speed(&mut self, speed: f64) -> Result<(), Field> {
        if !(LEAST_SPEED..=GREATEST_SPEED).contains(&speed) {
            return Err(Field::Speed);
        }
        self.speed = (speed * f64::from(WHOLE_TICK) + 0.5) as u32;
        Ok(())
    }
}
