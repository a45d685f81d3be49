//! The comparison of the frames that a method draws with the exact motion.

use std::sync::atomic::{AtomicUsize, Ordering};

use double_pendulum::plan::{Limit, Plan, PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters};
use exact::enclosure::{Fixed, Start, up};
use firmware::config::HALF_PIXEL;

use crate::plan::rests;
use crate::table::at_most;

/// A frame compared with the box that is proved to contain the exact motion.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// (sin, cos) of each rod.
    exact: [[Fixed; 2]; 2],
    width: f64,
    /// `None` if the box is too wide to decide.
    is_right: Option<bool>,
}

pub fn time(scene: &Problem, frame: u32) -> f64 {
    f64::from(frame) / f64::from(scene.rate)
}

/// Returns the frames after the start one by one, computed as they are requested. The sequence ends
/// after a frame that is proved wrong, when the motion can no longer be enclosed, or when `stopped`
/// is not zero. An undecided frame does not end it.
pub fn frames<'a>(
    scene: &Problem,
    start: &Start,
    stepping: Stepping,
    stopped: &'a AtomicUsize,
) -> Result<impl Iterator<Item = Verdict> + use<'a>, Error> {
    let mut motion = PlannedRun::new(scene, stepping)?;
    let scene = *scene;
    let mut set = start.enclose(scene.rate);
    let stands = start.rests();
    let mut last = None;
    Ok((0..scene.frames()).map_while(move |_| {
        let advance = || {
            if stands {
                Some(())
            } else {
                set.advance_unless(stopped)
            }
        };
        (last != Some(false)).then(advance)??;
        let exact = set.directions();
        let drawn = motion.advance(1);
        let shown = || {
            motion
                .directions()
                .map(|direction| direction.map(|x| Fixed::of(x.into())))
        };
        last = drawn.map_or(Some(false), |()| are_near(&scene, &exact, &shown()));
        let width = exact
            .as_flattened()
            .iter()
            .map(|x| x.radius())
            .fold(0.0, f64::max);
        Some(Verdict {
            exact,
            width,
            is_right: last,
        })
    }))
}

/// Returns true if both bobs, and bob 2 as seen from bob 1, are within the scene's tolerance, and
/// `None` if the boxes are too wide to decide.
fn are_near(scene: &Problem, one: &[[Fixed; 2]; 2], other: &[[Fixed; 2]; 2]) -> Option<bool> {
    let apart = are_apart(scene, one, other, scene.tolerance);
    if apart.contains(&Some(true)) {
        Some(false)
    } else {
        (apart == [Some(false); 3]).then_some(true)
    }
}

/// Returns for bob 1, bob 2, and bob 2 as seen from bob 1 true if they are more than `distance`, m,
/// apart.
fn are_apart(
    scene: &Problem,
    one: &[[Fixed; 2]; 2],
    other: &[[Fixed; 2]; 2],
    distance: f64,
) -> [Option<bool>; 3] {
    let Parameters { l1, l2, .. } = scene.pendulum;
    // The square of a longer distance can be out of the range of `Fixed`.
    let distance = distance.min(FARTHEST * l1.max(l2));

    let [l1, l2, distance] =
        [l1, l2, distance].map(|x| Fixed::of(x / l1.max(l2)).wider(f64::EPSILON));
    let off = |rod: usize, l: Fixed| [0, 1].map(|axis| (one[rod][axis] - other[rod][axis]) * l);
    let [x1, y1] = off(0, l1);
    let [x2, y2] = off(1, l2);
    [[x1, y1], [x1 + x2, y1 + y2], [x2, y2]]
        .map(|[x, y]| (x * x + y * y - distance * distance).is_positive())
}

/// Returns the frames that are proved right before the first other one, and the undecided ones.
pub fn counts(frames: &[Verdict]) -> (u32, usize) {
    let right = frames
        .iter()
        .take_while(|frame| frame.is_right == Some(true))
        .count();
    (
        right as u32,
        frames
            .iter()
            .filter(|frame| frame.is_right.is_none())
            .count(),
    )
}

impl Verdict {
    /// Returns the row of `--csv`. The radius of the box includes the rounding of the printed
    /// middles.
    pub fn row(&self, time: f64) -> String {
        let middles = self
            .exact
            .as_flattened()
            .iter()
            .map(|x| x.about().to_string())
            .collect::<Vec<_>>()
            .join(",");
        let radius = self
            .exact
            .as_flattened()
            .iter()
            .map(|x| printed_radius(*x))
            .fold(0.0, f64::max);
        let verdict = self
            .is_right
            .map_or("open", |is_right| if is_right { "right" } else { "wrong" });
        format!("{time},{middles},{},{verdict}", at_most(radius))
    }
}

