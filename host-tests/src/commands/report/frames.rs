//! What a frame costs: of every scene on every board, by the parts of the work, and one by function; and until when the
//! frames are right.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

use double_pendulum::plan::{Limit, Method, Plan};
use firmware::config::{PLANNED, TICK_RATE};
use firmware::motion::planner::{Shown, problem};
use firmware::protocol::{Choose, Frame};
use firmware::scenes::SceneName;

use super::parallel;
use crate::commands::count::{CountError, ERROR_BAR, FrameProfile, Image, Part};
use crate::commands::plan::judge;
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
/// The functions listed.
const FUNCTIONS: usize = 24;

/// What motion, drawing and sending took before the trail became ink, the brush took one pass and the panel was sent what has
/// changed, on the first two boards: the scenes by their codes, this tick, counted in this way.
#[rustfmt::skip]
const EARLIER: [[[u64; 3]; 12]; 2] = [[
    [81_664, 174_102, 93_597], // page
    [9_658, 115_325, 79_059], // small-0.2
    [9_658, 140_114, 79_064], // small-1
    [9_658, 146_016, 79_060], // small-5
    [105, 156_113, 71_838], // frequencies
    [91_694, 90_799, 92_158], // beats-3-2
    [91_438, 91_963, 92_030], // beats-2-1
    [91_739, 90_171, 92_090], // beats-5-2
    [91_696, 89_912, 92_102], // beats-3-1
    [128_824, 126_698, 93_986], // figure-7
    [155_923, 129_788, 80_460], // butterfly
    [139_782, 115_035, 77_909], // upright
], [
    [3_034, 163_879, 87_637], // page
    [1_246, 108_742, 74_038], // small-0.2
    [1_246, 130_926, 74_037], // small-1
    [1_246, 135_908, 74_038], // small-5
    [137, 144_940, 73_599], // frequencies
    [4_407, 88_574, 86_208], // beats-3-2
    [4_407, 89_699, 86_149], // beats-2-1
    [4_407, 87_888, 86_205], // beats-5-2
    [4_407, 87_623, 86_214], // beats-3-1
    [4_328, 108_149, 88_011], // figure-7
    [29_527, 119_661, 76_130], // butterfly
    [6_920, 110_107, 73_952], // upright
]];

/// In how many steps to a frame that version computed every motion, in compensated `f32`, but for small oscillations.
const EARLIER_STEPS: u32 = 4;

