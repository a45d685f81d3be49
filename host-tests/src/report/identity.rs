//! Whether the host and the chips compute the same bits: what allows errors to be computed on the host.

use firmware::measure::{Outcome, Request, SUBJECTS};

use super::accuracy::request;
use super::scene::Scene;
use super::table::Table;
use crate::count::{CountError, Target};

/// The step size compared: 2^-8 s.
const HALVINGS: u32 = 8;
/// States that go into the CRC.
const SAMPLES: u32 = 10;

/// CRCs of every arithmetic on the host and on `targets` after `steps` steps of `scene`; the second value tells whether
/// all agree. `tick` is called after each run.
pub fn table(targets: &[Target], scene: &Scene, steps: u32, tick: &dyn Fn()) -> Result<(Table, bool), CountError> {
    let mut rows = Vec::new();
    let mut all_agree = true;
    for subject in SUBJECTS {
        let request = Request { samples: SAMPLES, steps: steps / SAMPLES, ..request(subject, scene, HALVINGS) };
        let refused = |reason: firmware::measure::RequestError| CountError::Refused {
            request: request.to_string(),
            reason: reason.to_string(),
        };
        let host = Outcome::of(&request).map_err(refused)?;
        let mut row = vec![subject.name.to_owned(), format!("{:08x}", host.crc)];
        let mut agree = true;
        for target in targets {
            let (outcome, _) = target.run(&request)?;
            agree &= outcome == host;
            row.push(format!("{:08x}", outcome.crc));
            tick();
        }
        row.push(String::from(if agree { "same bits" } else { "DIFFERENT" }));
        all_agree &= agree;
        rows.push(row);
    }
    let mut columns = vec!["arithmetic", "this host"];
    columns.extend(targets.iter().map(|target| target.board.cpu));
    columns.push("verdict");
    let note = format!("CRC-32 of {SAMPLES} states over {steps} steps of 2^-{HALVINGS} s, scene {}.", scene.name);
    Ok((Table { name: "bit-identity", title: String::from("Bit identity"), note, columns, rows }, all_agree))
}
