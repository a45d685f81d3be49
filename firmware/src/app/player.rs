//! The player: a scene with its settings, its plan and its pace.

use double_pendulum::plan::Stepping;
use double_pendulum::{Error, Method};

use crate::app::pace::Pace;
use crate::config::Processor;
use crate::display::PanelReport;
use crate::graphics::{Canvas, text};
use crate::motion::{CatchingUp, Horizon, PlanResult, Planned, Planner, Resources, Settings};
use crate::protocol::{Command, Field, Frame, PlayState, Status, in_range};
use crate::scenes::{AnyScene, Report, SceneName, too_fast};

/// An event of the planner, or of the motion that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlannerEvent {
    /// The planner has found a result: a plan, or the reason why no method fits.
    Found(PlanResult),
    /// The motion is now computed by this method and step count, at this cost of a frame, cycles of
    /// the price list. [`Player::tick`] reports it when a plan takes over. The application also logs
    /// it when a command has started a scene whose report names a method.
    Shown(Stepping, f32),
}

/// The state of the scene that is shown, and its pace.
#[derive(Debug)]
pub struct Player<'a> {
    /// The name of the scene. The public fields are for reading only; commands and ticks change
    /// them.
    pub name: SceneName,
    /// The pendulum, and its initial angles (degrees) and velocities (rad/s).
    pub settings: Settings,
    scene: AnyScene,
    /// The requested method; `None` leaves the choice to the plan. It outlasts the scene.
    method: Option<Method>,
    motion: MotionState,
    /// The number of ticks of the scene since its start.
    step: u64,
    planner: Planner,
    /// The last frame drawn.
    pub canvas: Canvas<'a>,
    pub(super) pace: Pace,
    /// The report that is drawn and sent: of the start, or of the last [`check`](Self::check).
    pub report: Report,
}

/// The state of the motion that is shown.
#[expect(
    clippy::large_enum_variant,
    reason = "without a heap there is nowhere else to keep it"
)]
#[derive(Debug)]
enum MotionState {
    /// The motion is computed by its present method. A result of the planner may replace it.
    Steady,
    /// The planned motion catches up with the current one, and then takes over. Meanwhile nothing
    /// is planned.
    Switching(CatchingUp),
    /// The motion cannot be computed. It is too fast for every method that a frame can pay for, or
    /// has left the finite numbers.
    Stopped,
}

impl<'a> Player<'a> {
    /// Creates the player for a processor of this class. It shows an empty figure until a scene is
    /// played. Its name is until then [`SceneName::Frequencies`], with the default settings, which
    /// a command such as [`Command::Restart`] starts. The pace is full speed, not paused, and no
    /// method is requested. The canvas is not cleared before a scene starts.
    pub fn new(processor: Processor, canvas: Canvas<'a>) -> Self {
        let scene = AnyScene::empty();
        let report = scene.report(0);
        Self {
            name: SceneName::Frequencies,
            settings: Settings::default(),
            scene,
            method: None,
            motion: MotionState::Steady,
            step: 0,
            planner: Planner::new(processor),
            canvas,
            pace: Pace::default(),
            report,
        }
    }

    /// Plays a scene with `settings`, whose angles are in degrees, from its start, at the present
    /// pace: a pause stays. A scene that cannot use the requested method follows its plan, also if
    /// a frame by that method costs more than the scene's budget; later scenes try the method
    /// again. A motion that is too fast for every method does not advance: the result is `Ok`, and
    /// the state [`PlayState::Stopped`].
    ///
    /// # Errors
    ///
    /// Returns the kernel's error if the settings describe no pendulum, a start that is not finite,
    /// numbers that no method can start with, or a pendulum that the scene cannot show, such as
    /// unequal rods in `figure-7` or zero gravity in `flips`. Then nothing is changed. Angles
    /// beyond straight up are not refused here. Not checked: the start in `flips`, which does not
    /// use it, and all but the mass ratio in `frequencies`.
    pub fn play(&mut self, name: SceneName, settings: Settings) -> Result<(), Error> {
        // Without a requested method, the second attempt fails as the first one did.
        self.play_by(self.method, name, settings)
            .or_else(|_| self.play_by(None, name, settings))
    }

