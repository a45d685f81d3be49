//! The motions that the report measures on: equal rods and bobs from rest.

use double_pendulum::{Parameters, Pendulum, State};
use firmware::config::{GRAVITY, REACH};

/// Every number is one that an `f32` holds, so that all arithmetics are given the same pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    pub name: &'static str,
    pub title: &'static str,
    /// Both angles at the start, rad.
    angle: f64,
    /// How long it is followed, whole seconds: short where neighbouring motions part quickly.
    pub duration: u32,
}

/// The most states that are compared with the reference in each second.
pub const SAMPLES: u32 = 4;

/// A regular and a chaotic one.
pub const SCENES: [Scene; 2] = [
    Scene { name: "regular", title: "regular: 0.5/0.5 rad", angle: 0.5, duration: 10 },
    Scene { name: "chaotic", title: "chaotic: 2/2 rad", angle: 2.0, duration: 5 },
];
/// The regular motion for ten times as long.
pub const LONG: Scene =
    Scene { name: "regular-long", title: "regular: 0.5/0.5 rad, 100 s", duration: 100, ..SCENES[0] };

impl Scene {
    pub fn parameters(&self) -> Parameters<f64> {
        Parameters::equal_rods(1.0, 1.0, (GRAVITY as f32).into())
    }

    /// a1, a2 at the start, rad.
    pub fn angles(&self) -> [f64; 2] {
        [self.angle; 2]
    }

    /// The longest step, s, that resolves every motion of the scene's energy.
    pub fn admissible_step(&self) -> f64 {
        let step = |pendulum: Pendulum<f64>| pendulum.admissible_step(&State::at_rest(self.angle, self.angle));
        Pendulum::new(&self.parameters()).and_then(step).unwrap_or(f64::NAN)
    }

    /// Pixels of the panel per metre.
    pub fn scale(&self) -> f64 {
        f64::from(REACH) / 2.0
    }
}
