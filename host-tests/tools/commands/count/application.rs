//! The costs of a frame of an application: of its scene, of all that a frame must do, and of
//! showing it; and the costs of the calls of a function. The planner's price lists are counted here
//! as well.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use cycles::{Calls, Core, Cost, Image, for_each_instruction};
use double_pendulum::Method;
use double_pendulum::plan::{Costs, Stepping};
use firmware::job::Request;
use firmware::protocol::{Command, ToHost};
use rayon::prelude::*;

use super::trace::LIMIT;
use super::{Target, affordable_cost};
use crate::commands::table::between;
use emulator::boards::Board;
use emulator::qemu::{Clock, Machine, Settings};
use emulator::toolchain::{Toolchain, workspace};

/// A function of an application: the path of its module, and its name. It is not inlined, and
/// exists once in a program.
type Place = (&'static str, &'static str);

/// The functions that compute and draw a scene.
const SCENE: [Place; 3] = [
    ("firmware::app::player::", "::tick"),
    ("firmware::app::player::", "::check"),
    ("firmware::app::player::", "::draw"),
];

/// The function that sends a frame to the panel and over the link.
const SENDING: Place = ("firmware::app::App", "::show");

/// The functions that show a frame: they draw it, and send it to the panel and over the link.
const SHOWING: [Place; 7] = [
    ("firmware::graphics::brush::", "::lighten"),
    ("firmware::graphics::canvas::", "::fade"),
    ("firmware::graphics::canvas::", "::scroll"),
    ("firmware::app::player::", "::draw"),
    ("firmware::app::player::", "::check"),
    SENDING,
    KEEPING,
];

/// The function that records a frame. It is the last one that a frame must call.
const KEEPING: Place = ("firmware::board::cortex_m::retained::", "keep");

/// The cost of one frame of an application: executed instructions (exact) and cycles (estimated).
/// All functions that the named ones call, and interrupts meanwhile, are included.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameProfile {
    /// The cost of computing and drawing the scene.
    pub scene: Cost,
    /// The cost of computing, drawing and sending: what a frame must do. Planning in the time that
    /// is left is not included.
    pub busy: Cost,
    /// The cost of drawing the frame, and of sending it to the panel and over the link.
    pub showing: Cost,
}

impl FrameProfile {
    /// Profiles what `board` executes for one of its next frames. `image` is the program that runs
    /// on it, and `core` its core. The machine is stopped after a frame, and the messages up to
    /// then are dropped.
    ///
    /// Not checked: the machine must be from [`Machine::halted`] and stopped after a frame
    /// ([`Machine::run_to_frame`]); elsewhere the profile is not of one frame, and another machine
    /// runs to its time limit. An error means that `image` lacks any of the functions of an
    /// application that compute, draw or send a frame, that an instruction has no known timing,
    /// that the board sleeps 1000 times without a frame, or that QEMU ends.
    pub fn of_next(board: &mut Machine, image: &Image, core: Core) -> Result<Self> {
        let busy = [&SCENE[..], &[SENDING]].concat();
        let parts = [&SCENE[..], &busy, &SHOWING, &[KEEPING]].map(|places| {
            let addresses = places
                .iter()
                .map(|(module, name)| address(image, module, name));
            addresses.collect::<Result<BTreeSet<u32>>>()
        });
        let [scene, busy, showing, keeping] = parts;
        let parts = [scene?, busy?, showing?, keeping?];

        // The planning that follows the last part would be several times as long as the frame.
        let end = end_of_frame(board, image)?;
        let [scene, busy, showing, keeping] =
            board.next_frame_logged(end, |log| calls_in(log, image, core, parts))?;
        ensure!(
            keeping.ended.len() == 1,
            "the log of a frame ends before its work does"
        );
        Ok(Self {
            scene: scene.cost(),
            busy: busy.cost(),
            showing: showing.cost(),
        })
    }
}

/// Runs `board` to a frame. Returns the address of the second instruction after the return from
/// [`KEEPING`], so that a log that ends before it includes the first.
fn end_of_frame(board: &mut Machine, image: &Image) -> Result<u32> {
    let (module, name) = KEEPING;
    let after = board.next_return_address(address(image, module, name)?)?;
    board.run_to_frame()?;
    Ok(after + image.instruction_at(after)?.size())
}

