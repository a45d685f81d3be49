//! The enclosure: the exact motion is in it, and leaves it when any of its allowances is taken away.

mod allowances;
mod commands;
mod motions;
mod numbers;

use double_pendulum::{Motion, Parameters};
use reference::enclosure::{Enclosure, Fineness, Fixed, Start};

/// Frames per second: their times are numbers of `f64`.
const RATE: u16 = 64;

/// Equal rods of 1 m, let go at `angle`, rad.
fn equal_rods(angle: f64, g: f64, rate: u16, fineness: Fineness) -> Enclosure {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g };
    Start::of(&parameters, &Motion::at_rest(angle, angle)).enclose(rate, fineness)
}

/// Moves on by so many frames.
fn after(frames: u32, mut set: Enclosure) -> Enclosure {
    (0..frames).for_each(|_| set.advance().expect("it can be followed"));
    set
}

/// Whether two sets of numbers may have one in common, `more` apart at most.
fn meet(one: &[Fixed], other: &[Fixed], more: f64) -> bool {
    one.iter().zip(other).all(|(one, other)| (*one - *other).wider(more).holds_zero())
}
