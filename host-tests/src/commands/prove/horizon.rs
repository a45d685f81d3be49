//! The frames a method draws, held against the exact motion.

use double_pendulum::plan::{Limit, Plan, PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters};
use firmware::config::HALF_PIXEL;
use reference::enclosure::{Fixed, Start};

/// A frame beside the exact motion.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Where the rods point, (sin, cos) each.
    exact: [[Fixed; 2]; 2],
    /// So far that may be from the middle of the box.
    width: f64,
    is_right: Option<bool>,
}

/// Every frame until one that is proved wrong, as long as the motion can be followed.
pub fn frames(
    scene: &Problem,
    start: &Start,
    stepping: Stepping,
) -> Result<impl Iterator<Item = Verdict>, Error> {
    let mut motion = PlannedRun::new(scene, stepping)?;
    let (scene, mut set, mut last) = (*scene, start.enclose(scene.rate), None);
    Ok((0..scene.frames()).map_while(move |_| {
        (last != Some(false)).then(|| set.advance())??;
        let (exact, drawn) = (set.directions(), motion.advance(1));
        let shown = || {
            motion
                .directions()
                .map(|direction| direction.map(|x| Fixed::of(x.into())))
        };
        last = drawn.map_or(Some(false), |()| {
            // Bob 2 as seen from bob 1 counts, because some scenes show curves of the angles.
            is_none_off(&are_off(&scene, &exact, &shown(), scene.tolerance))
        });
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

/// Returns true for bob 1, bob 2, and bob 2 as seen from bob 1, if it is more than `tolerance`, m, off
/// between these directions; `None` if that depends on where in the boxes they are.
fn are_off(
    scene: &Problem,
    one: &[[Fixed; 2]; 2],
    other: &[[Fixed; 2]; 2],
    tolerance: f64,
) -> [Option<bool>; 3] {
    let Parameters { l1, l2, .. } = scene.pendulum;
    // all over the longer rod, rounded
    let [l1, l2, tolerance] =
        [l1, l2, tolerance].map(|x| Fixed::of(x / l1.max(l2)).wider(f64::EPSILON));
    let off = |rod: usize, l: Fixed| [0, 1].map(|axis| (one[rod][axis] - other[rod][axis]) * l);
    let ([x1, y1], [x2, y2]) = (off(0, l1), off(1, l2));
    [[x1, y1], [x1 + x2, y1 + y2], [x2, y2]]
        .map(|[x, y]| (x * x + y * y - tolerance * tolerance).is_positive())
}

/// Returns true if none is off, `None` if that is not known.
fn is_none_off(off: &[Option<bool>]) -> Option<bool> {
    if off.contains(&Some(true)) {
        Some(false)
    } else {
        off.iter().all(Option::is_some).then_some(true)
    }
}

/// The number of frames proved right from the start on, and of those left open.
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
    /// At `time`, s: the middles of the box that the exact motion is in, how far it may be from them, and what is proved of the frame drawn.
    pub fn row(&self, time: f64) -> String {
        let middles = self
            .exact
            .as_flattened()
            .iter()
            .map(|x| x.about().to_string())
            .collect::<Vec<_>>()
            .join(",");
        let verdict = self
            .is_right
            .map_or("open", |is_right| if is_right { "right" } else { "wrong" });
        format!("{time},{middles},{:.1e},{verdict}", self.width)
    }
}

/// When two motions whose starts read the same on the panel (the mass ratio to three digits, angles to a degree) are first more than
/// the longer rod apart: from then on what the panel says of the start does not determine where a bob is.
fn told_apart(scene: &Problem) -> Option<f64> {
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
    let mut verdicts = (1..=scene.frames()).map_while(|frame| {
        one.advance().and(other.advance())?;
        let (one, other) = (one.directions(), other.directions());
        let [bob1, bob2, _] = are_off(scene, &one, &other, l1.max(l2));
        Some((frame, is_none_off(&[bob1, bob2])))
    });
    verdicts
        .find(|(_, are_near)| *are_near == Some(false))
        .map(|(frame, _)| scene.time(frame))
}

/// What is proved, a line each.
pub fn words(
    scene: &Problem,
    plan: &Result<Plan, Limit>,
    Stepping { method, steps }: Stepping,
    frames: &[Verdict],
) -> String {
    let ((right, open), end) = (counts(frames), scene.time(frames.len() as u32));
    let first = match frames.last().map(|frame| frame.is_right) {
        Some(Some(false)) => format!("wrong at {end:.3} s: more than {HALF_PIXEL} pixels off"),
        _ => format!(
            "none wrong of all {} frames, until {end:.3} s",
            frames.len()
        ),
    };
    let predicted = match plan {
        Ok(plan) => format!(
            "right until {:.3} s by {}, steps to a frame: {}",
            plan.horizon, plan.method, plan.steps
        ),
        Err(_) => String::from("no method is fast enough"),
    };
    let unknown = told_apart(scene).map_or(String::new(), |time| {
        format!("\nunknown    the numbers on the panel are too coarse to tell where a bob is after {time:.3} s")
    });
    format!(
        "method     {method}, steps to a frame: {steps}
proved     within half a pixel until {:.3} s, all {right} frames
           {first}
undecided  {open} frames
predicted  {predicted}
known      exact motion enclosed within {:.1e} at {end:.3} s{unknown}",
        scene.time(right),
        frames.last().map_or(0.0, |frame| frame.width),
    )
}
