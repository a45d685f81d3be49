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
use crate::commands::table::between;
use emulator::boards::Board;
use emulator::toolchain::{Toolchain, workspace};

/// The function of the programs whose calls are counted.
const COUNTED: &str = "minimal::advance";

/// The register in which that function receives its number of steps. The first two hold the places
/// of its result and of the motion.
const STEPS: usize = 2;

/// The program that starts and ends without a motion.
const START_UP: &str = "start_up";

/// A program of `kernel/minimal`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Program {
    /// The type that it passes to `Pendulum::run`, such as "Fixed64<12>", without a path.
    pub form: &'static str,
    /// The name of its binary.
    pub binary: &'static str,
    /// The method that the type implements.
    pub method: Method,
    /// True if it counts whole turns.
    pub counts_turns: bool,
}

/// Writes the type as the kernel's README does: in backquotes, and ", counting turns" after it if
/// the program counts turns.
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

/// The programs with a motion, in the order of the kernel's README: one each for seven methods, and
/// one that counts turns.
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

/// The price of a program's calls of `Run::advance`: steps of 1/256 s from rest at 0.5 rad, with
/// rods of 1 m and bobs of 1 kg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimal {
    /// The program.
    pub program: &'static Program,
    /// The number of steps over which `step` is averaged, all after the first.
    pub steps: u32,
    /// The number of cycles (estimated) of a step.
    pub step: f64,
    /// The number of cycles (estimated) of a call on top of its steps: the checks. It is the cost
    /// of a call with no step.
    pub call: u64,
    /// The size of the program in flash minus the size of a program without a motion, bytes.
    pub flash: usize,
}

/// The prices on a board.
#[derive(Clone, Debug)]
pub struct MinimalPrices {
    /// The board, for the kind of its core.
    pub board: &'static Board,
    /// The prices of `PROGRAMS`, in that order.
    pub prices: Vec<Minimal>,
    /// The size of a program without a motion in flash, bytes.
    pub start_up: usize,
}

impl MinimalPrices {
    /// Builds all programs for `board` and counts them. An error means that a program cannot be
    /// built, fails in QEMU, executes an instruction without a known timing, or does not make its
    /// three calls: with no step, with one step, and with more. Each program that runs for half an
    /// hour is stopped, which is an error, too.
    pub fn count(toolchain: &Toolchain, board: &'static Board) -> Result<Self> {
        let folder = toolchain.build_minimal(board.target)?;
        let target = |binary| Target::of(toolchain, board, folder.join(binary));
        // Sizes are relative to this program, which has no motion.
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

    /// Counts all programs on one board for each kind of core: a Cortex-M3, a Cortex-M4F and a
    /// Cortex-M0+, in this order. An error is one of [`MinimalPrices::count`].
    pub fn count_all(toolchain: &Toolchain) -> Result<Vec<Self>> {
        one_of_each_core()
            .map(|board| Self::count(toolchain, board))
            .collect()
    }
}

/// The lines before and after the table of prices in the kernel's README.
const MARKS: [&str; 2] = [
    "<!-- made by cargo count --minimal --readme -->\n",
    "<!-- end of the generated part -->\n",
];

/// The kernel's README.
const README: &str = "kernel/README.md";

/// Returns the table of prices as the kernel's README shows it now, with its last newline and
/// without the lines around it. An error means that the file or the lines around the table are
/// missing.
pub fn table_in_readme() -> Result<String> {
    let page = std::fs::read_to_string(workspace().join(README))?;
    let [start, end] = MARKS;
    let table = page
        .split_once(start)
        .and_then(|(_, rest)| rest.split_once(end));
    Ok(table.context(NO_PLACE)?.0.to_owned())
}

const NO_PLACE: &str = "kernel/README.md has no place for the prices";

/// Writes the table of prices ([`table`]) into the kernel's README, in place of the table there. An
/// error means that the file cannot be read or written, or that the lines around the table are
/// missing.
pub fn write_table(boards: &[MinimalPrices]) -> Result<()> {
    let path = workspace().join(README);
    let page = std::fs::read_to_string(&path)?;
    let page = between(&page, MARKS, &table(boards)).context(NO_PLACE)?;
    emulator::out_file::write("--readme", &path, page)
}

/// Returns the table of prices for the kernel's README, in Markdown, with a newline after each
/// line: a row for each of `PROGRAMS`, and one for a program without a motion. There is a column
/// for the core of each board, in the order of `boards`.
///
/// A cell of a core has the cycles of a step, rounded, and of a call, as in "1,234 + 56"; it is
/// empty without a motion. The last column has the flash on each board, in bytes, as in "1,234 /
/// 5,678": of the program without a motion the whole size, of the others the rest beyond it. Each
/// board must have a price for each of `PROGRAMS`, else this panics.
pub fn table(boards: &[MinimalPrices]) -> String {
    let cores: Vec<_> = boards
        .iter()
        .map(|board| board.board.core().name())
        .collect();
    let mut table = format!("| type | {} | flash, bytes |\n", cores.join(" | "));
    table += &format!("|---|{}---|\n", "---|".repeat(cores.len()));

    // Joins a size on every board into one cell.
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

    // The last row has only a size in flash, because this program makes no steps.
    let flash = all(&|board| board.start_up);
    table + &format!("| no motion |{} {flash} |\n", " |".repeat(cores.len()))
}

/// Returns a number with commas between thousands.
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

        // The number of steps of each call is in a register at its entry.
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
