//! Scenes and applications on the host, with the memory that a board would give them.

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
    /// What planning has found, and the tick.
    pub news: Vec<(u64, PlannerEvent)>,
}

impl Show {
    /// At the start; the error of a scene that cannot show `settings`.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::on(PROCESSOR, name, settings)
    }

    /// The same as a board of this class plays it.
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
        // What is not finite is told by the report.
        let _ = player.check();
    }

    pub fn frame(&self) -> Canvas {
        let mut canvas = Canvas::default();
        self.player.draw(&mut canvas);
        canvas
    }

    /// Goes on to the tick of a board's `frame`: what the board should have sent, but for what only it can know.
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

/// Frame buffers for an application that may live for ever, as those of a board do.
pub fn sheets() -> &'static mut FrameBuffers {
    Box::leak(Box::new(FrameBuffers::BLANK))
}
