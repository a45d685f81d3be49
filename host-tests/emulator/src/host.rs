//! Scenes and applications on the host, with the same memory as on a board.

use double_pendulum::Error;
use firmware::app::{PlannerEvent, Player};
use firmware::config::{PROCESSOR, Processor};
use firmware::graphics::{Canvas, Cells, Format};
use firmware::motion::Settings;
use firmware::protocol::Frame;
use firmware::scenes::{Report, SceneName};

use crate::qemu::Screenshot;

/// A scene that is played and drawn on the host by the code of the board.
#[derive(Debug)]
pub struct Show {
    /// The player with the scene.
    pub player: Player<'static>,
    /// The events of the planner, oldest first, each with its tick of the scene, counted from its
    /// start. At a speed above 1 it is the first of the ticks that were made at once. Events are
    /// never removed, also if a command to the player starts a scene, whose ticks begin again at 1.
    pub news: Vec<(u64, PlannerEvent)>,
}

impl Show {
    /// Starts a scene as [`Show::on`] does, on a board with the default processor: on a host, a
    /// Cortex-M3. `settings` have the angles in degrees. Errors are as there.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::on(PROCESSOR, name, settings)
    }

    /// Starts a scene as [`Show::in_format`] does, on a board with this `processor` and an OLED.
    pub fn on(processor: Processor, name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Self::in_format(Format::OLED, processor, name, settings)
    }

    /// Starts a scene as on a board with this panel and `processor`; the plan chooses the method.
    /// `settings` have the angles in degrees, also beyond 180, and the other numbers in SI units.
    /// An error means that the scene cannot show them, such as a pendulum that the kernel refuses
    /// or a number that is not finite ([`Player::play`]). A motion that is too fast for every
    /// method is no error: the scene is stopped from its start. The memory of its canvas is never
    /// freed.
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

    /// Advances the player by one tick of the clock, 1/60 s. At full speed the scene advances by
    /// one tick, at another speed by 0 to 4. While it is paused, it advances by one if a step of
    /// [`Command::Step`](firmware::protocol::Command::Step) is left, and else by none; while it is
    /// stopped, by none. If the motion is no longer finite, the scene stops and the report stays
    /// the last good one.
    pub fn tick(&mut self) {
        let Self { player, news } = self;
        let step = player.report.step + 1;
        player.tick(|one| news.push((step, one)));

        // The report contains the error of a motion that is not finite.
        let _ = player.check();
    }

    /// Returns the picture of the current state, with the mark of a pause. A stopped scene shows
    /// the reason instead.
    pub fn frame(&mut self) -> Screenshot {
        self.player.draw();
        Screenshot::from(&self.player.canvas)
    }

    /// Advances to the tick of a board's `frame` and returns the frame that the board should have
    /// sent. The fields that only the board can know are copied from `frame`: `sequence`,
    /// `dropped`, `lost`, `scene_cycles` and `busy_cycles`. A frame of an earlier tick than the
    /// current one gives the numbers of the current tick; at a speed above 1 the tick may be
    /// passed. Not checked: that `frame` is of the same scene. If the scene is paused, or stops,
    /// before that tick, this never returns.
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

    /// Returns the numbers of the scene at the current tick. After a stop they are the last good
    /// ones: from the last call of [`Show::tick`] that left the motion finite, or from the start.
    pub fn report(&self) -> Report {
        self.player.report
    }
}

/// Returns a blank canvas that lives for the rest of the program, as on a board. Its memory is never
/// freed.
pub fn canvas(format: Format) -> Canvas<'static> {
    let words = vec![0; format.words()];
    let cells = vec![Cells::NONE; format.height.into()];
    Canvas::new(format, words.leak(), cells.leak())
}
