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
    /// On average over the first second; `None` where the board counts no cycles.
    pub measured: Option<f64>,
    /// For memory without wait states.
    pub estimated: Option<f64>,
}

/// Measures a step of every arithmetic, as `cargo count` counts it: on average over the first second from rest.
pub fn measure(talk: &mut Talk) -> anyhow::Result<Vec<Cycles>> {
    let accepted = |row: &&Row| Request { samples: 0, ..REGULAR.request(**row) }.crc().is_ok();
    let rows = ON_BOARDS.iter().filter(accepted);
    rows.map(|&row| Ok(Cycles { arithmetic: row.to_string(), row, measured: step(talk, row)?, estimated: None }))
        .collect()
}

fn step(talk: &mut Talk, row: Row) -> anyhow::Result<Option<f64>> {
    talk.port.send(&Request { samples: 0, ..REGULAR.request(row) }.message(REQUEST));
    next(talk, REQUEST)?;
    let (mut steps, mut cycles) = (0, 0.0);
    while steps < FULL_CYCLE {
        let measured: Measured = talk.ask(&Measure { request: REQUEST, steps: MOST_MEASURED_STEPS })?;
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
    if rows.iter().all(|row| row.measured.is_none()) {
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
