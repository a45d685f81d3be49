//! The catalogue of scenes: one row each gives the name, what it is and what it starts with.

mod beats;
mod butterfly;
mod figure7;
pub mod flips;
mod frequencies;
mod page;
mod scene;
mod small;
mod upright;

pub use flips::Flips;
pub use scene::{Report, Scene};

use double_pendulum::Error;

use crate::graphics::{Canvas, FadeLayer};
use crate::motion::{Means, Settings, Simulation};

macro_rules! catalogue {
    ($($(#[$doc:meta])* $row:ident = $name:literal, $scene:ty, $first:expr;)*) => {
        choice! {
            SceneName { $($(#[$doc])* $row = $name;)* }
        }

        impl SceneName {
            /// What it starts with when it is chosen.
            pub fn first_settings(self) -> Settings {
                match self { $(Self::$row => $first,)* }
            }
        }

        #[expect(clippy::large_enum_variant, reason = "without a heap there is nowhere else to keep it")]
        #[derive(Clone, Debug)]
        pub enum AnyScene { $($(#[$doc])* $row($scene),)* }

        impl AnyScene {
            /// The scene `name` at the start; the error of a scene that cannot show `settings`.
            pub fn new(name: SceneName, settings: &Settings, means: &Means) -> Result<Self, Error> {
                match name { $(SceneName::$row => <$scene>::new(settings, means).map(Self::$row),)* }
            }

            /// Starts the scene `name` in the place of this one; if it cannot show `settings`, this one goes on.
            pub fn start(&mut self, name: SceneName, settings: &Settings, means: &Means) -> Result<(), Error> {
                match name { $(SceneName::$row => self.become_one(settings, means, Self::$row),)* }
            }

            /// Advances by one tick, as [`Scene::tick`]; the ink, which was clear at the start, fades.
            pub fn tick(&mut self, ink: &mut FadeLayer) {
                let fading = match self { $(Self::$row(scene) => { scene.tick(ink); <$scene>::FADING })* };
                ink.fade(fading);
            }

            /// Draws the whole frame over what was there; `report` is the scene's, as of now.
            pub fn draw(&self, report: &Report, ink: &FadeLayer, canvas: &mut Canvas) {
                canvas.clone_from(&ink.frame);
                match self { $(Self::$row(scene) => scene.draw(report, canvas),)* }
            }

            pub fn height(&self) -> Option<f32> {
                match self { $(Self::$row(scene) => scene.height(),)* }
            }

            pub fn planned(&mut self) -> Option<&mut Simulation> {
                match self { $(Self::$row(scene) => scene.planned(),)* }
            }

            pub fn report(&self) -> Report {
                match self { $(Self::$row(scene) => scene.report(),)* }
            }
        }
    };
}

catalogue! {
    /// The page's animation.
    Page = "page", page::Page, Settings::default();
    /// Figure 3: small oscillations, mass ratio 0.2.
    SmallLight = "small-0.2", small::Small, small::example(0.2);
    /// Figure 4: small oscillations, mass ratio 1.
    SmallEqual = "small-1", small::Small, small::example(1.0);
    /// Figure 5: small oscillations, mass ratio 5.
    SmallHeavy = "small-5", small::Small, small::example(5.0);
    /// Figure 2: frequencies over the mass ratio.
    Frequencies = "frequencies", frequencies::Frequencies, Settings::default();
    /// Frequencies as 3 to 2: mass ratio 25/144.
    Beats3To2 = "beats-3-2", beats::Beats, beats::closing(25.0 / 144.0);
    /// Frequencies as 2 to 1: mass ratio 9/16.
    Beats2To1 = "beats-2-1", beats::Beats, beats::closing(9.0 / 16.0);
    /// Frequencies as 5 to 2: mass ratio 441/400.
    Beats5To2 = "beats-5-2", beats::Beats, beats::closing(441.0 / 400.0);
    /// Frequencies as 3 to 1: mass ratio 16/9.
    Beats3To1 = "beats-3-1", beats::Beats, beats::closing(16.0 / 9.0);
    /// Figure 7: the right equations and the misprinted ones.
    Figure7 = "figure-7", figure7::Figure7, figure7::figure();
    /// Twins a millionth of a radian apart.
    Butterfly = "butterfly", butterfly::Butterfly, Settings::default();
    /// Both rods at exactly 180 degrees.
    Upright = "upright", upright::Upright, upright::straight_up();
    /// From which starts a rod turns over, and when.
    Flips = "flips", flips::Flips, Settings::default();
}

impl AnyScene {
    /// An empty figure, until a scene is started in its place.
    pub fn empty() -> Self {
        Self::Frequencies(frequencies::Frequencies::default())
    }

    #[inline(never)] // the scenes of all the catalogue would stand side by side on the stack of who chooses one
    fn become_one<S: Scene>(&mut self, settings: &Settings, means: &Means, one: fn(S) -> Self) -> Result<(), Error> {
        *self = one(S::new(settings, means)?);
        Ok(())
    }
}

impl SceneName {
    /// Whether it shows a motion, which starts from two angles.
    pub fn has_angles(self) -> bool {
        !matches!(self, Self::Frequencies | Self::Flips)
    }

    /// The next one in the catalogue; after the last the first.
    pub fn next(self) -> Self {
        self.turned(1)
    }

    /// The one before; before the first the last.
    pub fn previous(self) -> Self {
        self.turned(Self::ALL.len() - 1)
    }

    fn turned(self, by: usize) -> Self {
        let place = Self::ALL.iter().position(|&name| name == self).unwrap_or_default();
        Self::ALL.iter().copied().cycle().nth(place + by).unwrap_or(self)
    }
}