    /// Plays a scene by `method` and no other, or by its plan. If that is impossible, nothing is
    /// changed.
    fn play_by(
        &mut self,
        method: Option<Method>,
        name: SceneName,
        settings: Settings,
    ) -> Result<(), Error> {
        let resources = Resources {
            processor: self.planner.processor,
            method,
            format: self.canvas.format,
        };
        let height = self.scene.start(name, &settings, &resources)?;

        // A pendulum that stands still needs no plan: its picture is right for ever. The linear
        // motion may move where the exact one does not.
        let stands = !name.is_linear() && settings.rests();
        self.name = name;
        self.settings = settings;
        self.step = 0;
        self.motion = if self.scene.is_too_fast() {
            MotionState::Stopped
        } else {
            MotionState::Steady
        };

        // A requested method, and that of a scene without a choice, are only verified.
        let initial = self.scene.report(0).stepping;
        let is_fixed = method.is_some() || self.scene.planned().is_none();
        let height = height.filter(|_| !self.is_stopped() && !stands);
        self.planner
            .start(&settings, height, initial.filter(|_| is_fixed));

        self.canvas.blank(name.palette());
        self.report = self.now();
        Ok(())
    }

    /// Executes a command. Returns true if a scene was started, the same or another one; false for
    /// a change of pause or speed. A command that does not concern the player, such as
    /// [`Command::Ask`], does nothing, and the result is false. So does a turn of the start angles
    /// in a scene that has none.
    ///
    /// If the command is impossible, nothing is changed, and the result is the field that is wrong:
    /// for [`Command::Set`] its own field, or [`Field::Field`] if that cannot be set; for
    /// [`Command::Method`] it is [`Field::Method`], also if a frame by the method costs too much;
    /// for the others a field of the settings, or [`Field::Dt`] if even the shortest steps are too
    /// long for extreme masses or lengths. Any other motion that is too fast for every method is
    /// not impossible: its scene starts, and is stopped.
    pub fn execute(&mut self, command: Command) -> Result<bool, Field> {
        match command {
            Command::Heavier => return self.start(self.name, self.settings.heavier()),
            Command::Lighter => return self.start(self.name, self.settings.lighter()),
            // A scene that does not depend on the angles continues.
            Command::TurnLeft | Command::TurnRight if !self.name.has_angles() => {}
            Command::TurnLeft => return self.start(self.name, self.settings.turned(-1)),
            Command::TurnRight => return self.start(self.name, self.settings.turned(1)),
            Command::Restart => return self.start(self.name, self.settings),
            Command::NextScene => return self.choose(self.name.next()),
            Command::PreviousScene => return self.choose(self.name.previous()),
            Command::Choose(name) => return self.choose(name),
            Command::Play(name, settings) => return self.start(name, in_range(settings)?),
            Command::Set {
                field: Field::Speed,
                value,
            } => self.pace.set_speed(value)?,
            Command::Method(method) => return self.go(method),
            // If the scene cannot start with the new value, report that field as the wrong one.
            Command::Set { field, value } => {
                return self
                    .start(self.name, field.set(self.settings, value)?)
                    .map_err(|_| field);
            }
            Command::Pause(paused) => self.pace.pause(paused, 0),
            Command::TogglePause => self.pace.pause(!self.pace.paused, 0),
            Command::Step(ticks) => self.pace.pause(true, ticks),
            Command::Ask
            | Command::AskPlan
            | Command::Identify
            | Command::AskRestart
            | Command::Measure(_)
            | Command::Panel(_)
            | Command::Turn(_)
            | Command::Dim(_)
            | Command::Simulate(_) => {}
        }
        Ok(false)
    }

    /// Advances by one tick of the clock, which is 0 to
    /// [`GREATEST_SPEED`](crate::config::GREATEST_SPEED) ticks of the scene, as its speed requires:
    /// none while it is stopped, and while it is paused one if a step is left. At any speed it plans
    /// for one tick of the clock.
    ///
    /// Calls `tell` with each result of the planner, and with each method that takes over. A motion
    /// that diverges is not noticed here, but by [`check`](Self::check).
    #[inline(never)] // Inlined, it takes 756 bytes of flash (M0+).
    pub fn tick(&mut self, tell: impl FnMut(PlannerEvent)) {
        if self.is_stopped() {
            return;
        }
        let due = self.pace.tick();
        if due > 0 || !self.pace.paused {
            self.advance(due, tell);
        }
    }

