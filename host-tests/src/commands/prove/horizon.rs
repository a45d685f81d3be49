//! The frames a method draws, held against the exact motion.

use double_pendulum::plan::{Limit, Plan, Problem, Way, WayStepper};
use double_pendulum::{Error, Motion, Parameters};
use firmware::config::HALF_PIXEL;
use reference::enclosure::{Enclosure, Fineness, Fixed, Start};

/// What is proved of a method's frames.
#[derive(Clone, Debug)]
pub struct Proof {
    way: Way,
    motion: WayStepper,
    /// So many frames are right, from the start on.
    pub right: u32,
    wrong: Option<u32>,
    /// Frames until then, or until now, of which neither can be proved.
    pub open: u32,
}

impl Proof {
    /// Of nothing yet.
    pub fn new(scene: &Problem, way: Way) -> Result<Self, Error> {
        let motion = WayStepper::new(&scene.pendulum, &scene.start, scene.rate, way)?;
        Ok(Self { way, motion, right: 0, wrong: None, open: 0 })
    }

    /// Whether the next frame is right, if that is proved.
    fn judge(&mut self, scene: &Problem, frame: u32, set: &Enclosure) -> Option<bool> {
        self.motion.advance();
        let shown = self.motion.directions().map(|direction| direction.map(|x| Fixed::of(x.into())));
        let is_right = set.is_right(&shown, [scene.pendulum.l1, scene.pendulum.l2], scene.tolerance);
        match is_right {
            _ if self.wrong.is_some() => {}
            Some(true) => self.right = if self.right + 1 == frame { frame } else { self.right },
            Some(false) => self.wrong = Some(frame),
            None => self.open += 1,
        }
        is_right
    }
}

/// Judges every frame until a wrong one in each of `proofs`, or as long as the motion can be followed and `goes_on`, which is told
/// the set that it is in and whether each is right. How many frames.
pub fn follow(
    scene: &Problem,
    start: &Start,
    proofs: &mut [Proof],
    mut goes_on: impl FnMut(u32, &Enclosure, &[Option<bool>]) -> anyhow::Result<bool>,
) -> anyhow::Result<u32> {
    let mut set = start.enclose(scene.rate, Fineness::default());
    for frame in 1..=scene.frames() {
        if proofs.iter().all(|proof| proof.wrong.is_some()) || set.advance().is_none() {
            return Ok(frame - 1);
        }
        let are_right: Vec<_> = proofs.iter_mut().map(|proof| proof.judge(scene, frame, &set)).collect();
        if !goes_on(frame, &set, &are_right)? {
            return Ok(frame);
        }
    }
    Ok(scene.frames())
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

/// What is proved, a line each, `frames` having been looked at.
pub fn words(scene: &Problem, plan: &Result<Plan, Limit>, proof: &Proof, frames: u32, width: f64) -> Vec<String> {
    let &Proof { way, right, wrong, open, .. } = proof;
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