/// Returns a bound for the rounding of a printed number: half a unit of its last place, both as a
/// decimal and as an `f64`.
fn printed_radius(x: Fixed) -> f64 {
    let about = x.about();
    let rounding = (x.middle() - Fixed::of(about)).size();
    up(x.radius() + rounding + about.abs() * f64::EPSILON)
}

/// Returns the time of the first frame in which two motions, whose starts look the same on the
/// panel, are more than the longer rod apart.
fn ambiguity_time(scene: &Problem, frames: u32, stopped: &AtomicUsize) -> Option<f64> {
    let Parameters { m1, m2, l1, l2, .. } = scene.pendulum;
    let digit = m1 * 10_f64.powf((m2 / m1).log10().floor() - 2.0);
    let shown = [scene.start.a1, scene.start.a2].map(|a| a.to_degrees().round());
    let [mut one, mut other] = [-0.49, 0.49].map(|share| {
        let [a1, a2] = shown.map(|degrees| (degrees + share).to_radians());
        let pendulum = Parameters {
            m2: ((m2 / digit).round() + share) * digit,
            ..scene.pendulum
        };
        Start::of(
            &pendulum,
            &Motion {
                a1,
                a2,
                ..scene.start
            },
        )
        .enclose(scene.rate)
    });

    let mut verdicts = (1..=frames).map_while(|frame| {
        one.advance_unless(stopped)?;
        other.advance_unless(stopped)?;
        let [bob1, bob2, _] = are_apart(scene, &one.directions(), &other.directions(), l1.max(l2));
        Some((frame, bob1 == Some(true) || bob2 == Some(true)))
    });
    verdicts
        .find(|(_, are_apart)| *are_apart)
        .map(|(frame, _)| time(scene, frame))
}

fn not_enclosed(scene: &Problem, frames: &[Verdict]) -> String {
    let Parameters { m1, m2, l1, l2, .. } = scene.pendulum;
    let ratio = |a: f64, b: f64| (a / b).max(b / a);
    if frames.last().is_some_and(|frame| frame.width > WIDE) {
        String::from("its enclosure has become too wide; a shorter --seconds ends before this time")
    } else if ratio(l1, l2) > LENGTHS {
        format!("rods that differ more than {LENGTHS}-fold may be out of range; change --lengths")
    } else if ratio(m1, m2) > MASSES {
        format!("bobs that differ more than {MASSES}-fold may be out of range; change --masses")
    } else {
        String::from("it is too fast for a frame; take a higher --rate or slower --velocities")
    }
}

/// A distance that no two positions of a bob have, in lengths of the longer rod.
const FARTHEST: f64 = 8.0;

const WIDE: f64 = 1e-12;

/// The ratios that keep the numbers of the equations in range ([`Start::enclose`]).
const LENGTHS: f64 = 30.0;
const MASSES: f64 = 1000.0;