    /// Advances by one tick of the clock, which is `due` ticks of the scene at any speed, as
    /// [`tick`](Self::tick) does. For a host that repeats the frames of a board.
    pub fn advance(&mut self, due: u32, mut tell: impl FnMut(PlannerEvent)) {
        let [mut cost, mut other] = [0.0; 2];
        for _ in 0..due {
            self.step += 1;
            self.scene.tick(self.step, &mut self.canvas);
            cost += self.scene.cost(&self.planner.costs);
            other += self.scene.other_cost(&self.planner.costs);
        }

        // Motions beyond the budget of a frame, as at a high speed, leave less time for planning.
        let processor = self.planner.processor;
        let excess = f32::max(cost - processor.frame, 0.0) + other;
        let left = processor.look_ahead - excess;

        // Either the planned motion catches up, or the planner works.
        if let MotionState::Switching(next) = &mut self.motion {
            if self
                .scene
                .planned()
                .is_none_or(|motion| next.tick(motion, due, left))
            {
                let stepping = next.stepping();
                self.motion = MotionState::Steady;
                tell(PlannerEvent::Shown(stepping, self.cost(stepping)));
            }
            return;
        }
        if let Some(found) = self.planner.tick(self.step) {
            tell(PlannerEvent::Found(found));
            self.follow(&found, due, left);
        }
        // The next tick pays, because a board may have worked ahead in this one.
        self.planner.leave_time_for(excess);
    }

    /// Begins to switch to the method and step count of a plan, if that does not shorten the
    /// horizon. `due` and `left` are the ticks of the scene and the cycles for catching up in this
    /// tick of the clock.
    ///
    /// A plan whose horizon is past before its motion has caught up is not followed, because then
    /// that motion is as inaccurate as the current one. A plan that costs less, but has a shorter
    /// horizon than the panel has shown, is not followed either.
    fn follow(&mut self, found: &PlanResult, due: u32, left: f32) {
        let (Ok(plan), Some(simulation)) = (found, self.scene.planned()) else {
            return;
        };

        let current = simulation.motion.stepping();
        let planned = plan.stepping();
        let processor = &self.planner.processor;
        let Ok(next) = CatchingUp::new(&self.settings, planned, processor) else {
            return;
        };
        let arrival = next.arrival(self.step, due, left);
        let is_longer = plan.horizon >= self.planner.horizon(current).max(arrival);
        if planned != current && is_longer {
            self.motion = MotionState::Switching(next);
        }
    }

    /// Performs a piece of the next tick's planning in advance. Returns true if it did, so that
    /// more may be left. Returns false, without work, if the budget of that tick is spent, if
    /// nothing is left to plan, in the first ticks of a scene
    /// ([`SETTLED_TICKS`](crate::config::SETTLED_TICKS)), or if the scene is paused, stopped or
    /// switching its method.
    ///
    /// To be called after [`check`](Self::check). Then no event and no report depends on whether it
    /// is called. [`plan`](Self::plan) may have a result that is found before its tick.
    pub fn look_ahead(&mut self) -> bool {
        !self.is_still() && !self.is_switching() && self.planner.work_ahead()
    }

    /// Returns the problem of the planner and its last result, if there is one yet; `None` if the
    /// scene shows no planned motion or is too fast from its start. If the motion has diverged
    /// later, the result stays.
    pub fn plan(&self) -> Option<Planned> {
        self.planner.planned()
    }

    /// Returns the cost of computing a frame by this method and step count, cycles of the price
    /// list of the processor class. It is not measured. It is infinite for a method that is not in
    /// [`Method::DRAWN`], and 0 for a step count of 0, except for the closed form, whose cost does
    /// not depend on it.
    pub fn cost(&self, stepping: Stepping) -> f32 {
        self.planner.costs.of_frame(stepping)
    }

    /// Returns the report of the scene, with the horizon that the planner has verified.
    fn now(&self) -> Report {
        let report = self.scene.report(self.step);
        if self.is_stopped() {
            return Report {
                stepping: None,
                horizon: Horizon::Until(0.0),
                ..report
            };
        }

        let Some(stepping) = report.stepping.filter(|_| self.planner.has_task()) else {
            return report;
        };

        let verified = self.planner.horizon(stepping) as f32;
        let horizon = if self.planner.is_settled() && !self.is_switching() {
            Horizon::Until(verified)
        } else if verified >= report.time as f32 {
            Horizon::AtLeast(verified)
        } else {
            Horizon::Undecided
        };
        Report { horizon, ..report }
    }

    /// Takes the scene's report if its angles and momenta are finite, and returns false. Otherwise
    /// stops the scene, and returns true; the report stays the last good one. Of a scene that is
    /// stopped already, also from its start, nothing is taken, and the result is false. A figure
    /// without a moving pendulum never stops.
    ///
    /// If the scene has not advanced since the last report, nothing is done, and the result is
    /// false.
    ///
    /// To be called before each frame, after [`tick`](Self::tick) and before
    /// [`look_ahead`](Self::look_ahead).
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn check(&mut self) -> bool {
        // Without a tick of the scene the report stays: only work done in advance could change it.
        if self.is_stopped() || self.report.step == self.step {
            return false;
        }
        let report = self.now();
        if report.state.finite().is_err() {
            self.motion = MotionState::Stopped;
            return true;
        }
        self.report = report;
        false
    }

