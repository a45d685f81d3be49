//! Scenes and applications on the host, with the memory that a board would give them.

use double_pendulum::Error;
use firmware::graphics::canvas::Canvas;
use firmware::graphics::fade_layer::FadeLayer;
use firmware::graphics::frame_buffers::FrameBuffers;
use firmware::motion::settings::Settings;
use firmware::scenes::scene::Report;
use firmware::scenes::{AnyScene, SceneName};

/// A scene with its ink.
#[derive(Clone, Debug)]
pub struct Show {
    scene: AnyScene,
    ink: FadeLayer,
}

impl Show {
    /// At the start; the error of a scene that cannot show `settings`.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Ok(Self { scene: AnyScene::new(name, settings)?, ink: FadeLayer::NONE })
    }

    /// Advances by one tick.
    pub fn tick(&mut self) {
        self.scene.tick(&mut self.ink);
    }

    /// Draws the whole frame over whatever was there.
    pub fn draw(&self, canvas: &mut Canvas) {
        self.scene.draw(&self.report(), &self.ink, canvas);
    }

    /// The frame now.
    pub fn frame(&self) -> Canvas {
        let mut canvas = Canvas::default();
        self.draw(&mut canvas);
        canvas
    }

    /// The scene in numbers.
    pub fn report(&self) -> Report {
        self.scene.report()
    }
}

/// FrameBuffers for an application that may live for ever, as those of a board do.
pub fn sheets() -> &'static mut FrameBuffers {
    Box::leak(Box::default())
}
