//! The programs of `kernel/minimal`, which is a crate outside of this workspace: the prices that a
//! user of the kernel pays for its public functions.

use std::collections::BTreeSet;
use std::fmt;

use anyhow::{Context, Result, ensure};
use cycles::Calls;
use double_pendulum::Method;
use rayon::prelude::*;

use super::Target;
use super::trace::one_of_each_core;
use crate::table::between;
use boards::Board;
use boards::toolchain::{Toolchain, workspace};

const COUNTED: &str = "minimal::advance";

/// The register with its number of steps. The first two hold the places of its result and of the
/// motion.
const STEPS: usize = 2;

const START_UP: &str = "start_up";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Program {
    /// The type that it passes to `Pendulum::run`, such as "Fixed64<12>".
    pub form: &'static str,
    pub binary: &'static str,
    pub method: Method,
    pub counts_turns: bool,
}

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let turns = if self.counts_turns {
            ", counting turns"
        } else {
            ""
        };
        write!(f, "`{}`{turns}", self.form)
    }
}

/// The programs, in the order of the kernel's README.
pub const PROGRAMS: [Program; 8] = [
    Program {
        form: "DirectionF32",
        binary: "direction_f32",
        method: Method::Rk4F32Direction,
        counts_turns: false,
    },
    Program {
        form: "DirectionF32",
        binary: "direction_f32_turns",
        method: Method::Rk4F32Direction,
        counts_turns: true,
    },
    Program {
        form: "DirectionF32Plain",
        binary: "direction_f32_plain",
        method: Method::Rk4F32DirectionPlain,
        counts_turns: false,
    },
    Program {
        form: "Fixed32",
        binary: "fixed32",
        method: Method::Rk4Fixed32,
        counts_turns: false,
    },
    Program {
        form: "Fixed64<12>",
        binary: "fixed64",
        method: Method::Extrapolation12Fixed64,
        counts_turns: false,
    },
    Program {
        form: "ExtrapolationF64<12>",
        binary: "extrapolation_f64",
        method: Method::Extrapolation12F64,
        counts_turns: false,
    },
    Program {
        form: "HamiltonF32",
        binary: "hamilton_f32",
        method: Method::Rk4F32,
        counts_turns: false,
    },
    Program {
        form: "ClosedFormF32",
        binary: "closed_form_f32",
        method: Method::ClosedFormF32,
        counts_turns: false,
    },
];

/// The price of a program's calls of `Run::advance`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimal {
    pub program: &'static Program,
    pub steps: u32,
    pub step: f64,
    /// The cycles of a call with no step: the checks.
    pub call: u64,
    /// The bytes in flash, on top of a program without a motion.
    pub flash: usize,
}

#[derive(Clone, Debug)]
pub struct MinimalPrices {
    pub board: &'static Board,
    pub prices: Vec<Minimal>,
    /// The flash of a program without a motion.
    pub start_up: usize,
}

impl MinimalPrices {
    pub fn count(toolchain: &Toolchain, board: &'static Board) -> Result<Self> {
        let folder = toolchain.build_minimal(board.target)?;
        let target = |binary| Target::of(toolchain, board, folder.join(binary));
        let start_up = target(START_UP)?.flash_bytes()?;
        let prices = PROGRAMS.par_iter().map(|program| {
            let target = target(program.binary)?;
            let flash = target.flash_bytes()? - start_up;
            Minimal::count(program, &target, flash)
        });
        Ok(Self {
            board,
            prices: prices.collect::<Result<_>>()?,
            start_up,
        })
    }

    pub fn count_all(toolchain: &Toolchain) -> Result<Vec<Self>> {
        one_of_each_core()
            .map(|board| Self::count(toolchain, board))
            .collect()
    }
}

const MARKS: [&str; 2] = [
    "<!-- made by cargo count --minimal --readme -->\n",
    "<!-- end of the generated part -->\n",
];

const README: &str = "kernel/README.md";

pub fn table_in_readme() -> Result<String> {
    let page = std::fs::read_to_string(workspace().join(README))?;
    let [start, end] = MARKS;
    let table = page
        .split_once(start)
        .and_then(|(_, rest)| rest.split_once(end));
    Ok(table.context(NO_PLACE)?.0.to_owned())
}

const NO_PLACE: &str = "kernel/README.md has no place for the prices";

pub fn write_table(boards: &[MinimalPrices]) -> Result<()> {
    let path = workspace().join(README);
    let page = std::fs::read_to_string(&path)?;
    let page = between(&page, MARKS, &table(boards)).context(NO_PLACE)?;
    boards::out_file::write("--readme", &path, page)
}

/// Returns the table for the kernel's README. A cell has the cycles of a step and of a call, as in
/// "1,234 + 56". The last column has the flash on each board.
pub fn table(boards: &[MinimalPrices]) -> String {
    let cores: Vec<_> = boards
        .iter()
        .map(|board| board.board.core().name())
        .collect();
    let mut table = format!("| type | {} | flash, bytes |\n", cores.join(" | "));
    table += &format!("|---|{}---|\n", "---|".repeat(cores.len()));

    let all = |size: &dyn Fn(&MinimalPrices) -> usize| {
        let sizes: Vec<_> = boards
            .iter()
            .map(|board| grouped(size(board) as u64))
            .collect();
        sizes.join(" / ")
    };
    for (i, program) in PROGRAMS.iter().enumerate() {
        let costs: Vec<_> = boards
            .iter()
            .map(|board| {
                let Minimal { step, call, .. } = board.prices[i];
                format!("{} + {}", grouped(step.round() as u64), grouped(call))
            })
            .collect();
        let flash = all(&|board| board.prices[i].flash);
        table += &format!("| {program} | {} | {flash} |\n", costs.join(" | "));
    }

    let flash = all(&|board| board.start_up);
    table + &format!("| no motion |{} {flash} |\n", " |".repeat(cores.len()))
}

fn grouped(number: u64) -> String {
    if number < 1000 {
        number.to_string()
    } else {
        format!("{},{:03}", grouped(number / 1000), number % 1000)
    }
}

impl Minimal {
    fn count(program: &'static Program, target: &Target, flash: usize) -> Result<Self> {
        let entry = target.image.function(COUNTED)?.address;
        let entries = BTreeSet::from([entry]);
        let mut calls = Calls::of(&target.image, target.board.core(), entries.clone());

        let mut steps = Vec::new();
        target.trace("", &entries, &mut |registers| {
            calls.see(registers)?;
            if let Some((entry, ..)) = &calls.running
                && steps.len() == calls.ended.len()
            {
                steps.push(entry.general[STEPS]);
            }
            Ok(())
        })?;
        let binary = program.binary;

        // The calls make no step, one step, and more steps, each from the same start.
        let (&[0, 1, all], [none, one, many]) = (&steps[..], &calls.ended[..]) else {
            anyhow::bail!("{binary}: calls of {COUNTED} with {steps:?} steps")
        };
        let more = all.saturating_sub(1);
        ensure!(more > 0, "{binary}: {COUNTED} makes only one step");
        let step = (many.cycles - one.cycles) as f64 / f64::from(more);
        Ok(Self {
            program,
            steps: more,
            step,
            call: none.cycles,
            flash,
        })
    }
}