    /// Draws the scene in place of the last frame, with the numbers of the last
    /// [`check`](Self::check), and a mark if it is paused. If the scene is stopped, writes instead
    /// that it is too fast, for this method if one is requested and otherwise for this chip, and
    /// the mass ratio and the start angle of rod 1.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn draw(&mut self) {
        match self.state() {
            PlayState::Playing => self.scene.draw(&self.report, &mut self.canvas),
            PlayState::Paused => {
                self.scene.draw(&self.report, &mut self.canvas);
                text::pause_mark(&mut self.canvas);
            }
            PlayState::Stopped => too_fast(&self.settings, self.method, &mut self.canvas),
        }
    }

    /// Returns true if the scene does not advance on its own: it is paused, also with ticks left of
    /// a [`Command::Step`], or stopped.
    pub fn is_still(&self) -> bool {
        self.state() != PlayState::Playing
    }

    fn is_stopped(&self) -> bool {
        matches!(self.motion, MotionState::Stopped)
    }

    fn is_switching(&self) -> bool {
        matches!(self.motion, MotionState::Switching(_))
    }

    /// Returns the state of the scene's time. A stopped scene is `Stopped`, paused or not. A scene
    /// that a [`Command::Step`] advances is `Paused`.
    pub fn state(&self) -> PlayState {
        if self.is_stopped() {
            PlayState::Stopped
        } else if self.pace.paused {
            PlayState::Paused
        } else {
            PlayState::Playing
        }
    }

    /// Returns the frame message, with the report of the last [`check`](Self::check) and the start
    /// angle of rod 1 in the settings, rad, also in a scene that does not use it. The numbers that
    /// only the clock and the link of the board know are 0: `sequence`, `dropped`, `lost` and the
    /// cycles.
    pub fn frame(&self) -> Frame {
        let [start_angle, _] = self.settings.angles();
        Frame {
            scene: self.name,
            state: self.state(),
            mass_ratio: self.settings.mass_ratio(),
            start_angle: start_angle as f32,
            report: self.report,
            ..Frame::default()
        }
    }

    /// Returns the state of the player; the angles of the settings are in degrees. The state of the
    /// panel is the default. The steps left have no effect unless the player is paused.
    pub fn status(&self) -> Status {
        Status {
            scene: self.name,
            settings: self.settings,
            method: self.method,
            processor: self.planner.processor.code,
            state: self.state(),
            steps: self.pace.steps,
            speed: self.pace.speed(),
            panel: PanelReport::default(),
        }
    }

    /// Plays the scene of a status from its start, with its method, speed, pause and steps left. A
    /// scene that was stopped starts again, not paused. The processor and the panel of the status
    /// are ignored. A scene that cannot use the method follows its plan, as in
    /// [`play`](Self::play).
    ///
    /// If that is impossible, returns the field that is wrong; then nothing is changed. It is
    /// [`Field::Speed`] if the speed, rounded to hundredths, is not 0.01 to 4, and otherwise the
    /// field of the error of [`play`](Self::play), as in [`execute`](Self::execute). Angles beyond
    /// straight up are accepted.
    pub fn resume(&mut self, status: &Status) -> Result<(), Field> {
        let mut pace = Pace::default();
        pace.pause(status.state == PlayState::Paused, status.steps);
        pace.set_speed(status.speed.into())?;

        let before = core::mem::replace(&mut self.method, status.method);
        self.start(status.scene, status.settings)
            .inspect_err(|_| self.method = before)?;
        self.pace = pace;
        Ok(())
    }

    /// Starts a scene with its own initial settings. Returns true.
    fn choose(&mut self, name: SceneName) -> Result<bool, Field> {
        self.start(name, name.first_settings())
    }

    /// Starts a scene. Returns true.
    fn start(&mut self, name: SceneName, settings: Settings) -> Result<bool, Field> {
        self.play(name, settings)?;
        Ok(true)
    }

    /// Starts again by this method and no other; `None` leaves the choice to the plan.
    ///
    /// Refuses a method that the scene cannot use. Only a change of the scene or of its settings
    /// falls back to the plan.
    fn go(&mut self, method: Option<Method>) -> Result<bool, Field> {
        if method.is_some_and(|method| !Method::DRAWN.contains(&method)) {
            return Err(Field::Method);
        }
        self.play_by(method, self.name, self.settings)
            .map_err(|_| Field::Method)?;
        self.method = method;
        Ok(true)
    }
}
