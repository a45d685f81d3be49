//! The cycles of a step, measured by the board, beside the estimate of `cargo count`.

use double_pendulum::Method;
use firmware::config::MOST_MEASURED_STEPS;
use firmware::job::{ON_BOARDS, Request};
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
    /// The method.
    #[serde(serialize_with = "named")]
    pub method: Method,
    /// From flash, on average over the first second; `None` where the board counts no cycles.
    pub from_flash: Option<f64>,
    /// The same from RAM; `None`, too, where the board has the steps in flash only.
    pub from_ram: Option<f64>,
    /// For memory without wait states.
    pub estimated: Option<f64>,
}

/// Measures a step of every method, as `cargo count` counts it: on average over the first second from rest.
pub fn measure(talk: &mut Talk) -> anyhow::Result<Vec<Cycles>> {
    let accepted = |method: &&Method| Request { samples: 0, ..REGULAR.request(**method) }.crc().is_ok();
    let rows = ON_BOARDS.iter().filter(accepted);
    rows.map(|&method| {
        let [from_flash, from_ram] = [step(talk, method, 0)?, step(talk, method, 1)?];
        Ok(Cycles { method, from_flash, from_ram, estimated: None })
    })
    .collect()
}

fn step(talk: &mut Talk, method: Method, in_ram: u8) -> anyhow::Result<Option<f64>> {
    talk.port.send(&Request { samples: 0, ..REGULAR.request(method) }.message(REQUEST));
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

fn named<S: serde::Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(method.name())
}

/// Estimates what has been measured.
pub fn estimate(rows: &mut [Cycles], board: &'static Board) -> anyhow::Result<()> {
    let mut rows = rows.iter_mut().filter(|row| row.from_flash.is_some()).peekable();
    if rows.peek().is_none() {
        return Ok(());
    }
    let target = Target::build(&toolchain::ready()?, board)?;
    for row in rows {
        let request = Request { samples: 1, ..REGULAR.request(row.method) };
        let request = Request { stride: affordable_steps(&target, &request)?, ..request };
        row.estimated = Some(step_cost(&target, &request)?.cycles);
    }
    Ok(())
}
