//! The comparison of the frames that a method draws with the exact motion.

use std::sync::atomic::{AtomicUsize, Ordering};

use double_pendulum::plan::{Limit, Plan, PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters};
use firmware::config::HALF_PIXEL;
use reference::enclosure::{Fixed, Start, up};

use crate::commands::table::at_most;

/// A frame compared with the exact motion. The exact motion is known to be in a box: each number of
/// the directions is known up to a radius. The frame is proved right, proved wrong, or undecided,
/// because the box is too wide. It is right if both bobs, and bob 2 as seen from bob 1, are within
/// the tolerance of the scene ([`Problem::tolerance`]).
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// The box: the directions of the rods, (sin, cos) each, with their radii.
    exact: [[Fixed; 2]; 2],
    /// The largest radius of the box. It has no unit, as the directions.
    width: f64,
    /// True if the drawn frame is proved to be within the tolerance, false if it is proved not to
    /// be, `None` if the box is too wide to decide.
    is_right: Option<bool>,
}

/// Returns the time of frame `frame` of the scene, s since the start, which is frame 0. The frame
/// may be after the scene's end. Not checked: the scene's rate is not 0.
pub fn time(scene: &Problem, frame: u32) -> f64 {
    f64::from(frame) / f64::from(scene.rate)
}

