//! Scenes and applications on the host, with the same memory as on a board.

use double_pendulum::Error;
use firmware::app::{PlannerEvent, Player};
use firmware::config::{PROCESSOR, Processor};
use firmware::graphics::{Canvas, FadeLayer, FrameBuffers};
use firmware::motion::Settings;
use firmware::protocol::Frame;
use firmware::scenes::{Report, SceneName};

#[derive(Debug)]
pub struct Show {
    pub player: Player<'static>,
    /// The events of the planner, each with its tick.
    pub news: Vec<(u64, PlannerEvent)>,
}

impl Show {
    /// Starts a scene. Returns an error if the scene cannot show `settings`.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::on(PROCESSOR, name, settings)
    }

    /// Starts a scene as on a board with this `processor`.
    pub fn on(processor: Processor, name: SceneName, settings: &Settings) -> Result<Self, Error> {
        let ink = Box::leak(Box::new(FadeLayer::NONE));
        let mut player = Player::new(processor, ink);
        player.play(name, *settings)?;
        Ok(Self {
            player,
            news: Vec::new(),
        })
    }

    pub fn tick(&mut self) {
        let Self { player, news } = self;
        let step = player.report.step + 1;
        player.tick(|one| news.push((step, one)));

        // The report contains the error of a motion that is not finite.
        let _ = player.check();
    }

    pub fn frame(&self) -> Canvas {
        let mut canvas = Canvas::default();
        self.player.draw(&mut canvas);
        canvas
    }

    /// Advances to the tick of a board's `frame` and returns the frame that the board should have
    /// sent. The fields that only the board can know are copied from `frame`.
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

    pub fn report(&self) -> Report {
        self.player.report
    }
}

/// Returns frame buffers that live for the rest of the program, as on a board.
pub fn frame_buffers() -> &'static mut FrameBuffers {
    Box::leak(Box::new(FrameBuffers::BLANK))
}
