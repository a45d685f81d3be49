//! Energy drift over many steps: shows slow losses, says nothing about accuracy.

use double_pendulum::{Pendulum, State};
use firmware::job::{JobError, Request};

use super::accuracy::request;
use super::compared;
use super::scene::SCENES;
use crate::commands::table::{Table, small};

/// The scenes and step sizes followed.
const SCENES_FOLLOWED: usize = 2;
const RATES: [u32; 2] = [256, 1024];

/// How many runs [`table`] makes.
pub fn runs() -> usize {
    SCENES_FOLLOWED * compared().count() * RATES.len()
}

/// The drift of every method over `steps` steps; `tick` is called after each run.
pub fn table(steps: u32, tick: &dyn Fn()) -> Table {
    let mut rows = Vec::new();
    for scene in &SCENES[..SCENES_FOLLOWED] {
        let Ok(pendulum) = Pendulum::<f64>::new(scene.parameters()) else { continue };
        let [a1, a2] = scene.angles();
        let start = pendulum.energy_above_rest(&State::at_rest(a1, a2));
        for method in compared() {
            for rate in RATES {
                let long = Request { samples: 1, stride: steps, ..request(method, scene, rate) };
                let mut drift = f64::NAN;
                let run = long.readings(|reading| {
                    drift = (pendulum.energy_above_rest(&reading.state.into()) - start) / start;
                    Ok::<_, JobError>(())
                });
                tick();
                if run.is_ok() {
                    let (step, drift) = (format!("1/{rate}"), small(drift));
                    rows.push(vec![scene.name.to_owned(), method.to_string(), step, drift]);
                }
            }
        }
    }
    Table {
        name: "energy-drift",
        title: format!("Energy after {steps} steps"),
        note: String::from(
            "Change of the energy above rest, relative to the energy at the start. The f64 rows show what the method \
             itself loses.",
        ),
        columns: vec!["scene", "method", "step (s)", "relative drift"],
        rows,
    }
}
