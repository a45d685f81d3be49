//! The enclosure: the exact motion is in it, and leaves it when any of its allowances is taken away.

mod allowances;
mod motions;
mod numbers;
mod tables;

use double_pendulum::{Motion, Parameters};
use reference::enclosure::{Enclosure, Fineness, Fixed, Start};

/// Frames per second: their times are numbers of `f64`.
const RATE: u16 = 64;

/// Equal rods of 1 m that are let go at 2 rad, P1 being `p1`.
fn equal_rods(g: f64, rate: u16, p1: Fixed, fineness: Fineness) -> Enclosure {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g };
    let set = Start::of(&parameters, &Motion::at_rest(2.0, 2.0)).enclose(rate);
    let mut start = set.hull().map(Fixed::middle);
    start[4] = p1;
    Enclosure::new(set.constants, set.frame, start, fineness)
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
