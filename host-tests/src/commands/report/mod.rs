//! `cargo write-report`: every method's cost on the target against its error, as tables and charts.
//!
//! Costs are counted on the emulated targets, errors are computed on the host, which is allowed because the bits are the
//! same ([`identity`]). Nothing is timed, so two runs write the same files.

pub mod accuracy;
mod c_peers;
pub mod chart;
pub mod costs;
pub mod energy;
pub mod flips;
pub mod frames;
pub mod frontier;
pub mod headline;
pub mod identity;
pub mod scene;
pub mod speed;

use anyhow::{Context, ensure};
use double_pendulum::{Integrator, Method};
use firmware::scenes::SceneName;
use std::fs;
use std::path::Path;

use crate::commands::count::Target;
use crate::commands::plan;
use crate::commands::table::Table;
use crate::console::progress::Bar;
use crate::emulator::boards::{BOARDS, Core};
use crate::emulator::toolchain::Toolchain;
use scene::{LONG, SCENES};

/// How much is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Scenes, from the first on.
    pub scenes: usize,
    /// The finest step is 2^-`finest` s.
    pub finest: u32,
    /// Steps of the energy runs.
    pub energy_steps: u32,
    /// Steps of the comparison of bits.
    pub identity: identity::Steps,
    /// Scenes planned and carried out.
    pub plans: usize,
    /// Boards whose frames are counted, from the first on.
    pub boards: usize,
    /// Starts across the maps of flips that are judged, and how many maps.
    pub flips: (usize, usize),
}

impl Extent {
    /// All of it: some hours, most of them for the comparison of bits.
    pub const FULL: Self = Self {
        scenes: SCENES.len(),
        finest: 13,
        energy_steps: 1_000_000,
        identity: identity::Steps { full: 1_000_000, reduced: 1_000_000 },
        plans: 2_000,
        boards: BOARDS.len(),
        flips: (64, 3),
    };
    /// The first two scenes and shorter runs: a few minutes.
    pub const QUICK: Self = Self {
        scenes: 2,
        finest: 13,
        energy_steps: 100_000,
        identity: identity::Steps { full: 10_000, reduced: 1_000 },
        plans: 40,
        boards: 2,
        flips: (64, 2),
    };

    /// The runs of everything, for the progress bar.
    pub fn runs(&self, targets: usize) -> usize {
        let methods = compared().count();
        let survey = self.scenes * compared().map(|method| accuracy::rates(method, self.finest).count()).sum::<usize>();
        let frames = self.boards * SceneName::ALL.len();
        survey + energy::runs() + self.plans + frames + targets * (identity::RUNS + methods)
    }
}

/// What the README shows of it.
#[derive(Clone, Debug)]
pub struct Main {
    /// What to take on each core, a sentence each.
    pub advice: Vec<String>,
    /// The table.
    pub table: Table,
    /// The chart, SVG.
    pub chart: String,
    /// What had to be left out, and why; empty if nothing.
    pub absent: String,
}

/// The seed of the scenes that are planned; the test draws others.
const PLANS_SEED: u64 = 1;

/// Computes the report and writes it into `folder`. Costs are counted on one board for each kind of core.
///
/// Gives the README's table and chart too.
pub fn write(extent: &Extent, toolchain: &Toolchain, folder: &Path, bar: &Bar) -> anyhow::Result<Main> {
    // A Cortex-M0+ would take longer than both others; `cargo count` has its prices.
    let mut targets = Target::build_all(toolchain)?;
    targets.retain(|target| target.core() != Core::M0Plus);
    let targets = &targets[..];
    bar.set_length(extent.runs(targets.len()) as u64);
    let tick = || bar.advance(1);
    bar.say("comparing bits");
    let compared = identity::compare(targets, extent.identity, &tick)?;
    let identity = identity::table(&compared);
    ensure!(
        compared.iter().all(identity::Comparison::agrees),
        "host and target differ, so errors from the host would not be the target's:\n{}",
        identity.markdown()
    );
    bar.say("counting");
    let scenes = &SCENES[..extent.scenes];
    let costs = costs::count(targets, scenes, &tick)?;
    bar.say("following the reference");
    let exact = parallel(scenes, accuracy::exact);
    let long = accuracy::exact(&LONG);
    bar.say("compiling and counting C");
    let c = c_peers::count(toolchain, targets, &exact, &long)?;
    let headline = headline::table(&costs, &c.0, [&exact[0], &long]);
    bar.say("comparing with the reference");
    let points = accuracy::survey(&exact, extent.finest, &tick);
    bar.say("following the energy");
    let energy = energy::table(extent.energy_steps, &tick);

    bar.say("carrying out plans");
    let planned = plan::scenes(PLANS_SEED, plan::DURATIONS).take(extent.plans);
    let plans = plan::study(planned, &plan::CHIPS, tick)?;

    bar.say("counting frames");
    let frames = frames::count(toolchain, extent.boards, &tick)?;

    bar.say("judging the map of flips");
    let (side, limits) = extent.flips;
    let belief = flips::belief(side, limits)?;

    bar.say("writing");
    let priced = speed::priced(&points, &costs, &c.0);
    let boards: Vec<_> = targets.iter().map(|target| target.board).collect();
    let advice = frontier::advice(&priced, &boards);
    let tables = [
        frontier::table(&priced, &boards, scenes),
        headline.clone(),
        c_peers::table(&c, &points, &costs),
        costs::table(&costs),
        speed::floors(&points),
        energy,
        identity,
        plan::summary(&plans),
        plan::violations(&plans),
        frames::table(&frames),
        belief,
        flips::cost(&frames)?,
        speed::table(&priced),
    ];
    let mut charts = Vec::new();
    for scene in scenes {
        for &board in &boards {
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
    let name = format!("speed-{}-cortex-m4.svg", SCENES[0].name);
    let chart = charts.into_iter().find(|(chart, _)| *chart == name);
    Ok(Main { advice, table: headline, chart: chart.context("no chart of the first scene")?.1, absent: c.1 })
}

/// The methods whose errors are compared: all but the closed forms, whose errors are those of their equations.
pub fn compared() -> impl Iterator<Item = Method> + Clone {
    Method::ALL.iter().copied().filter(|method| method.integrator() != Integrator::ClosedForm)
}

/// What `work` makes of each item, every item on a thread of its own.
fn parallel<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let work = &work;
    std::thread::scope(|scope| {
        let running: Vec<_> = items.iter().map(|item| scope.spawn(move || work(item))).collect();
        let results = running.into_iter().map(|thread| thread.join());
        results.map(|result| result.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}
