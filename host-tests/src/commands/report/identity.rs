//! Whether the host and the chips compute the same bits: what allows errors to be computed on the host.

use double_pendulum::{Integrator, Method};
use firmware::job::{JobError, Request};
use rayon::prelude::*;

use super::accuracy::request;
use super::scene::{SCENES, Scene};
use crate::commands::count::{CountError, Target};
use crate::commands::table::Table;
use crate::emulator::boards::Core;

/// Steps a second.
const RATE: u32 = 256;
/// A regular and a chaotic motion.
const COMPARED: &[Scene] = SCENES.split_at(2).0;

/// How many steps are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// With a floating-point unit, in fixed point, and by extrapolation: what is to be taken for a picture or for many digits.
    pub full: u32,
    /// By the other methods in software; on the Cortex-M0+, which has no long products either, a tenth of these by all.
    pub reduced: u32,
}

impl Steps {
    fn of(&self, target: &Target, method: Method) -> u32 {
        // The libm crate's sines are computed in double precision.
        let is_single = method.is_single() && !matches!(method, Method::Rk4F32Libm | Method::TextbookF32);
        match target.core() {
            Core::M0Plus => self.reduced / 10,
            Core::M4F if is_single => self.full,
            _ if method.is_fixed_point() || method.integrator() == Integrator::Extrapolation => self.full,
            _ => self.reduced,
        }
    }
}

/// How many comparisons are made on one target.
pub const RUNS: usize = COMPARED.len() * Method::ALL.len();

/// One method through one motion on a target and on this host.
#[derive(Clone, Copy, Debug)]
pub struct Comparison {
    /// What was run.
    pub request: Request,
    /// The motion.
    pub scene: &'static Scene,
    /// The processor.
    pub cpu: &'static str,
    /// The CRC over every state on this host.
    pub host: u32,
    /// The same on the target.
    pub target: u32,
}

impl Comparison {
    /// Whether all bits are the same.
    pub fn agrees(&self) -> bool {
        self.host == self.target
    }
}

/// The request whose CRC is over all states of the first `steps` steps of 1/256 s through `scene`.
pub fn every_state(method: Method, scene: &Scene, steps: u32) -> Request {
    Request { samples: steps, stride: 1, ..request(method, scene, RATE) }
}

/// Compares every method over both motions on all `targets`; `tick` is called after each.
pub fn compare(targets: &[Target], steps: Steps, tick: &(dyn Fn() + Sync)) -> Result<Vec<Comparison>, CountError> {
    let motions = || COMPARED.iter().flat_map(|scene| Method::ALL.iter().map(move |&method| (scene, method)));
    let runs: Vec<_> = targets.iter().flat_map(|target| motions().map(move |motion| (target, motion))).collect();
    let compared = runs.into_par_iter().map(|(target, (scene, method))| {
        let steps = steps.of(target, method);
        let request = every_state(method, scene, steps);
        let refused =
            |reason: JobError| CountError::Refused { request: method.to_string(), reason: reason.to_string() };
        let host = request.crc().map_err(refused)?;
        let (crc, _) = target.run(&request)?;
        tick();
        Ok(Comparison { request, scene, cpu: target.board.cpu, host, target: crc })
    });
    compared.collect()
}

/// The comparisons as a table.
pub fn table(comparisons: &[Comparison]) -> Table {
    let row = |one: &Comparison| {
        vec![
            one.request.method.to_string(),
            one.scene.name.to_owned(),
            one.cpu.to_owned(),
            one.request.samples.to_string(),
            format!("{:08x}", one.host),
            format!("{:08x}", one.target),
            String::from(if one.agrees() { "same bits" } else { "DIFFERENT" }),
        ]
    };
    Table {
        name: "bit-identity",
        title: String::from("Bit identity"),
        note: format!("CRC-32 of all that is carried from step to step, after every single step of 1/{RATE} s."),
        columns: vec!["method", "scene", "processor", "steps", "this host", "target", "verdict"],
        rows: comparisons.iter().map(row).collect(),
    }
}
