//! Scenes and applications on the host, with the same memory as on a board.

use double_pendulum::Error;
use firmware::app::{PlannerEvent, Player};
use firmware::config::{PROCESSOR, Processor};
use firmware::graphics::{Canvas, Cells, Format};
use firmware::motion::Settings;
use firmware::protocol::Frame;
use firmware::scenes::{Report, SceneName};

use crate::qemu::Screenshot;

#[derive(Debug)]
pub struct Show {
    pub player: Player<'static>,
    /// The events of the planner, each with its tick of the scene. At a speed above 1 it is the
    /// first of the ticks that were made at once.
    pub news: Vec<(u64, PlannerEvent)>,
}

impl Show {
    /// Starts a scene on a board with the default processor and an OLED.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::on(PROCESSOR, name, settings)
    }

    pub fn on(processor: Processor, name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::in_format(Format::OLED, processor, name, settings)
    }

    /// The memory of the canvas is never freed.
    pub fn in_format(
        format: Format,
        processor: Processor,
        name: SceneName,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let mut player = Player::new(processor, canvas(format));
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

        let _ = player.check();
    }

    /// Advances by one tick of the clock and `due` ticks of the scene, at any speed.
    pub fn advance(&mut self, due: u32) {
        let Self { player, news } = self;
        let step = player.report.step + 1;
        player.advance(due, |one| news.push((step, one)));

        let _ = player.check();
    }

    pub fn frame(&mut self) -> Screenshot {
        self.player.draw();
        Screenshot::from(&self.player.canvas)
    }

    /// Returns the frame that the board should have sent. The fields that only the board can know
    /// are copied.
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

/// The memory is never freed, as on a board.
pub fn canvas(format: Format) -> Canvas<'static> {
    let layers = [(); 2].map(|()| vec![0; format.words()].leak());
    let cells = vec![Cells::NONE; format.height.into()];
    Canvas::new(format, layers, cells.leak())
}
