//! The motions that the report measures on.

use double_pendulum::{Parameters, Pendulum, State};
use firmware::config::{GRAVITY, PAGE_GRAVITY, REACH};

/// A motion from rest. Every number is one that an `f32` holds, so that all arithmetics are given the same pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    pub name: &'static str,
    pub title: &'static str,
    m2: f32,
    l1: f32,
    l2: f32,
    g: f32,
    a1: f32,
    a2: f32,
    /// How long it is followed, whole seconds: short where neighbouring motions part quickly.
    pub duration: u32,
}

/// The most states that are compared with the reference in each second.
pub const SAMPLES: u32 = 4;

const EARTH: f32 = GRAVITY as f32;
const PAGE: f32 = PAGE_GRAVITY as f32;

const SIXTH_TURN: f32 = core::f32::consts::FRAC_PI_6;
/// 171 degrees.
const FIGURE_7: f32 = 2.984_513;

#[rustfmt::skip]
const fn scene(name: &'static str, title: &'static str, m2: f32, [l1, l2]: [f32; 2], g: f32, [a1, a2]: [f32; 2], duration: u32) -> Scene {
    Scene { name, title, m2, l1, l2, g, a1, a2, duration }
}

/// Every scene; m1 = 1 kg. The first two, a regular and a chaotic one, are those of `cargo write-report --quick`.
#[rustfmt::skip]
pub const SCENES: &[Scene] = &[
    scene("regular",       "regular: 0.5/0.5 rad",              1.0,   [1.0, 1.0],   EARTH, [0.5, 0.5], 10),
    scene("chaotic",       "chaotic: 2/2 rad",                  1.0,   [1.0, 1.0],   EARTH, [2.0, 2.0], 5),
    scene("small-0.2",     "the book's figure 3: mu = 0.2",     0.2,   [0.25, 0.25], PAGE,  [0.0, SIXTH_TURN], 10),
    scene("small-1",       "the book's figure 4: mu = 1",       1.0,   [0.25, 0.25], PAGE,  [0.0, SIXTH_TURN], 10),
    scene("small-5",       "the book's figure 5: mu = 5",       5.0,   [0.25, 0.25], PAGE,  [0.0, SIXTH_TURN], 10),
    scene("figure-7",      "the book's figure 7: mu = 2.75, 171 degrees", 2.75, [1.0, 1.0], PAGE, [FIGURE_7, FIGURE_7], 3),
    scene("heavy-elbow",   "mass ratio 1/1000",                 0.001, [1.0, 1.0],   EARTH, [0.5, 0.5], 10),
    scene("light-elbow",   "mass ratio 1000",                   1e3,   [1.0, 1.0],   EARTH, [0.5, 0.5], 1),
    scene("near-upright",  "near upright: 3.1/3.1 rad",         1.0,   [1.0, 1.0],   EARTH, [3.1, 3.1], 3),
    scene("unequal-rods",  "unequal rods: 1 m, 0.5 m; mu = 2",  2.0,   [1.0, 0.5],   EARTH, [0.5, 0.5], 10),
];

/// The regular motion for ten times as long.
#[rustfmt::skip]
pub const LONG: Scene =
    scene("regular-long", "regular: 0.5/0.5 rad, 100 s",       1.0,   [1.0, 1.0],   EARTH, [0.5, 0.5], 100);

impl Scene {
    pub fn parameters(&self) -> Parameters<f64> {
        let [m2, l1, l2, g] = [self.m2, self.l1, self.l2, self.g].map(f64::from);
        Parameters { m1: 1.0, m2, l1, l2, g }
    }

    /// a1, a2 at the start, rad.
    pub fn angles(&self) -> [f64; 2] {
        [self.a1, self.a2].map(f64::from)
    }

    /// The longest step, s, that resolves every motion of the scene's energy.
    pub fn admissible_step(&self) -> f64 {
        let [a1, a2] = self.angles();
        let step = |pendulum: Pendulum<f64>| pendulum.admissible_step(&State::at_rest(a1, a2));
        Pendulum::new(&self.parameters()).and_then(step).unwrap_or(f64::NAN)
    }

    /// Pixels of the panel per metre.
    pub fn scale(&self) -> f64 {
        f64::from(REACH) / (f64::from(self.l1) + f64::from(self.l2))
    }
}
