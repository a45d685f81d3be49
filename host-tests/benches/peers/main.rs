//! `cargo bench --bench peers`: this kernel beside two integration libraries, on this machine and in one run.
//!
//! Times are taken in turns and given as ratios only, because a machine's speed drifts. The last table sets them against
//! the project's goals.

mod contestants;
mod equations;
mod race;

use contestants::{CLASSICAL, Contestant, SCENES, TIGHT};
use race::Entry;

/// Errors asked of high orders, rad.
const ERRORS: [f64; 2] = [1e-9, 1e-12];
/// Of DOP853's time that extrapolation may take to 1e-12 rad of the regular scene.
const EXTRAPOLATED: f64 = 0.2;

/// A goal, in words, and what was measured.
struct Goal {
    asked: String,
    measured: f64,
    met: bool,
}

fn main() {
    let mut goals = Vec::new();
    for scene in &SCENES {
        let mut entries = race::at_effort(CLASSICAL, scene, scene.classical_steps());
        race::run(&mut entries, scene);
        show(&format!("{}: RK4, time for 256 steps a second", scene.name), &entries, Entry::time_at_equal_error);
        let direction = |one: &Contestant| one.own && one.name.ends_with("direction form");
        let measured = least(&entries, direction, Entry::time_at_equal_error)
            / least(&entries, |one| !one.own, Entry::time_at_equal_error);
        let asked = format!("{}: RK4 in the direction form takes at most 0.45 of every peer's time", scene.name);
        goals.push(Goal { asked, measured, met: measured <= 0.45 });
        for error in ERRORS {
            let mut entries = race::at_error(TIGHT, scene, error);
            race::run(&mut entries, scene);
            show(&format!("{}: time to an error of {error:e} rad", scene.name), &entries, |entry| entry.time);
            let time = |entry: &Entry| entry.time;
            let measured = least(&entries, |one| !one.own, time) / least(&entries, |one| one.own, time);
            let asked = format!("{}: DOP853 takes at least 1.5 times the kernel's time to {error:e} rad", scene.name);
            goals.push(Goal { asked, measured, met: measured >= 1.5 });
            if scene.name == "regular" && error == 1e-12 {
                let extrapolated = |one: &Contestant| one.name.ends_with("extrapolated to order 16");
                let measured = least(&entries, extrapolated, time) / least(&entries, |one| !one.own, time);
                let asked =
                    format!("regular: extrapolation takes at most {EXTRAPOLATED} of DOP853's time to 1e-12 rad");
                goals.push(Goal { asked, measured, met: measured <= EXTRAPOLATED });
            }
        }
    }
    println!("\ngoals, at equal error");
    for Goal { asked, measured, met } in goals {
        println!("{asked:78} {measured:6.2}  {}", if met { "met" } else { "MISSED" });
    }
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
