//! `cargo bench --bench peers`: this kernel beside two integration libraries, on this machine and in one run.
//!
//! Times are taken in turns and given as ratios only, because a machine's speed drifts. The last table sets them against
//! the project's goals. With `--count NAME SCENE EFFORT TIMES` one contestant follows a scene so many times and prints its
//! last state, for an instruction counter around it; `--efforts SCENE ERROR` prints the efforts that the error asks of all
//! that can keep it.

mod contestants;
mod equations;
mod race;

use std::process::ExitCode;

use contestants::{CLASSICAL, Contestant, PARTS, SCENES, Scene, TIGHT};
use race::Entry;

/// Errors asked of high orders, rad.
const ERRORS: [f64; 2] = [1e-9, 1e-12];
/// Of the time of order 8 that extrapolation may take to these errors of the regular scene.
const EXTRAPOLATED: [(f64, f64); 2] = [(1e-9, 0.8), (1e-12, 0.55)];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        [] => compare(),
        ["--count", name, scene, effort, times] => count(name, scene, effort, times),
        ["--efforts", scene, error] => efforts(scene, error),
        _ => None,
    };
    if done.is_none() {
        eprintln!("peers [--count NAME SCENE EFFORT TIMES | --efforts SCENE ERROR]");
        return ExitCode::from(2);
    }
    ExitCode::SUCCESS
}

fn scene(name: &str) -> Option<&'static Scene> {
    SCENES.iter().find(|scene| scene.name == name)
}

fn count(name: &str, scene_name: &str, effort: &str, times: &str) -> Option<()> {
    let contestant = CLASSICAL.iter().chain(TIGHT).find(|contestant| contestant.name == name)?;
    let (scene, effort, times) = (scene(scene_name)?, effort.parse().ok()?, times.parse::<u32>().ok()?);
    for _ in 0..times {
        println!("{:?}", (contestant.run)(scene, PARTS, effort));
    }
    Some(())
}

fn efforts(scene_name: &str, error: &str) -> Option<()> {
    for entry in race::at_error(TIGHT, scene(scene_name)?, error.parse().ok()?) {
        println!("{}\t{}\t{:e}", entry.contestant.name, entry.effort, entry.error);
    }
    Some(())
}

/// A goal, in words, and what was measured.
struct Goal {
    asked: String,
    measured: f64,
    met: bool,
}

fn compare() -> Option<()> {
    let mut goals = Vec::new();
    for scene in &SCENES {
        let mut entries = race::at_effort(CLASSICAL, scene, scene.classical_steps());
        race::run(&mut entries, scene);
        show(&format!("{}: RK4, time for 256 steps a second", scene.name), &entries, Entry::time_at_equal_error);
        for (name, most) in [("angle form", 0.65), ("direction form", 0.45)] {
            let form = |one: &Contestant| one.name.starts_with("double-pendulum") && one.name.ends_with(name);
            let measured = least(&entries, form, Entry::time_at_equal_error)
                / least(&entries, |one| !one.own, Entry::time_at_equal_error);
            let asked = format!("{}: RK4 in the {name} takes at most {most} of every peer's time", scene.name);
            goals.push(Goal { asked, measured, met: measured <= most });
        }
        for error in ERRORS {
            let mut entries = race::at_error(TIGHT, scene, error);
            race::run(&mut entries, scene);
            show(&format!("{}: time to an error of {error:e} rad", scene.name), &entries, |entry| entry.time);
            let time = |entry: &Entry| entry.time;
            let measured = least(&entries, |one| !one.own, time) / least(&entries, |one| one.own, time);
            let asked = format!("{}: DOP853 takes at least 1.5 times the kernel's time to {error:e} rad", scene.name);
            goals.push(Goal { asked, measured, met: measured >= 1.5 });
            if let Some((_, most)) = EXTRAPOLATED.into_iter().find(|(of, _)| scene.name == "regular" && *of == error) {
                let named = |end| least(&entries, |one| one.own && one.name.ends_with(end), time);
                let measured = named("extrapolated to order 16") / named("of order 8");
                let asked =
                    format!("{}: extrapolation takes at most {most} of order 8's time to {error:e} rad", scene.name);
                goals.push(Goal { asked, measured, met: measured <= most });
            }
        }
    }
    println!("\ngoals, at equal error");
    for Goal { asked, measured, met } in goals {
        println!("{asked:78} {measured:6.2}  {}", if met { "met" } else { "MISSED" });
    }
    Some(())
}

/// Times relative to the fastest peer's, as run and at equal error.
fn show(title: &str, entries: &[Entry], at_equal_error: fn(&Entry) -> f64) {
    println!("\n{title}\n{:51} {:>7} {:>9} {:>6} {:>15}", "", "effort", "error", "time", "at equal error");
    let peer = |of: fn(&Entry) -> f64| least(entries, |one| !one.own, of);
    let (time, equal) = (peer(|entry| entry.time), peer(at_equal_error));
    for entry in entries {
        let Entry { contestant, effort, error, .. } = entry;
        let ratios = [entry.time / time, at_equal_error(entry) / equal];
        println!("{:51} {effort:7} {error:9.1e} {:6.2} {:15.2}", contestant.name, ratios[0], ratios[1]);
    }
}

fn least(entries: &[Entry], who: impl Fn(&Contestant) -> bool, of: impl Fn(&Entry) -> f64) -> f64 {
    entries.iter().filter(|entry| who(entry.contestant)).map(of).fold(f64::INFINITY, f64::min)
}
