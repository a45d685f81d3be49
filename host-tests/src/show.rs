//! Scenes and applications on the host, with the memory that a board would give them.

use double_pendulum::Error;
use firmware::canvas::Canvas;
use firmware::ink::Ink;
use firmware::scene::Report;
use firmware::scenes::{AnyScene, SceneName};
use firmware::settings::Settings;
use firmware::sheets::Sheets;

/// A scene with its ink.
#[derive(Clone, Debug)]
pub struct Show {
    scene: AnyScene,
    ink: Ink,
}

impl Show {
    /// At the start; the error of a scene that cannot show `settings`.
    pub fn new(name: SceneName, settings: &Settings) -> Result<Self, Error> {
        Ok(Self { scene: AnyScene::new(name, settings)?, ink: Ink::NONE })
    }

    /// Advances by one tick.
    pub fn tick(&mut self) {
        self.scene.tick(&mut self.ink);
    }

    /// Draws the whole picture over whatever was there.
    pub fn draw(&self, canvas: &mut Canvas) {
        self.scene.draw(&self.report(), &self.ink, canvas);
    }

    /// The picture now.
    pub fn picture(&self) -> Canvas {
        let mut canvas = Canvas::default();
        self.draw(&mut canvas);
        canvas
    }

    /// The scene in numbers.
    pub fn report(&self) -> Report {
        self.scene.report()
    }
}

/// Sheets for an application that may live for ever, as those of a board do.
pub fn sheets() -> &'static mut Sheets {
    Box::leak(Box::default())
}
