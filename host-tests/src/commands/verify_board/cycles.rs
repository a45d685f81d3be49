//! The cycles of a step, measured by the board, beside the estimate of `cargo count`.

use double_pendulum::Method;
use firmware::config::MOST_MEASURED_STEPS;
use firmware::job::{ON_BOARDS, Request};
use firmware::protocol::{Measure, Measured};

use super::Section;
use super::bits::{next, regular};
use super::talk::Talk;
use crate::commands::count::{FULL_CYCLE, Target, affordable_cost};
use crate::commands::table::Table;
use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::toolchain;

const REQUEST: u16 = u16::MAX;

/// A method with the cycles of its step from flash and from RAM; `None` where the board counts none, or has no copy in RAM.
type Row = (Method, [Option<f64>; 2]);

/// Measures a step of every method, as `cargo count` counts it: on average over the first second from rest.
pub fn measure(talk: &mut Talk) -> anyhow::Result<Vec<Row>> {
    let accepted = |method: &&Method| Request { samples: 0, ..regular(**method) }.crc().is_ok();
    let row = |&method: &Method| Ok((method, [step(talk, method, 0)?, step(talk, method, 1)?]));
    ON_BOARDS.iter().filter(accepted).map(row).collect()
}

fn step(talk: &mut Talk, method: Method, in_ram: u8) -> anyhow::Result<Option<f64>> {
    talk.port.send(&Request { samples: 0, ..regular(method) }.message(REQUEST));
    next(talk, REQUEST)?;
    let (mut steps, mut cycles) = (0, 0.0);
    while steps < FULL_CYCLE {
        let measured: Measured = talk.ask(&Measure { request: REQUEST, steps: MOST_MEASURED_STEPS, in_ram })?;
        if measured.cycles == 0 || measured.steps == 0 {
            return Ok(None);
        }
        steps += measured.steps;
        cycles += f64::from(measured.cycles);
    }
    Ok(Some(cycles / f64::from(steps)))
}

/// Estimates what has been measured. Instructions are counted in QEMU, on a board with the same processor.
pub fn estimate(measured: Vec<Row>, board: Option<&Board>) -> anyhow::Result<Section> {
    let board = board.and_then(|board| BOARDS.iter().find(|counted| counted.target == board.target));
    let is_counted = measured.iter().any(|(_, [flash, _])| flash.is_some());
    let target = board.filter(|_| is_counted).map(|board| Target::build(&toolchain::ready()?, board)).transpose()?;
    let mut rows = Vec::new();
    for (method, [flash, ram]) in measured {
        let estimated = target.as_ref().filter(|_| flash.is_some());
        let estimated = estimated.map(|target| affordable_cost(target, &regular(method))).transpose()?;
        let cell =
            |cycles: Option<f64>, none: &str| cycles.map_or_else(|| none.into(), |cycles| format!("{cycles:.1}"));
        let (none, estimated) = ("no cycle counter", estimated.map(|cost| cost.cycles));
        let no_copy = if flash.is_some() { "-" } else { none };
        rows.push(vec![method.to_string(), cell(flash, none), cell(ram, no_copy), cell(estimated, "-")]);
    }
    let note = "Measured by the processor's cycle counter, interrupts off, over 256 steps of the regular motion, by the code in \
                flash and, where there is one, by its copy in RAM (constants are read from flash by both); estimated for memory \
                without wait states, over as many steps or, of the expensive ones, fewer.";
    let columns = &["method", "from flash", "from RAM", "estimated"];
    Ok(Section { table: Table { title: "Cycles of a step", note: note.into(), columns, rows }, faults: vec![] })
}
