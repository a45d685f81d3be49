//! Scenes and applications on the host, with the same memory as on a board.

use double_pendulum::Error;
use firmware::app::{PlannerEvent, Player};
use firmware::config::{PROCESSOR, Processor};
use firmware::graphics::{Canvas, FadeLayer, FrameBuffers};
use firmware::motion::Settings;
use firmware::protocol::Frame;
use firmware::scenes::{Report, SceneName};

/// A scene that is played and drawn on the host by the code of the board.
#[derive(Debug)]
pub struct Show {
    /// The player with the scene.
    pub player: Player<'static>,
    /// The events of the planner, each with its tick of the scene, counted from its start. At a
    /// speed above 1 it is the first of the ticks that were made at once. They are in ascending
    /// order and never removed.
    pub news: Vec<(u64, PlannerEvent)>,
}

impl Show {
    /// Starts a scene as on a board with the default processor. `settings` have the angles in
    /// degrees. Errors are as in [`Show::on`].
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::on(PROCESSOR, name, settings)
    }

    /// Starts a scene as on a board with this `processor`; the plan chooses the method. `settings`
    /// have the angles in degrees. An error means that the scene cannot show them, such as a
    /// pendulum that the kernel refuses or a number that is not finite. A motion that is too fast
    /// is no error: the scene is stopped from its start. The memory of the scene is never freed.
    pub fn on(processor: Processor, name: SceneName, settings: &Settings) -> Result<Self, Error> {
        let ink = Box::leak(Box::new(FadeLayer::NONE));
        let mut player = Player::new(processor, ink);
        player.play(name, *settings)?;
        Ok(Self {
            player,
            news: Vec::new(),
        })
    }

    /// Advances the player by one tick of the clock, 1/60 s. At full speed the scene advances by
    /// one tick, and while it is paused or stopped by none. If the motion is no longer finite, the
    /// scene stops and the report stays the last good one.
    pub fn tick(&mut self) {
        let Self { player, news } = self;
        let step = player.report.step + 1;
        player.tick(|one| news.push((step, one)));

        // The report contains the error of a motion that is not finite.
        let _ = player.check();
    }

    /// Returns the picture of the current state, with the mark of a pause. A stopped scene shows
    /// the reason instead.
    pub fn frame(&self) -> Canvas {
        let mut canvas = Canvas::default();
        self.player.draw(&mut canvas);
        canvas
    }

    /// Advances to the tick of a board's `frame` and returns the frame that the board should have
    /// sent. The fields that only the board can know are copied from `frame`: `sequence`,
    /// `dropped`, `lost`, `scene_cycles` and `busy_cycles`. A frame of an earlier tick than the
    /// current one gives the numbers of the current tick. A scene that has stopped or is paused
    /// must have reached that tick; else this never returns.
    pub fn expected(&mut self, frame: &Frame) -> Frame {
        while self.report().step < frame.report.step {
            self.tick();
        }
        let Frame {
            sequence,
            dropped,
            lost,
            scene_cycles,
            busy_cycles,
            ..
        } = *frame;
        Frame {
            sequence,
            dropped,
            lost,
            scene_cycles,
            busy_cycles,
            ..self.player.frame()
        }
    }

    /// Returns the numbers of the scene at the current tick. After a stop they are those of the
    /// last good one.
    pub fn report(&self) -> Report {
        self.player.report
    }
}

/// Returns blank frame buffers that live for the rest of the program, as on a board. Their memory
/// is never freed.
pub fn frame_buffers() -> &'static mut FrameBuffers {
    Box::leak(Box::new(FrameBuffers::BLANK))
}
