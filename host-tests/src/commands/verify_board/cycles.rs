//! The cycles of a step, measured by the board, beside the estimate of `cargo count`.

use firmware::config::MOST_MEASURED_STEPS;
use firmware::job::{ON_BOARDS, Request, Row};
use firmware::protocol::{Measure, Measured};
use serde::Serialize;

use super::bits::{REGULAR, next};
use super::talk::Talk;
use crate::commands::count::{FULL_CYCLE, Target, affordable_steps, step_cost};
use crate::emulator::boards::Board;
use crate::emulator::toolchain;

/// The number of the requests.
const REQUEST: u16 = u16::MAX;

/// The cost of a step.
#[derive(Clone, Debug, Serialize)]
pub struct Cycles {
    /// The row of the table.
    pub arithmetic: String,
    #[serde(skip)]
    row: Row,
    /// From flash, on average over the first second; `None` where the board counts no cycles.
    pub from_flash: Option<f64>,
    /// The same from RAM; `None`, too, where the board has the steps in flash only.
    pub from_ram: Option<f64>,
    /// For memory without wait states.
    pub estimated: Option<f64>,
}

/// Measures a step of every arithmetic, as `cargo count` counts it: on average over the first second from rest.
pub fn measure(talk: &mut Talk) -> anyhow::Result<Vec<Cycles>> {
    let accepted = |row: &&Row| Request { samples: 0, ..REGULAR.request(**row) }.crc().is_ok();
    let rows = ON_BOARDS.iter().filter(accepted);
    rows.map(|&row| {
        let [from_flash, from_ram] = [step(talk, row, 0)?, step(talk, row, 1)?];
        Ok(Cycles { arithmetic: row.to_string(), row, from_flash, from_ram, estimated: None })
    })
    .collect()
}

fn step(talk: &mut Talk, row: Row, in_ram: u8) -> anyhow::Result<Option<f64>> {
    talk.port.send(&Request { samples: 0, ..REGULAR.request(row) }.message(REQUEST));
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

/// Estimates what has been measured.
pub fn estimate(rows: &mut [Cycles], board: &'static Board) -> anyhow::Result<()> {
    let mut rows = rows.iter_mut().filter(|row| row.from_flash.is_some()).peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    let target = Target::build(&toolchain::ready()?, board)?;
    for row in rows {
        let request = Request { samples: 1, ..REGULAR.request(row.row) };
        let request = Request { stride: affordable_steps(&target, &request)?, ..request };
        row.estimated = Some(step_cost(&target, &request)?.cycles);
    }
    Ok(())
}
