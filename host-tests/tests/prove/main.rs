//! The enclosure: the exact motion is in it, and leaves it when any of its allowances is taken away.

mod allowances;
mod motions;
mod numbers;

use double_pendulum::{Motion, Parameters};
use firmware::scenes::SceneName;
use host_tests::commands::prove::{HEADING, horizons, known_answers};
use host_tests::oracle::known_answers::table;
use reference::enclosure::{Enclosure, Fineness, Fixed, Start};

/// Frames per second: their times are numbers of `f64`.
const RATE: u16 = 64;

/// Equal rods of 1 m that are let go at 2 rad, P1 being `p1`.
fn equal_rods(g: f64, rate: u16, p1: Fixed, fineness: Fineness) -> Enclosure {
    let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g };
    let set = Start::of(&parameters, &Motion::at_rest(2.0, 2.0)).enclose(rate);
    let mut start = set.hull().map(Fixed::middle);
    start[4] = p1;
    Enclosure::new(set.equations, set.frame, start, fineness)
}

/// Moves on by so many frames.
fn after(frames: u32, mut set: Enclosure) -> Enclosure {
    (0..frames).for_each(|_| set.advance().expect("it can be followed"));
    set
}

/// Whether two sets of numbers may have one in common, `more` apart at most.
fn meet(one: &[Fixed], other: &[Fixed], more: f64) -> bool {
    one.iter().zip(other).all(|(one, other)| (*one - *other).wider(more).is_positive().is_none())
}

#[test]
fn the_readme_has_the_table_that_the_command_makes() {
    let line = horizons(SceneName::Figure7).expect("it can be proved");
    let readme = include_str!("../../README.md");
    assert!(HEADING.lines().chain([&*line]).all(|line| readme.lines().any(|other| other == line)), "{line}");
}

#[test]
fn the_known_answers_are_those_that_the_command_makes() {
    let scene: Vec<_> = table().expect("the file").into_iter().filter(|row| row.scene == "S11").collect();
    let kept = include_str!("../../data/known_answers.csv").lines().filter(|line| line.starts_with("S11,"));
    assert_eq!(known_answers(&scene).expect("it can be proved"), kept.collect::<Vec<_>>());
}
