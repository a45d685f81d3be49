//! What a frame costs: of every scene on every board, by the parts of the work; and until when the frames are right.

use std::time::Duration;

use anyhow::Result;
use firmware::config::{PLANNED, TICK_RATE};
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;
use rayon::prelude::*;

use crate::commands::count::{FrameProfile, Image, Part};
use crate::commands::table::Table;
use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::host::Show;
use crate::emulator::qemu::{Clock, Lockstep, Settings};
use crate::emulator::toolchain::Toolchain;

/// The tick whose frame is counted: after 2 s all is in view, and the curves that scroll every few ticks do so.
const COUNTED: u32 = 2 * TICK_RATE;
/// The work for a frame, in the order of the columns; the search for a plan takes what frames leave.
const WORK: [Part; 4] = [Part::Motion, Part::Drawing, Part::Sending, Part::Rest];
/// A guard against hanging.
const LIMIT: Duration = Duration::from_secs(1800);

/// Counts a frame of every scene on the first `boards` boards; `tick` is called after each.
///
/// Cycles (estimate) of the parts, of all of them, and as a share of the time between frames. Sending: the frame in numbers,
/// what has changed to the panel, which QEMU's bus takes at once, and the message. Right until: by the panel's clock.
pub fn count(toolchain: &Toolchain, boards: usize, tick: &(dyn Fn() + Sync)) -> Result<Table> {
    let on_board = |board: &'static Board| {
        let elf = &toolchain.build_for(board)?;
        let settings =
            Settings { qemu: toolchain.qemu(), board, elf, clock: Clock::Counted, debugger: true, limit: LIMIT };
        let image = Image::read(elf)?;
        let mut machine = Lockstep::start(&settings)?;
        let row = |&scene: &SceneName| {
            machine.machine().serial.send(&Choose { request: 1, scene: scene.code() })?;
            let is_before = |frame: &Frame| {
                frame.scene == scene.code() && (frame.time * f64::from(TICK_RATE)).round() as u32 == COUNTED - 1
            };
            while !is_before(&machine.next_frame()?) {}
            let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
            tick();
            let parts = WORK.map(|part| profile.cost(part).cycles);
            let whole: u64 = parts.iter().sum();
            let share = 100.0 * whole as f64 * f64::from(TICK_RATE) / f64::from(board.processor_hertz());
            let mut row = vec![scene.name().to_owned(), board.name.to_owned()];
            row.extend(parts.into_iter().chain([whole]).map(|cycles| cycles.to_string()));
            row.extend([format!("{share:.1}"), horizon(board, scene).unwrap_or_default()]);
            Ok(row)
        };
        SceneName::ALL.iter().map(row).collect::<Result<Vec<_>>>()
    };
    let rows = BOARDS[..boards].par_iter().map(on_board).collect::<Result<Vec<_>>>()?.concat();
    let columns = &["scene", "board", "motion", "drawing", "sending", "rest", "whole", "share (%)", "right until (s)"];
    Ok(Table { columns, rows, ..Table::default() })
}

/// Until when `board` says that the frames are right, s, when it has looked ahead as far as it may. None where no motion is
/// planned.
fn horizon(board: &Board, scene: SceneName) -> Option<String> {
    let mut show = Show::on(board.processor(), scene, &scene.first_settings()).ok()?;
    for _ in 0..(PLANNED + 1.0) as u32 * TICK_RATE {
        show.tick();
    }
    let report = show.report();
    report.way.filter(|_| show.player.plan(0).found > 0)?;
    Some(format!("{:.1}{}", report.horizon, if report.is_looking { " and on" } else { "" }))
}