/// Returns the frames after the start one by one, at most `scene.frames()` of them. The sequence
/// ends after a frame that is proved wrong, when the motion can no longer be enclosed, or when
/// `stopped` is not zero. A drawn motion that diverges counts as proved wrong. After an undecided
/// frame the sequence continues.
///
/// Each frame is computed when it is requested. The drawn motion is that of `scene`, by the method
/// and steps per frame of `stepping`, where 0 steps count as 1; the exact motion begins at `start`.
/// An error means that the method does not accept the scene or the step, so that nothing is drawn.
/// Not checked: `start` must be the start of `scene`.
pub fn frames<'a>(
    scene: &Problem,
    start: &Start,
    stepping: Stepping,
    stopped: &'a AtomicUsize,
) -> Result<impl Iterator<Item = Verdict> + use<'a>, Error> {
    let mut motion = PlannedRun::new(scene, stepping)?;
    let scene = *scene;
    let mut set = start.enclose(scene.rate);
    // The enclosure of a pendulum that stands upright would grow all the same.
    let rests = start.rests();
    let mut last = None;
    Ok((0..scene.frames()).map_while(move |_| {
        let advance = || {
            if rests {
                Some(())
            } else {
                set.advance_unless(stopped)
            }
        };
        (last != Some(false)).then(advance)??;
        // The exact motion and the drawn motion advance by one frame each.
        let exact = set.directions();
        let drawn = motion.advance(1);
        let shown = || {
            motion
                .directions()
                .map(|direction| direction.map(|x| Fixed::of(x.into())))
        };
        // A drawn motion that diverges is wrong.
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

/// Returns true if the positions by these two sets of directions are within the scene's tolerance
/// of each other ([`Problem::tolerance`]). This applies to both bobs, and to bob 2 as seen from bob
/// 1.
///
/// Returns `None` if the result depends on the positions of the directions in their boxes.
fn are_near(scene: &Problem, one: &[[Fixed; 2]; 2], other: &[[Fixed; 2]; 2]) -> Option<bool> {
    // One bob that is too far away is enough to be wrong; all must be near to be right.
    let apart = are_apart(scene, one, other, scene.tolerance);
    if apart.contains(&Some(true)) {
        Some(false)
    } else {
        (apart == [Some(false); 3]).then_some(true)
    }
}

/// Returns for bob 1, bob 2, and bob 2 as seen from bob 1 true if they are more than `distance`, m,
/// apart in these directions. An element is `None` if it depends on the positions of the directions
/// in their boxes.
fn are_apart(
    scene: &Problem,
    one: &[[Fixed; 2]; 2],
    other: &[[Fixed; 2]; 2],
    distance: f64,
) -> [Option<bool>; 3] {
    let Parameters { l1, l2, .. } = scene.pendulum;
    // No two positions are so far apart. The square of a longer distance can be out of the range
    // of `Fixed`.
    let distance = distance.min(FARTHEST * l1.max(l2));

    // All lengths are divided by the length of the longer rod, and rounded.
    let [l1, l2, distance] =
        [l1, l2, distance].map(|x| Fixed::of(x / l1.max(l2)).wider(f64::EPSILON));
    let off = |rod: usize, l: Fixed| [0, 1].map(|axis| (one[rod][axis] - other[rod][axis]) * l);
    let [x1, y1] = off(0, l1);
    let [x2, y2] = off(1, l2);
    [[x1, y1], [x1 + x2, y1 + y2], [x2, y2]]
        .map(|[x, y]| (x * x + y * y - distance * distance).is_positive())
}

/// Returns the number of frames that are proved right before the first other one, and the number of
/// undecided frames among all.
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
    /// Returns the row of the frame at `time`, s, without a newline. Its cells, with commas between
    /// them, are the time, the middles of the box that contains the exact motion (sin a1, cos a1,
    /// sin a2, cos a2), the largest radius of the box, and the verdict: "right", "wrong", or "open"
    /// if the frame is not decided.
    ///
    /// The box refers to the printed numbers, read as decimals or as `f64`: its radius includes the
    /// rounding of the middles and is rounded up to two digits.
    pub fn row(&self, time: f64) -> String {
        let middles = self
            .exact
            .as_flattened()
            .iter()
            .map(|x| x.about().to_string())
            .collect::<Vec<_>>()
            .join(",");
        // The largest radius of the box, including the rounding of the printed middles.
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

/// Returns the distance from the shortest decimal of the `f64` next to the middle, and from that
/// `f64`, within which the true number is.
///
/// The decimal is at most half a unit of the last place, 2^-53 of itself, from the `f64`.
fn printed_radius(x: Fixed) -> f64 {
    let about = x.about();
    let rounding = (x.middle() - Fixed::of(about)).size();
    up(x.radius() + rounding + about.abs() * f64::EPSILON)
}

/// Returns the time after which the panel's numbers do not determine the position of a bob.
///
/// This is the time of the first frame with two motions more than the longer rod apart, although
/// their starts look the same on the panel (the mass ratio to three digits, angles to a degree).
/// Only the first `frames` frames are searched, until `stopped`. `None` means that no such frame
/// was found.
fn ambiguity_time(scene: &Problem, frames: u32, stopped: &AtomicUsize) -> Option<f64> {
    let Parameters { m1, m2, l1, l2, .. } = scene.pendulum;
    // One unit of the third digit of the mass ratio.
    let digit = m1 * 10_f64.powf((m2 / m1).log10().floor() - 2.0);
    let shown = [scene.start.a1, scene.start.a2].map(|a| a.to_degrees().round());
    // Two starts near opposite ends of the range that rounds to the same digits.
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

/// Returns the reason why the motion is not enclosed further, and the option to change.
fn not_enclosed(scene: &Problem, frames: &[Verdict]) -> String {
    let Parameters { m1, m2, l1, l2, .. } = scene.pendulum;
    let ratio = |a: f64, b: f64| (a / b).max(b / a);
    // The likeliest cause first.
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

/// A distance that no two positions of a bob have, in lengths of the longer rod: twice the diameter
/// of the largest circle.
const FARTHEST: f64 = 8.0;

/// The width of a box beyond which the width is the reason that the enclosure ends.
const WIDE: f64 = 1e-12;

/// The ratios of lengths and of masses that keep the numbers of the equations in range
/// ([`Start::enclose`]).
const LENGTHS: f64 = 30.0;
const MASSES: f64 = 1000.0;

/// Returns the results of the proof, one line each, without a newline at the end: the method, the
/// proved frames, the reason why the sequence ended, the undecided frames, the prediction of
/// `plan`, and the width of the last box. Times are in s since the start. `frames` are all frames
/// of [`frames`], and `stopped` is its argument.
///
/// A last line, "unknown", has the time after which the numbers on the panel do not determine the
/// motion: two motions, whose mass ratios look the same to three digits and whose angles look the
/// same to a degree, are then farther apart than the longer rod. To find it, this computes both
/// motions, which may take as long as the proof. The line is absent if that does not happen within
/// `frames`, or if `stopped` is not zero before.
pub fn words(
    scene: &Problem,
    plan: &Result<Plan, Limit>,
    Stepping { method, steps }: Stepping,
    frames: &[Verdict],
    stopped: &AtomicUsize,
) -> String {
    let (right, open) = counts(frames);
    let end = time(scene, frames.len() as u32);
    let is_complete = frames.len() as u32 == scene.frames();
    // The reason why the sequence of frames has ended.
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
            "no frame wrong of all {} frames, until {end:.3} s",
            frames.len()
        ),
    };

    // The prediction of the board, for comparison.
    let predicted = match plan {
        Ok(plan) => format!(
            "right until {:.3} s by {}, steps per frame: {}",
            plan.horizon,
            plan.method,
            plan.stepping().steps
        ),
        Err(_) => String::from("no method is fast enough"),
    };
    let unknown =
        ambiguity_time(scene, frames.len() as u32, stopped).map_or(String::new(), |time| {
            format!(
                "\nunknown    the numbers on the panel are too coarse to tell where a bob is \
                 after {time:.3} s"
            )
        });

    let known = frames.last().map_or_else(
        || String::from("the start only"),
        |frame| {
            let width = at_most(frame.width);
            format!("exact motion enclosed within {width} at {end:.3} s")
        },
    );
    format!(
        "method     {method}, steps per frame: {steps}
proved     within half a pixel until {:.3} s, all {right} frames
           {first}
undecided  {open} {}
predicted  {predicted}
known      {known}{unknown}",
        time(scene, right),
        if open == 1 { "frame" } else { "frames" },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    use console::number::Number;

    /// Returns a scene with two rods of 1 m, let go at 2 rad, with a frame of 1 s and a tolerance
    /// of half a metre.
    fn scene() -> Problem {
        Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
            start: Motion::at_rest(2.0, 2.0),
            tolerance: 0.5,
            duration: 20.0,
            rate: 1,
        }
    }

    /// Returns the directions of rods at these angles, rad.
    fn rods(angles: [f64; 2]) -> [[Fixed; 2]; 2] {
        angles.map(|a| [a.sin(), a.cos()].map(Fixed::of))
    }

    /// A frame is wrong if bob 1, bob 2, or bob 2 as seen from bob 1 is too far off, even if the
    /// other two are near. It is undecided if the boxes allow both results.
    #[test]
    fn bob_2_is_judged_as_seen_from_bob_1_as_well() {
        // Rod 1 has moved by 0.4 m, rod 2 back by 0.6 m. Only as seen from bob 1 is bob 2 too far
        // away.
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

        // Both rods have moved the same way. Each error is near, but bob 2 has both.
        let [one, other] = [[0.0, 0.0], [0.4, 0.4]].map(rods);
        assert_eq!(are_near(&scene(), &one, &other), Some(false), "bob 2");

        // Boxes that are half a unit wide allow both results.
        let wide = one.map(|rod| rod.map(|x| x.wider(0.5)));
        assert_eq!(are_near(&scene(), &one, &wide), None);
    }

    /// If half a pixel is more than the whole circle, every frame is right.
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

    /// The printed box contains the ends of the ball, both if its middle is read as a decimal and
    /// as an `f64`.
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
                // The exact number is within `width` of the fraction.
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

    /// After a signal, the proof has no frame, and the search for motions that look the same on the
    /// panel finds nothing. Without a signal, the latter finds a time, and only within the given
    /// number of frames.
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

        // The motions with the same digits on the panel separate after some seconds, and later
        // frames are not searched.
        let parted = |frames, stopped| ambiguity_time(&scene, frames, stopped);
        let time = parted(scene.frames(), &running).expect("they part");
        assert_eq!(parted(time as u32, &running), Some(time));
        assert_eq!(parted(time as u32 - 1, &running), None);
        assert_eq!(parted(scene.frames(), &stopped), None);
    }
}
