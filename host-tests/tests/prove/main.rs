//! The enclosure: the exact motion is in it, and leaves it when any of its allowances is taken away.

mod allowances;
mod cli;
mod motions;
mod numbers;

use double_pendulum::{Motion, Parameters};
use reference::enclosure::{Constants, Enclosure, Fineness, Fixed, Number, Start};

/// Frames per second: their times are numbers of `f64`.
const RATE: u16 = 64;

/// The page's motion, from both rods at `angle`, rad.
fn page(angle: f64, fineness: Fineness) -> Enclosure {
    page_at(RATE, angle, fineness)
}

/// With other frames.
fn page_at(rate: u16, angle: f64, fineness: Fineness) -> Enclosure {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
    Start::of(&parameters, &Motion::at_rest(angle, angle)).enclose(rate, fineness)
}

/// Moves on by so many frames.
fn after(frames: u32, mut set: Enclosure) -> Enclosure {
    (0..frames).for_each(|_| set.advance().expect("it can be followed"));
    set
}

/// Whether two sets of numbers may have one in common, `more` apart at most.
fn meet(one: &[Fixed], other: &[Fixed], more: f64) -> bool {
    one.iter().zip(other).all(|(one, other)| (*one - *other).wider(more).ball().holds_zero())
}

/// The energy by M l1^2/T^2: that of the start at all times.
fn energy(set: &Enclosure) -> Fixed {
    let &Constants { upper, lower, rods, coupling, gravity: [gravity1, gravity2] } = set.constants();
    let [sin1, cos1, s, c, p1, p2] = set.hull();
    let u = (p1 - coupling * c * p2) * (upper + lower * s * s).inverse();
    let v = p2 - rods * c * u;
    let (square, cos2) = (coupling * rods.inverse(), cos1 * c + sin1 * s);
    let kinetic = ((upper + lower) * u * u + square * v * v).over(2) + coupling * u * v * c;
    kinetic - gravity1 * cos1 - square * gravity2 * cos2
}
