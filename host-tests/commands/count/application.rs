//! The costs of a frame of an application, and the planner's price lists.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use cycles::{Calls, Core, Cost, Image, for_each_instruction};
use double_pendulum::Method;
use double_pendulum::plan::Costs;
use firmware::job::Request;
use rayon::prelude::*;

use super::trace::LIMIT;
use super::{Target, cost_within};
use crate::table::between;
use boards::Board;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::toolchain::{Toolchain, workspace};

/// The path of a function's module, and its name. It is not inlined.
type Place = (&'static str, &'static str);

const SCENE: [Place; 3] = [
    ("firmware::app::player::", "::tick"),
    ("firmware::app::player::", "::check"),
    ("firmware::app::player::", "::draw"),
];

const SENDING: Place = ("firmware::app::App", "::show");

const SHOWING: [Place; 6] = [
    ("firmware::graphics::brush::", "::lighten"),
    ("firmware::graphics::canvas::", "::fade"),
    ("firmware::graphics::canvas::", "::scroll"),
    ("firmware::app::player::", "::draw"),
    SENDING,
    KEEPING,
];

/// The last function that a frame must call.
const KEEPING: Place = ("firmware::board::cortex_m::retained::", "keep");

/// The cost of one frame, with all calls and interrupts.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameProfile {
    /// The cost of computing and drawing.
    pub scene: Cost,
    /// The cost of computing, drawing and sending. Planning in the time that is left is not
    /// included.
    pub busy: Cost,
    /// The cost of drawing and sending.
    pub showing: Cost,
}

impl FrameProfile {
    /// Profiles the next frame of `board`, a machine from [`Machine::halted`] that is stopped after
    /// a frame.
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

/// Returns the calls of these functions from outside of them.
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

const PRICES_FILE: &str = "kernel/src/plan/prices.rs";
const MARKS: [&str; 2] = [
    "// made by cargo count --write-prices\n",
    "// end of the generated part\n",
];

/// The instructions that are counted for a price. Of three times as many, the average differs by at
/// most 1 %, but every `cargo verify` would take 5 s longer.
const PRICED: u64 = 120_000;

/// Returns the price list of every method that a plan chooses from, on one board for each kind of
/// core. Three prices are of first calls in the plan of the application's first scene: `fixed64`,
/// `comparison`, and `preparation`, the most expensive of a motion's, of the search's start and of a
/// restart of its shadows. All others are averages over a regular motion; `fixed32_unlike` is of
/// unlike bobs and rods.
pub fn prices(toolchain: &Toolchain) -> Result<Vec<(&'static Board, Costs)>> {
    let targets = Target::build_all(toolchain)?;
    targets
        .par_iter()
        .map(|target| Ok((target.board, on(target, toolchain)?)))
        .collect()
}

fn on(target: &Target, toolchain: &Toolchain) -> Result<Costs> {
    let step = |method| {
        let request = Request {
            angles: [0.5; 2],
            ..Request::on_any_core(method)
        };
        anyhow::Ok(cost_within(PRICED, target, &request)?.cycles as f32)
    };
    let mut unlike = Request::on_any_core(Method::Rk4Fixed32);
    unlike.parameters.m2 = 30.0;
    unlike.parameters.l2 = 3.0;
    unlike.dt = 1.0 / 8192.0;
    let planning = in_application(target.board, toolchain)?;
    let mut costs = Costs::all(0.0);
    costs.closed_form = step(Method::ClosedFormF32)?;
    costs.direction_plain = step(Method::Rk4F32DirectionPlain)?;
    costs.direction = step(Method::Rk4F32Direction)?;
    costs.fixed32 = step(Method::Rk4Fixed32)?;
    costs.fixed32_unlike = cost_within(PRICED, target, &unlike)?.cycles as f32;
    costs.fixed64 = planning.step;
    costs.preparation = planning.preparation;
    costs.comparison = planning.comparison;
    Ok(costs)
}

/// The functions of the planner that have a price.
const STEP: &str = "::measure";
const COMPARISON: &str = "Race::compare";
/// A race first prepares its reference, at more than twice the cost of any other motion.
const PREPARATIONS: [&str; 3] = ["Search::new", "Race::prepare", "Uncertainty::restart"];

/// The prices that only the application has code for.
struct Planning {
    step: f32,
    preparation: f32,
    comparison: f32,
}

fn in_application(board: &'static Board, toolchain: &Toolchain) -> Result<Planning> {
    let elf = toolchain.build_for(board)?;
    let image = Image::read(&elf)?;
    let qemu = &toolchain.qemu;
    let settings = MachineSettings {
        qemu,
        board,
        elf: &elf,
        clock: Clock::Counted,
        debugger: true,
        limit: LIMIT,
    };

    let price = |name: &str| {
        let mut machine = Machine::halted(&settings)?;
        let function = image.function(name)?.address;
        let [calls] = machine.next_call_logged(function, |log| {
            calls_in(log, &image, board.core(), [BTreeSet::from([function])])
        })?;
        most(name, &calls.ended)
    };
    let preparations = PREPARATIONS.map(price);
    let preparations = preparations.into_iter().collect::<Result<Vec<_>>>()?;
    Ok(Planning {
        step: price(STEP)?,
        preparation: preparations.into_iter().fold(0.0, f32::max),
        comparison: price(COMPARISON)?,
    })
}

fn most(function: &str, calls: &[Cost]) -> Result<f32> {
    let most = calls.iter().map(|call| call.cycles).max();
    most.map(|cycles| cycles as f32)
        .with_context(|| format!("{function} was not called in the counted frame: no price"))
}

/// Writes the price lists into the kernel's source.
pub fn write_prices(prices: &[(&Board, Costs)]) -> Result<PathBuf> {
    let path = workspace().join(PRICES_FILE);
    let old = std::fs::read_to_string(&path)?;
    let new = with_lists(&old, prices)
        .with_context(|| format!("{} has no place for them", path.display()))?;
    boards::out_file::write("--write-prices", &path, new)?;
    Ok(path)
}

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
    use boards::BOARDS;

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