/// Returns the address of a function of an application. The error names a function that is missing.
fn address(image: &Image, module: &str, name: &str) -> Result<u32> {
    // Some versions of the compiler write <path::Type>::name, others path::Type::name.
    let is_it =
        |path: &str| path.trim_start_matches('<').starts_with(module) && path.ends_with(name);
    let function = image
        .functions_named(name)
        .find(|function| is_it(&function.name));
    function
        .map(|function| function.address)
        .ok_or_else(|| image.lacks(&format!("{module}..{name}")))
}

/// Returns the calls in a log of the functions that begin at the given addresses: for each set of
/// addresses, the calls from outside these functions.
fn calls_in<'a, const N: usize>(
    mut log: File,
    image: &'a Image,
    core: Core,
    entries: [BTreeSet<u32>; N],
) -> Result<[Calls<'a>; N]> {
    let mut calls = entries.map(|entries| Calls::of(image, core, entries));
    for_each_instruction(&mut log, &mut |registers| {
        calls.iter_mut().try_for_each(|calls| calls.see(registers))
    })?;
    Ok(calls)
}

/// The file of the price lists.
const PRICES_FILE: &str = "kernel/src/plan/prices.rs";
/// The lines before and after the price lists in their file.
const MARKS: [&str; 2] = [
    "// made by cargo count --write-prices\n",
    "// end of the generated part\n",
];

/// Returns the price list of every method that a plan chooses from, on one board for each kind of
/// core: a Cortex-M3, a Cortex-M4F and a Cortex-M0+, in this order. It builds the programs and runs
/// them in QEMU. An error means that a program cannot be built, that QEMU fails, that an
/// instruction has no known timing, or that a counted frame does not call the function with a
/// price.
///
/// The costs are in cycles (estimated). `preparation` is the larger of two costs: the most
/// expensive preparation of a motion when each method in turn is selected in the application, and
/// the first restart of the shadows of its plan. `fixed64` is per step: the most expensive one in a
/// frame of the application. All others are per step of 1/256 s, averages over a motion of equal
/// rods and bobs from rest at 0.5 rad; `fixed32_unlike` is per step of 2^-13 s, with a bob 2 of
/// 30 kg on a rod of 3 m, from rest at 2 rad.
pub fn prices(toolchain: &Toolchain) -> Result<Vec<(&'static Board, Costs)>> {
    let targets = Target::build_all(toolchain)?;
    targets
        .par_iter()
        .map(|target| Ok((target.board, on(target, toolchain)?)))
        .collect()
}

/// Returns the price list of the core of this target, in cycles.
fn on(target: &Target, toolchain: &Toolchain) -> Result<Costs> {
    let step = |method| {
        let request = Request {
            angles: [0.5; 2],
            ..Request::on_any_core(method)
        };
        anyhow::Ok(affordable_cost(target, &request)?.cycles as f32)
    };
    let mut unlike = Request::on_any_core(Method::Rk4Fixed32);
    unlike.parameters.m2 = 30.0;
    unlike.parameters.l2 = 3.0;
    unlike.dt = 1.0 / 8192.0;
    // Only the application has code for these two prices.
    let (fixed64, preparation) = in_application(target.board, toolchain)?;
    Ok(Costs {
        closed_form: step(Method::ClosedFormF32)?,
        direction_plain: step(Method::Rk4F32DirectionPlain)?,
        direction: step(Method::Rk4F32Direction)?,
        fixed32: step(Method::Rk4Fixed32)?,
        fixed32_unlike: affordable_cost(target, &unlike)?.cycles as f32,
        fixed64,
        preparation,
    })
}

/// The function that makes 64-bit fixed-point steps.
const STEP: &str = "Fixed64State::advance";
/// The function that prepares a motion.
const PREPARATION: &str = "PlannedRun::new";
/// The function that restarts the shadows of a plan.
const RESTART: &str = "Trial::restart_shadows";

