//! The table of known answers, made anew from its own scenes and times.

use std::array::from_fn;
use std::f64::consts::TAU;

use anyhow::Context;

use reference::enclosure::{Ball, Enclosure, Fineness, Fixed, Given, Start, sin_cos};

const TABLE: &str = include_str!("../../../data/known_answers.csv");
/// Frames per second, 2^6: no rod of the table's turns by half a turn in one, by the bounds that its energy sets.
const RATE: u16 = 64;
/// The most digits written.
const DIGITS: i32 = 33;

/// Every line in turn. Each number is off by at most two units of its last digit; the column `growth` stays as it was.
pub fn known_answers(mut say: impl FnMut(String) -> std::io::Result<()>) -> anyhow::Result<()> {
    let (heading, rows) = TABLE.split_once('\n').context("a heading")?;
    say(heading.to_owned())?;
    let rows: Vec<Vec<&str>> = rows.lines().map(|row| row.split(',').collect()).collect();
    for scene in rows.chunk_by(|one, next| one[0] == next[0]) {
        let start = start(&scene[0]).context("a scene")?;
        let mut set = start.enclose(RATE, Fineness::default());
        let (mut angles, mut frame) = (start.angles.0.map(|angle| angle.about().to_radians()), 0);
        for row in scene {
            let end = row[10].parse::<u32>()? * u32::from(RATE);
            while frame < end {
                set.advance()?;
                (frame, angles) = (frame + 1, turned(&set, angles));
            }
            let exact = [exactly(&set, angles).map(|angle| (angle, 0)), momenta(&start, &set)];
            let exact = exact.as_flattened().iter().map(|&(x, doublings)| decimal(x, doublings)).collect::<Vec<_>>();
            say(format!("{},{},{}", row[..11].join(","), exact.join(","), row[15]))?;
        }
    }
    Ok(())
}

fn start(row: &[&str]) -> Option<Start> {
    let numbers = row[1..10].iter().map(|text| text.parse::<crate::commands::simulate::Number>().ok()?.exact());
    let &[a1, a2, w1, w2, m1, m2, l1, l2, gravity] = numbers.collect::<Option<Vec<Given>>>()?.as_slice() else {
        return None;
    };
    let (angles, velocities) = (([a1, a2], true), ([w1, w2], false));
    Some(Start { masses: [m1, m2], lengths: [l1, l2], gravity, angles, velocities })
}

/// The angles with all their turns, about, a frame after they were `before`.
fn turned(set: &Enclosure, before: [f64; 2]) -> [f64; 2] {
    let now = set.directions().map(|[sin, cos]| sin.middle.atan2(cos.middle));
    from_fn(|rod| now[rod] + TAU * ((before[rod] - now[rod]) / TAU).round())
}

/// The angles about `angles`: with d = sin(a - a0), a is a0 + d to |d|^3, for |d| <= 1/2.
fn exactly(set: &Enclosure, angles: [f64; 2]) -> [Fixed; 2] {
    let directions = set.exact_directions();
    from_fn(|rod| {
        let (about, [sin, cos]) = (Fixed::of(angles[rod]), directions[rod]);
        let [sin0, cos0] = sin_cos(about);
        let d = sin * cos0 - cos * sin0;
        let Ball { middle, radius } = d.ball();
        let cube = (middle.abs() + radius).powi(3) * 2.0;
        (about + d).wider(if cube < 0.1 { cube } else { f64::INFINITY })
    })
}

/// p1 = P1 (m1 + m2) l1^2/T and p2 = P2 m2 l2^2/T, each by a power of two, the second number.
fn momenta(start: &Start, set: &Enclosure) -> [(Fixed, i32); 2] {
    let by = start.halvings();
    let [[m1, m2], [l1, l2]] = [start.masses.map(|m| m.fixed(by)), start.lengths.map(|l| l.fixed(0))];
    let [.., p1, p2] = set.hull();
    let e = (set.constants().upper + set.constants().lower).ball().middle.log2().round() as u32;
    let doublings = by as i32 + 6 - set.unit();
    [((p1 >> e) * (m1 + m2) * l1 * l1, doublings), (p2 * m2 * l2 * l2, doublings)]
}

/// All digits of `x` by 2^`doublings` that are known, the last one to two units; no more than [`DIGITS`].
fn decimal(x: Fixed, doublings: i32) -> String {
    let (ball, scale) = (x.ball(), 2_f64.powi(doublings));
    let size = (ball.middle.abs() * scale).log10().floor() as i32 + 1;
    let (_, radius) = x.split();
    let places = (-(radius * scale).log10()).floor().min(f64::from(DIGITS - size)).max(0.0) as usize;
    let (negative, whole, digits) = x.digits(doublings, places);
    format!("{}{whole}.{digits}", if negative { "-" } else { "" })
}