/// A scene's frame on a board.
#[derive(Debug)]
pub struct Counted {
    /// The board.
    pub board: &'static Board,
    /// The scene.
    pub scene: SceneName,
    horizons: [String; 2],
    profile: FrameProfile,
    /// By function and part, cycles.
    functions: BTreeMap<(String, Part), u64>,
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
        let settings = Settings {
            qemu: toolchain.qemu(),
            board,
            elf,
            clock: Clock::Counted,
            window: None,
            debugger: true,
            limit: LIMIT,
        };
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
            let functions = by_function(&profile, &image);
            Ok(Counted { board, scene, horizons: horizons(board, scene).unwrap_or_default(), profile, functions })
        });
        scenes.collect::<Result<Vec<_>, CountError>>()
    };
    Ok(parallel(&elves, on_board).into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Until when `board` says that the frames are right, s, when it has looked ahead as far as it may; and until when they were
/// in that earlier version, by the reference. Empty where no motion is planned.
fn horizons(board: &Board, scene: SceneName) -> Option<[String; 2]> {
    let settings = scene.first_settings();
    let mut show = Show::on(board.processor(), scene, &settings).ok()?;
    for _ in 0..(PLANNED + 1.0) as u32 * TICK_RATE {
        show.tick();
    }
    let (report, answer) = (show.report(), show.player().plan(0));
    let way = report.way.filter(|_| answer.found > 0)?;
    let (method, steps) =
        if way.method == Method::ClosedForm { (way.method, 0) } else { (Method::Direction, EARLIER_STEPS) };
    let earlier =
        Plan { method, steps, dt: 0.0, error: 0.0, cost: 0.0, horizon: 0.0, limit: Limit::Method, spent: 0.0 };
    let motion = problem(&settings, &Shown { way: None, height: answer.height as f32 });
    let until = |seconds: f64, or_longer| format!("{seconds:.1}{}", if or_longer { " and on" } else { "" });
    let before = judge(&motion, &earlier).ok()?.horizon;
    Some([until(report.horizon.into(), report.is_looking), until(before, before >= motion.duration)])
}

fn by_function(profile: &FrameProfile, image: &Image) -> BTreeMap<(String, Part), u64> {
    let mut functions = BTreeMap::new();
    for part in WORK {
        for (address, spot) in profile.part(part).into_iter().flat_map(|profile| profile.spots()) {
            let name = image.function_at(address).map_or_else(|| String::from("?"), |function| short(&function.name));
            *functions.entry((name, part)).or_default() += spot.cost.cycles;
        }
    }
    functions
}

/// Of `<path::Type<R> as Trait>::name` and of `path::Type::name` the last two words.
fn short(name: &str) -> String {
    let Some((path, name)) = name.rsplit_once("::") else { return name.to_owned() };
    let path = path.trim_start_matches('<').split(['<', '>', ' ']).next().unwrap_or_default();
    format!("{}::{name}", path.rsplit("::").next().unwrap_or_default())
}

/// Every scene on every board, by the parts of the work.
pub fn table(frames: &[Counted]) -> Table {
    let earlier = |frame: &Counted| {
        let board = BOARDS.iter().position(|board| board == frame.board)?;
        let parts = EARLIER.get(board)?.get(usize::from(frame.scene.code()))?;
        Some(parts.map(|cycles| cycles.to_string()).join(" + "))
    };
    let row = |frame: &Counted| {
        let mut row = vec![frame.scene.name().to_owned(), frame.board.name.to_owned()];
        row.extend(WORK.map(|part| frame.cycles(part).to_string()));
        let share = 100.0 * frame.share();
        row.extend([frame.whole().to_string(), format!("{share:.1} %"), format!("{:.1} %", 100.0 - share)]);
        let [horizon, before] = frame.horizons.clone();
        row.extend([horizon, earlier(frame).unwrap_or_default(), before]);
        row
    };
    Table {
        name: "frames",
        title: String::from("Cost of a frame"),
        note: format!(
            "The frame of tick {COUNTED}, cycles. Sending: the frame in numbers, what has changed to the panel, which QEMU's bus \
             takes at once, and the message. Share: of a frame of 1/{TICK_RATE} s at the board's clock. Idle: what is left, for \
             commands and for the search for a plan. Right until: by the panel's clock, s. Earlier: motion, drawing and sending \
             of a version before, recorded then, and until when its frames were right, by the reference. {ERROR_BAR}"
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
            "earlier",
            "right until (s), earlier",
        ],
        rows: frames.iter().map(row).collect(),
    }
}

/// The first frame counted, by function.
pub fn functions(frames: &[Counted]) -> Table {
    let frame = frames.first();
    let mut functions: Vec<_> = frame.iter().flat_map(|frame| &frame.functions).collect();
    functions.sort_by_key(|(name, cycles)| (std::cmp::Reverse(**cycles), *name));
    let whole = frame.map_or(0, Counted::whole);
    let listed = functions.into_iter().take(FUNCTIONS).map(|((name, part), cycles)| {
        let share = 100.0 * *cycles as f64 / whole as f64;
        vec![name.clone(), format!("{part:?}").to_lowercase(), cycles.to_string(), format!("{share:.1} %")]
    });
    Table {
        name: "functions",
        title: String::from("A frame by function"),
        note: frame.map_or_else(String::new, |frame| {
            let (scene, board) = (frame.scene.name(), frame.board.name);
            format!(
                "The scene {scene} on {board}, the frame of tick {COUNTED}: the {FUNCTIONS} functions that take most of its \
                 {whole} cycles, without what they call. {ERROR_BAR}"
            )
        }),
        columns: vec!["function", "part", "cycles", "share"],
        rows: listed.collect(),
    }
}