/// Returns the costs that only the application has: a 64-bit fixed-point step of the plans' order,
/// and the most expensive preparation.
fn in_application(board: &'static Board, toolchain: &Toolchain) -> Result<(f32, f32)> {
    let elf = toolchain.build_for(board)?;
    let image = Image::read(&elf)?;
    let qemu = &toolchain.qemu;
    let settings = Settings {
        // The application is built and started, halted before its first instruction.
        qemu,
        board,
        elf: &elf,
        clock: Clock::Counted,
        debugger: true,
        limit: LIMIT,
    };

    // The first frame includes the start of the program, so it is not counted.
    let mut machine = Machine::halted(&settings)?;
    let end = end_of_frame(&mut machine, &image)?;
    let step = BTreeSet::from([image.function(STEP)?.address]);
    let [calls] =
        machine.next_frame_logged(end, |log| calls_in(log, &image, board.core(), [step]))?;
    // A call makes the steps of a frame, as many as the next frame reports.
    let messages = machine.run_to_frame()?;
    let frame = messages.into_iter().rev().find_map(ToHost::frame);
    let shown = frame.and_then(|frame| frame.report.stepping);
    let Stepping { steps, .. } = shown.context("the application shows no motion")?;
    let fixed64 = most(STEP, &calls.ended)? / steps as f32;

    // The application plans its first scene.
    let restart = image.function(RESTART)?.address;
    let [calls] = machine.next_call_logged(restart, |log| {
        calls_in(log, &image, board.core(), [BTreeSet::from([restart])])
    })?;
    let mut prepared = most(RESTART, &calls.ended)?;

    // A motion is prepared whenever the method changes, so every method is selected once.
    let preparation = image.function(PREPARATION)?.address;
    for &method in Method::DRAWN {
        machine.send(1, Command::Method(Some(method)))?;
        let [calls] = machine.next_call_logged(preparation, |log| {
            calls_in(log, &image, board.core(), [BTreeSet::from([preparation])])
        })?;
        prepared = prepared.max(most(PREPARATION, &calls.ended)?);
        machine.run_to_frame()?;
    }
    Ok((fixed64, prepared))
}

/// Returns the cycles of the most expensive of these calls of `function`. It is an error if there
/// is none, because the price would be 0.
fn most(function: &str, calls: &[Cost]) -> Result<f32> {
    let most = calls.iter().map(|call| call.cycles).max();
    most.map(|cycles| cycles as f32)
        .with_context(|| format!("{function} was not called in the counted frame: no price"))
}

/// Writes the price lists into the kernel's source, `kernel/src/plan/prices.rs`, in place of the
/// lists there, rounded to one decimal. Each is a constant named after the core of its board; not
/// checked: there is one for each kind of core, as by [`prices`]. Returns the path of the file. An
/// error means that the file cannot be read or written, or that it has lost the lines around the
/// lists.
pub fn write_prices(prices: &[(&Board, Costs)]) -> Result<PathBuf> {
    let path = workspace().join(PRICES_FILE);
    let old = std::fs::read_to_string(&path)?;
    let new = with_lists(&old, prices)
        .with_context(|| format!("{} has no place for them", path.display()))?;
    emulator::out_file::write("--write-prices", &path, new)?;
    Ok(path)
}

/// Returns the text of the file, `old`, with these price lists, or `None` if it has no place for
/// them.
fn with_lists(old: &str, prices: &[(&Board, Costs)]) -> Option<String> {
    let lists: Vec<String> = prices
        .iter()
        .map(|(board, costs)| list(board, costs))
        .collect();
    between(
        old,
        MARKS,
        &format!("impl Costs {{\n{}}}\n", lists.join("\n")),
    )
}

/// Returns the constant with the price list of a board's core, as rustfmt formats it.
fn list(board: &Board, costs: &Costs) -> String {
    let title = board.core().name();
    let name = title.to_uppercase().replace('-', "_").replace('+', "PLUS");
    let value = format!("{costs:#.1?}").replace('\n', "\n    ");
    let doc = format!("    /// The counted price list of a {title}, in cycles.\n");
    doc + &format!("    pub const {name}: Costs = {value};\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::boards::BOARDS;

    /// The price of a function is that of its most expensive call. Without a call there is no
    /// price, and the error names the function.
    #[test]
    fn a_function_that_was_not_called_has_no_price() -> Result<()> {
        let call = |cycles| Cost {
            cycles,
            ..Cost::default()
        };
        assert_eq!(most(STEP, &[call(3), call(5), call(4)])?, 5.0);
        let error = most(STEP, &[]).expect_err("no call").to_string();
        assert!(error.contains(STEP), "{error}");
        Ok(())
    }

    /// The file with its own prices written again is the same file, in the format of rustfmt.
    #[test]
    fn price_lists_are_written_as_they_are_in_the_file() -> Result<()> {
        let boards = BOARDS.iter().filter(|board| board.has_panel);
        let prices: Vec<_> = boards
            .map(|board| (board, board.processor().costs))
            .collect();
        let file = std::fs::read_to_string(workspace().join(PRICES_FILE))?;
        assert_eq!(with_lists(&file, &prices), Some(file));
        Ok(())
    }
}
