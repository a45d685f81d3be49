//! The frames a method draws, held against the exact motion.

use std::io;

use double_pendulum::plan::{Limit, Plan, PlannedRun, Problem, Way};
use double_pendulum::{Motion, Parameters};
use firmware::config::HALF_PIXEL;
use reference::enclosure::{Enclosure, Fineness, Fixed, Start};

use crate::console::cli::Refused;

/// What is proved of a method's frames.
#[derive(Clone, Copy, Debug)]
pub struct Proof {
    way: Way,
    /// So many frames are right, from the start on.
    pub right: u32,
    wrong: Option<u32>,
    /// Frames of which neither is proved.
    pub open: u32,
    /// So many have been looked at, ...
    frames: u32,
    /// ... and so far each direction of the exact motion may then be from the middle of the box.
    width: f64,
}

impl Proof {
    /// Judges every frame until a wrong one, or as long as the motion can be followed and `goes_on`, which is told the frame, the set that the
    /// motion is in, and whether the frame is right, if that is proved.
    pub fn of(
        scene: &Problem,
        start: &Start,
        way: Way,
        mut goes_on: impl FnMut(u32, &Enclosure, Option<bool>) -> io::Result<bool>,
    ) -> anyhow::Result<Self> {
        let stepper = PlannedRun::new(&scene.pendulum, &scene.start, scene.rate, way);
        let (mut motion, mut set) =
            (stepper.map_err(Refused::because)?, start.enclose(scene.rate, Fineness::default()));
        let mut proof = Self { way, right: 0, wrong: None, open: 0, frames: 0, width: 0.0 };
        while proof.wrong.is_none() && proof.frames < scene.frames() && set.advance().is_some() {
            let has_diverged = motion.advance(1).is_err();
            let shown = motion.directions().map(|direction| direction.map(|x| Fixed::of(x.into())));
            let is_right = if has_diverged {
                Some(false)
            } else {
                set.is_right(&shown, [scene.pendulum.l1, scene.pendulum.l2], scene.tolerance)
            };
            (proof.frames, proof.width) = (proof.frames + 1, set.width());
            match is_right {
                Some(true) => proof.right += u32::from(proof.right + 1 == proof.frames),
                Some(false) => proof.wrong = Some(proof.frames),
                None => proof.open += 1,
            }
            if !goes_on(proof.frames, &set, is_right)? {
                break;
            }
        }
        Ok(proof)
    }
}

/// When two motions are more than the longer rod apart that start with the same digits on the panel: a mass ratio of three, angles to a
/// degree. Where a bob is then, these digits do not say.
fn told_apart(scene: &Problem) -> Option<f64> {
    let Parameters { m1, m2, l1, l2, .. } = scene.pendulum;
    let digit = m1 * 10_f64.powf((m2 / m1).log10().floor() - 2.0);
    let [mut one, mut other] = [-0.49, 0.49].map(|share| {
        let [a1, a2] = [scene.start.a1, scene.start.a2].map(|a| a + share * 1_f64.to_radians());
        let pendulum = Parameters { m2: m2 + share * digit, ..scene.pendulum };
        Start::of(&pendulum, &Motion { a1, a2, ..scene.start }).enclose(scene.rate, Fineness::default())
    });
    (1..=scene.frames())
        .map_while(|frame| {
            one.advance()
                .and(other.advance())
                .map(|()| (frame, one.is_right(&other.directions(), [l1, l2], l1.max(l2))))
        })
        .find(|(_, are_near)| *are_near == Some(false))
        .map(|(frame, _)| scene.time(frame))
}

/// The table's heading with `csv`.
pub const HEADING: &str = "t,sin_a1,cos_a1,sin_a2,cos_a2,radius,verdict";

/// A frame: the time, s, the middles of the box that the exact motion is in, how far it may be from them, and what is proved of the frame drawn.
pub fn row(scene: &Problem, frame: u32, set: &Enclosure, is_right: Option<bool>) -> String {
    let middles = set.directions().as_flattened().iter().map(|x| x.about().to_string()).collect::<Vec<_>>().join(",");
    let verdict = is_right.map_or("open", |is_right| if is_right { "right" } else { "wrong" });
    format!("{},{middles},{:.1e},{verdict}", scene.time(frame), set.width())
}

/// What is proved, a line each.
pub fn words(scene: &Problem, plan: &Result<Plan, Limit>, proof: &Proof) -> Vec<String> {
    let &Proof { way, right, wrong, open, frames, width } = proof;
    let of_plan = match plan {
        Ok(plan) => format!("right until {:.3} s by {}, {} to a frame", plan.horizon, plan.method.name(), plan.steps),
        Err(_) => String::from("nothing that the chip can afford is right in any frame"),
    };
    let first = match wrong {
        Some(frame) => format!("wrong at {:.3} s: more than {HALF_PIXEL} pixels off", scene.time(frame)),
        None => format!("none wrong of all {frames} frames, until {:.3} s", scene.time(frames)),
    };
    let mut lines = vec![
        format!("method     {}, {} to a frame", way.method.name(), way.steps),
        format!("proved     right to half a pixel until {:.3} s, every one of {right} frames", scene.time(right)),
        format!("           {first}"),
        format!("open       {open} frames between, neither right nor wrong by proof"),
        format!("predicted  {of_plan}"),
        format!("known      the exact motion, each direction to {width:.1e} at {:.3} s", scene.time(frames)),
    ];
    lines.extend(told_apart(scene).map(|time| {
        format!(
            "unknown    where a bob is at {time:.3} s: two motions of the digits that the panel shows are a rod apart"
        )
    }));
    lines
}
