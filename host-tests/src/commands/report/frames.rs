//! What a frame costs: of every scene on every board, by the parts of the work; and until when the frames are right.

use std::path::PathBuf;
use std::time::Duration;

use firmware::config::{PLANNED, TICK_RATE};
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;

use super::parallel;
use crate::commands::count::{CountError, ERROR_BAR, FrameProfile, Image, Part};
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
/// A scene's frame on a board.
#[derive(Debug)]
pub struct Counted {
    /// The board.
    pub board: &'static Board,
    /// The scene.
    pub scene: SceneName,
    horizon: String,
    profile: FrameProfile,
}

impl Counted {
    /// Of a part of the work.
    pub fn cycles(&self, part: Part) -> u64 {
        self.profile.cost(part).cycles
    }

    /// All of it.
    pub fn whole(&self) -> u64 {
        WORK.iter().map(|&part| self.cycles(part)).sum()
    }

    /// Of the time between frames.
    pub fn share(&self) -> f64 {
        self.whole() as f64 * f64::from(TICK_RATE) / f64::from(self.board.processor_hertz())
    }
}

/// Counts a frame of every scene on the first `boards` boards, each on a thread of its own; `tick` is called after each.
pub fn count(toolchain: &Toolchain, boards: usize, tick: &(dyn Fn() + Sync)) -> Result<Vec<Counted>, CountError> {
    let elves = BOARDS.iter().take(boards).map(|board| Ok((board, toolchain.build_for(board)?)));
    let elves = elves.collect::<Result<Vec<_>, CountError>>()?;
    let on_board = |(board, elf): &(&'static Board, PathBuf)| {
        let settings =
            Settings { qemu: toolchain.qemu(), board, elf, clock: Clock::Counted, debugger: true, limit: LIMIT };
        let image = Image::read(elf)?;
        let mut machine = Lockstep::start(&settings)?;
        let scenes = SceneName::ALL.iter().map(|&scene| {
            machine.machine().serial.send(&Choose { request: 1, scene: scene.code() })?;
            let is_before = |frame: &Frame| {
                frame.scene == scene.code() && (frame.time * f64::from(TICK_RATE)).round() as u32 == COUNTED - 1
            };
            while !is_before(&machine.next_frame()?) {}
            let (_, profile) = FrameProfile::of_next(&mut machine, &image, board.core())?;
            tick();
            Ok(Counted { board, scene, horizon: horizon(board, scene).unwrap_or_default(), profile })
        });
        scenes.collect::<Result<Vec<_>, CountError>>()
    };
    Ok(parallel(&elves, on_board).into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Until when `board` says that the frames are right, s, when it has looked ahead as far as it may. None where no motion is
/// planned.
fn horizon(board: &Board, scene: SceneName) -> Option<String> {
    let mut show = Show::on(board.processor(), scene, &scene.first_settings()).ok()?;
    for _ in 0..(PLANNED + 1.0) as u32 * TICK_RATE {
        show.tick();
    }
    let report = show.report();
    report.way.filter(|_| show.player().plan(0).found > 0)?;
    Some(format!("{:.1}{}", report.horizon, if report.is_looking { " and on" } else { "" }))
}

/// Every scene on every board, by the parts of the work.
pub fn table(frames: &[Counted]) -> Table {
    let row = |frame: &Counted| {
        let mut row = vec![frame.scene.name().to_owned(), frame.board.name.to_owned()];
        row.extend(WORK.map(|part| frame.cycles(part).to_string()));
        let share = 100.0 * frame.share();
        row.extend([frame.whole().to_string(), format!("{share:.1} %"), format!("{:.1} %", 100.0 - share)]);
        row.push(frame.horizon.clone());
        row
    };
    Table {
        name: "frames",
        title: String::from("Cost of a frame"),
        note: format!(
            "The frame of tick {COUNTED}, cycles. Sending: the frame in numbers, what has changed to the panel, which QEMU's bus \
             takes at once, and the message. Share: of a frame of 1/{TICK_RATE} s at the board's clock. Idle: what is left, for \
             commands and for the search for a plan. Right until: by the panel's clock, s. {ERROR_BAR}"
        ),
        columns: vec![
            "scene",
            "board",
            "motion",
            "drawing",
            "sending",
            "rest",
            "whole",
            "share",
            "idle",
            "right until (s)",
        ],
        rows: frames.iter().map(row).collect(),
    }
}
