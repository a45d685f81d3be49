//! A proof in words.

use double_pendulum::plan::{Limit, Plan, Problem};
use firmware::config::HALF_PIXEL;

use super::frames::Proof;
use reference::enclosure::{Enclosure, Verdict};

/// The table's heading with `csv`.
pub const HEADING: &str = "t,sin_a1,cos_a1,sin_a2,cos_a2,radius,verdict";

/// A frame: the time, s, the middles of the box that the exact motion is in, how far it may be from them, and what is proved of the frame drawn.
pub fn row(scene: &Problem, frame: u32, set: &Enclosure, verdict: Verdict) -> String {
    let [[sin1, cos1], [sin2, cos2]] = set.directions();
    let radius = [sin1, cos1, sin2, cos2].map(|x| x.radius).into_iter().fold(0.0, f64::max);
    let middles = [sin1, cos1, sin2, cos2].map(|x| x.middle.to_string()).join(",");
    format!("{},{middles},{:.1e},{}", scene.time(frame), radius, verdict.name())
}

/// How far any of the directions may be from the middle of the box.
pub fn width(set: &Enclosure) -> f64 {
    set.exact_directions().as_flattened().iter().map(|x| x.split().1).fold(0.0, f64::max)
}

/// What is proved, a line each, `frames` having been looked at.
pub fn words(scene: &Problem, plan: &Result<Plan, Limit>, proof: &Proof, frames: u32, width: f64) -> Vec<String> {
    let of_plan = match plan {
        Ok(plan) => format!("right until {:.3} s by {}, {} to a frame", plan.horizon, plan.method.name(), plan.steps),
        Err(_) => String::from("nothing that the chip can afford is right in any frame"),
    };
    let first = match proof.wrong {
        Some(frame) => format!("wrong at {:.3} s: more than {HALF_PIXEL} pixels off", scene.time(frame)),
        None => format!("none wrong of all {frames} frames, until {:.3} s", scene.time(frames)),
    };
    vec![
        format!("method     {}, {} to a frame", proof.way.method.name(), proof.way.steps),
        format!(
            "proved     right to half a pixel until {:.3} s, every one of {} frames",
            scene.time(proof.right),
            proof.right
        ),
        format!("           {first}"),
        format!("open       {} frames between, neither right nor wrong by proof", proof.open),
        format!("predicted  {of_plan}"),
        format!("known      the exact motion, each direction to {width:.1e} at {:.3} s", scene.time(frames)),
    ]
}