/// Returns the results of the proof, one line each. The last line, [`ambiguity_time`], computes two
/// more motions, which may take as long as the proof.
pub fn words(
    scene: &Problem,
    plan: &Result<Plan, Limit>,
    Stepping { method, steps }: Stepping,
    frames: &[Verdict],
    last: &str,
    stopped: &AtomicUsize,
) -> String {
    let (right, open) = counts(frames);
    let end = time(scene, frames.len() as u32);
    let is_complete = frames.len() as u32 == scene.frames();
    let first = match frames.last().map(|frame| frame.is_right) {
        Some(Some(false)) => format!("wrong at {end:.3} s: more than {HALF_PIXEL} pixels off"),
        _ if stopped.load(Ordering::Relaxed) != 0 => {
            format!("interrupted after {} frames, at {end:.3} s", frames.len())
        }
        _ if !is_complete => format!(
            "the exact motion is not known after {end:.3} s; {}",
            not_enclosed(scene, frames)
        ),
        _ => format!(
            "no frame wrong of all {} frames, until {end:.3} s, {last}",
            frames.len()
        ),
    };

    let predicted = match plan {
        _ if rests(scene) => String::from("right for ever: at rest"),
        Ok(plan) => format!(
            "right until {:.3} s by {}, steps per frame: {}",
            plan.horizon,
            plan.method,
            plan.stepping().steps
        ),
        Err(_) => String::from("no method is fast enough"),
    };
    let from_panel =
        ambiguity_time(scene, frames.len() as u32, stopped).map_or(String::new(), |time| {
            format!(
                "\n           with only the panel's numbers (mass ratio, start angle): each bob within \
                 a rod's length until {time:.3} s"
            )
        });

    let known = frames.last().map_or_else(
        || String::from("the start only"),
        |frame| {
            let width = at_most(frame.width);
            format!("sine and cosine of each exact angle within {width} at {end:.3} s")
        },
    );
    format!(
        "method     {method}, steps per frame: {steps}
proved     within half a pixel until {:.3} s, all {right} frames
           {first}
undecided  {open} {}
predicted  {predicted}
known      {known}{from_panel}",
        time(scene, right),
        if open == 1 { "frame" } else { "frames" },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    use boards::console::number::Number;

    fn scene() -> Problem {
        Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
            start: Motion::at_rest(2.0, 2.0),
            tolerance: 0.5,
            duration: 20.0,
            rate: 1,
        }
    }

    fn rods(angles: [f64; 2]) -> [[Fixed; 2]; 2] {
        angles.map(|a| [a.sin(), a.cos()].map(Fixed::of))
    }

    #[test]
    fn bob_2_is_judged_as_seen_from_bob_1_as_well() {
        // Only as seen from bob 1 is bob 2 too far away.
        let [one, other] = [[0.0, 0.0], [0.4, -0.6]].map(rods);

        let near = |tolerance| {
            let scene = Problem {
                tolerance,
                ..scene()
            };
            are_near(&scene, &one, &other)
        };

        assert_eq!(near(0.5), Some(false));
        assert_eq!(near(0.61), Some(true));

        // Each error is near, but bob 2 has both.
        let [one, other] = [[0.0, 0.0], [0.4, 0.4]].map(rods);
        assert_eq!(are_near(&scene(), &one, &other), Some(false), "bob 2");

        let wide = one.map(|rod| rod.map(|x| x.wider(0.5)));
        assert_eq!(are_near(&scene(), &one, &wide), None);
    }

    #[test]
    fn no_frame_is_wrong_by_more_than_the_circle() {
        let [one, other] = [[0.0, 0.0], [PI, PI]].map(rods);
        for tolerance in [3.9, 4.1, 8.0, 15.9, 16.1, 1e3, 1e300] {
            let scene = Problem {
                tolerance,
                ..scene()
            };
            let is_right = tolerance > 4.0;
            assert_eq!(
                are_near(&scene, &one, &other),
                Some(is_right),
                "{tolerance}"
            );
        }
    }

    #[test]
    fn the_printed_box_contains_the_exact_motion() {
        // Fractions with short and long decimals, of either sign.
        for (above, below) in [
            (1, 3),
            (-2, 7),
            (1, 1),
            (123_456_789, 987_654_321),
            (1, 1000),
        ] {
            for width in [0.0, 1e-33, 3e-17, 2e-9] {
                let x = Fixed::fraction(above, below, 0).wider(width);
                let text = x.about().to_string();
                let decimal: Number = text.parse().expect("a decimal");
                let (above, below) = decimal.exact().expect("few digits");
                let radius: f64 = at_most(printed_radius(x)).parse().expect("a bound");
                for middle in [Fixed::fraction(above, below, 0), Fixed::of(decimal.value())] {
                    for end in [-1.0, 1.0].map(|side| x.middle() + Fixed::of(side * x.radius())) {
                        let inside = (end - middle).size() <= radius;
                        assert!(inside, "{text} within {radius:e} of {end:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn an_interruption_ends_every_search_at_once() {
        let scene = scene();
        let start = Start::of(&scene.pendulum, &scene.start);
        let stepping = Stepping {
            method: double_pendulum::Method::Rk4F32Direction,
            steps: 256,
        };

        let [running, stopped] = [0, 15].map(AtomicUsize::new);
        let first = |stopped| {
            frames(&scene, &start, stepping, stopped)
                .expect("a motion")
                .next()
        };
        assert!(first(&running).is_some());
        assert!(first(&stopped).is_none());

        let parted = |frames, stopped| ambiguity_time(&scene, frames, stopped);
        let time = parted(scene.frames(), &running).expect("they part");
        assert_eq!(parted(time as u32, &running), Some(time));
        assert_eq!(parted(time as u32 - 1, &running), None);
        assert_eq!(parted(scene.frames(), &stopped), None);
    }
}
