//! `cargo report`: every arithmetic's cost on the target against its error, as tables, pictures and one page.
//!
//! Costs are counted on the emulated targets, errors are computed on the host, which is allowed because the bits are the
//! same ([`identity`]). Nothing is timed, so two runs write the same files.

pub mod accuracy;
pub mod chart;
pub mod costs;
pub mod energy;
pub mod identity;
mod page;
pub mod peers;
pub mod scene;
pub mod speed;
pub mod table;

use anyhow::{Context, ensure};
use firmware::measure::SUBJECTS;
use indicatif::ProgressBar;
use std::fs;
use std::path::Path;

use crate::count::Target;
use crate::planning;
use scene::SCENES;

/// How much is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Scenes, from the first on.
    pub scenes: usize,
    /// The finest step is 2^-`finest` s; the coarsest is 2^-4 s.
    pub finest: u32,
    /// Steps of the energy runs.
    pub energy_steps: u32,
    /// Steps of the comparison of bits; a tenth where a processor computes in software.
    pub identity_steps: u32,
    /// Whether other integrators are counted, which first have to be compiled.
    pub peers: bool,
    /// Scenes planned and carried out.
    pub plans: usize,
}

impl Extent {
    /// All of it: some twenty minutes.
    pub const FULL: Self = Self {
        scenes: SCENES.len(),
        finest: 13,
        energy_steps: 1_000_000,
        identity_steps: 1_000_000,
        peers: true,
        plans: 2_000,
    };
    /// The first two scenes and shorter runs: under two minutes.
    pub const QUICK: Self =
        Self { scenes: 2, finest: 13, energy_steps: 100_000, identity_steps: 10_000, peers: false, plans: 60 };

    fn halvings(&self) -> impl Iterator<Item = u32> + Clone {
        4..=self.finest
    }

    /// The runs of everything, for the progress bar.
    pub fn runs(&self, targets: usize) -> usize {
        let survey = self.scenes * SUBJECTS.len() * self.halvings().count();
        let peers = if self.peers { peers::RUNS } else { 0 };
        survey + energy::RUNS + peers + self.plans + targets * (identity::RUNS + SUBJECTS.len())
    }
}

/// The seed of the scenes that are planned; the test draws others.
const PLANS_SEED: u64 = 1;

/// Computes the report and writes it into `folder`. Costs are counted on `targets`.
pub fn write(extent: &Extent, targets: &[Target], folder: &Path, bar: &ProgressBar) -> anyhow::Result<()> {
    let tick = || bar.inc(1);
    bar.set_message("comparing bits");
    let compared = targets.iter().map(|target| identity::compare(target, extent.identity_steps, &tick));
    let compared = compared.collect::<Result<Vec<_>, _>>()?.concat();
    let identity = identity::table(&compared);
    ensure!(
        compared.iter().all(identity::Comparison::agrees),
        "host and target differ, so errors from the host would not be the target's:\n{}",
        identity.markdown()
    );
    bar.set_message("counting");
    let costs = costs::count(targets, &SCENES[0], &tick)?;
    bar.set_message("comparing with the reference");
    let points = accuracy::survey(extent.scenes, extent.halvings(), &tick);
    bar.set_message("following the energy");
    let energy = energy::table(extent.energy_steps, &tick);

    bar.set_message("counting other integrators");
    let [peers, tight] = peers::tables(extent.peers, &tick)?;

    bar.set_message("carrying out plans");
    let chip = &planning::M4F;
    let plans = planning::study(PLANS_SEED, extent.plans, planning::DURATIONS, chip, tick)?;

    bar.set_message("writing");
    let priced = speed::priced(&points, &costs);
    let tables = [
        costs::table(&costs, &SCENES[0]),
        speed::floors(&points),
        energy,
        peers,
        tight,
        identity,
        planning::classes(&plans, chip)?,
        planning::broken(&plans),
        speed::table(&priced),
    ];
    let mut charts = Vec::new();
    for scene in &SCENES[..extent.scenes] {
        for target in targets {
            let board = target.board;
            let name = format!("speed-{}-{}.svg", scene.name, board.cpu);
            let svg = chart::speed_against_error(&priced, scene, board);
            charts.push((name, svg.map_err(|error| anyhow::anyhow!("cannot draw: {error}"))?));
        }
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let save = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
    };
    for table in &tables {
        save(&format!("{}.csv", table.name), &table.csv())?;
        save(&format!("{}.md", table.name), &table.markdown())?;
    }
    for (name, svg) in &charts {
        save(name, svg)?;
    }
    save("index.html", &page::html(&tables, &charts))
}
