//! `cargo simulate`: any motion as a table, computed here, or by the firmware on an emulated board
//! from the same request.

mod options;
mod request;
mod tolerance;

pub use options::{Place, SimulateOptions, StartOptions};
pub use request::{Plan, check_turns, plan};
pub use tolerance::choose;

use std::fmt::{Display, LowerExp};
use std::io::{self, BufWriter, Write, stdout};
use std::time::Duration;

use anyhow::{Context, anyhow, bail, ensure};
use double_pendulum::{Method, Numbers, Pendulum};
use firmware::job::{ON_BOARDS, Reading, Request};
use firmware::protocol::{Answer, Command};

use console::cli::{Refused, complain, say};
use console::progress::Progress;
use emulator::boards::Board;
use emulator::link::refusal;
use emulator::out_file::OutFile;
use emulator::qemu::{Clock, Machine, Settings};
use emulator::toolchain;

/// Prints the table of methods or the motion, or writes the motion to the file of the options. The
/// motion is CSV: a heading, a row of the start, and a row for each `--every` until `--until`.
/// Options that cannot be used, also a file that cannot be written, are [`Refused`] before the
/// first row. With a board as the place, missing tools are installed and the board is emulated; a
/// tool that cannot be provided is [`Refused`], too. Notes and advice go to stderr.
///
/// A motion that diverges later, or a board that fails, is an error after the rows before it; these
/// are kept, also in the file. The file replaces an existing one after the last of these rows; if
/// there is no row, it remains unchanged.
pub fn run(options: &SimulateOptions) -> anyhow::Result<()> {
    if options.list {
        return Ok(say(list())?);
    }

    // Everything that can be wrong is reported before the first row, the file before the search
    // for a method.
    let file = options.out.as_ref();
    let file = file.map(|path| OutFile::create("--out", path).map(|file| (path, file)));
    let file = file.transpose()?;
    let planned = match &options.tolerance {
        Some(tolerance) => choose(options, tolerance).map(|(plan, _)| plan),
        None => plan(options),
    };
    let plan = planned.map_err(|error| Refused::because(format_args!("{error:#}")))?;
    let notes = options.start.advice().into_iter().chain(plan.note.clone());
    notes.for_each(complain);

    // Without a file the rows are printed.
    let Some((path, mut file)) = file else {
        let (rows, done) = write_rows(&plan, options, &mut stdout().lock())?;
        return done.with_context(|| after(rows));
    };

    let (rows, done) =
        write_rows(&plan, options, &mut file).map_err(|error| file.failed(&error))?;

    // The rows before an error are correct, so they are kept.
    if rows > 0 {
        file.finish()?;
        say(format_args!("wrote {}", path.display()))?;
    }
    done.with_context(|| after(rows))
}

/// Returns the context of an error: the number of rows before it.
fn after(rows: u64) -> String {
    format!("after {rows} rows")
}

/// Writes the rows. Returns their number and how the motion ended, or an error if the rows cannot
/// be written.
fn write_rows(
    plan: &Plan,
    options: &SimulateOptions,
    output: &mut impl Write,
) -> io::Result<(u64, anyhow::Result<()>)> {
    let mut output = BufWriter::new(output);
    let bar = Progress::of("rows", u64::from(plan.request.samples) + 1);
    let mut rows = 0;
    let mut unwritten = None;
    // The heading is written with the first row, so that a motion that fails at once prints
    // nothing.
    let mut write = |reading: &Reading| -> anyhow::Result<()> {
        bar.advance(1);
        let head = (rows == 0).then(|| header(options) + "\n");
        let line = head.unwrap_or_default() + &row(plan, options, rows, reading);
        writeln!(output, "{line}").map_err(|error| {
            unwritten = Some(error);
            anyhow!("a row cannot be written")
        })?;
        rows += 1;
        Ok(())
    };
    // The motion is computed here, or on a board by the same code.
    let done = match options.place {
        None => plan.request.readings(&mut write),
        Some(board) => on_board(&plan.request, board, &mut write),
    };
    drop(bar);
    // An error of the output is not an error of the motion.
    match unwritten {
        Some(error) => Err(error),
        None => output.flush().map(|()| (rows, done)),
    }
}

/// The time limit to start QEMU and to send the rows.
const OVERHEAD: Duration = Duration::from_secs(120);
/// The time limit of a step. A step takes at most 200,000 instructions (f64 in steps of order 8,
/// `cargo count`), and a busy host executes 10 million a second.
const PER_STEP: Duration = Duration::from_millis(20);

/// Sends the request to the firmware on `board` and passes each reading to `row`. An error means
/// that the board cannot be built or started, refuses the request, or loses a row.
fn on_board(
    request: &Request,
    board: &'static Board,
    mut row: impl FnMut(&Reading) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let toolchain = toolchain::set_up()?;
    let elf = toolchain.build_for(board)?;
    let limit = OVERHEAD
        .saturating_add(PER_STEP.saturating_mul(request.stride.saturating_mul(request.samples)));

    let settings = Settings {
        qemu: &toolchain.qemu,
        board,
        elf: &elf,
        clock: Clock::Real,
        debugger: true,
        limit,
    };
    let mut machine = Machine::start(&settings)?;

    // The first frame shows that the board receives commands.
    machine.next_frame().context(board.name)?;
    machine.send(1, Command::Simulate(*request))?;
    let mut expected = 0;

    while expected <= request.samples {
        match machine.next_answer().context(board.name)? {
            (_, Answer::Refused(field)) => bail!(
                "{}: the board refuses the request: {}",
                board.name,
                refusal(field)
            ),
            (_, Answer::Sample { index, reading }) => {
                ensure!(
                    index == expected,
                    "{}: row {expected} was lost on the way",
                    board.name
                );
                row(&reading)?;
                expected += 1;
            }
            _ => {}
        }
    }

    Ok(())
}

/// The columns and their units. x points to the right and y upwards from the pivot.
const NAMES: [&str; 12] = [
    "t", "a1", "a2", "p1", "p2", "w1", "w2", "energy", "x1", "y1", "x2", "y2",
];
const UNITS: [&str; 12] = [
    "s", "rad", "rad", "kg m^2/s", "kg m^2/s", "rad/s", "rad/s", "J", "m", "m", "m", "m",
];

/// Returns the first line: the columns of the options, with units if they demand it.
fn header(options: &SimulateOptions) -> String {
    let name = |&column: &usize| match options.units {
        true => format!("{} [{}]", NAMES[column], UNITS[column]),
        false => NAMES[column].to_owned(),
    };
    let bits = NAMES[1..5]
        .iter()
        .filter(|_| options.bits)
        .map(|name| format!("{name}_bits"));
    options
        .columns
        .iter()
        .map(name)
        .chain(bits)
        .collect::<Vec<_>>()
        .join(",")
}

/// Returns the line of a reading: the columns of the options. `number` counts the rows from 0.
fn row(plan: &Plan, options: &SimulateOptions, number: u64, reading: &Reading) -> String {
    let Reading {
        state: [a1, a2, p1, p2],
        velocities: [w1, w2],
        energy,
    } = *reading;
    // The positions follow from the angles.
    let pendulum = Pendulum::<f64>::new(&plan.request.parameters);
    let bobs = pendulum.map(|pendulum| pendulum.positions([a1, a2]).map(|bob| [bob.x, bob.y]));
    let [[x1, y1], [x2, y2]] = bobs.unwrap_or([[f64::NAN; 2]; 2]);

    let numbers = [
        plan.every.times(number),
        a1,
        a2,
        p1,
        p2,
        w1,
        w2,
        energy,
        x1,
        y1,
        x2,
        y2,
    ];

    // Numbers of a method in `f32` are printed with the digits of an `f32`.
    let is_single = plan.request.method.numbers() == Numbers::F32;
    let numbers = options.columns.iter().map(|&column| match numbers[column] {
        number if is_single && column != 0 => shortest(number as f32),
        number => shortest(number),
    });
    let bits = reading
        .state
        .iter()
        .filter(|_| options.bits)
        .map(|&number| match is_single {
            true => format!("{:08x}", (number as f32).to_bits()),
            false => format!("{:016x}", number.to_bits()),
        });
    numbers.chain(bits).collect::<Vec<_>>().join(",")
}

/// Returns the fewest digits that are parsed to the same number, in exponent form if that is
/// shorter.
fn shortest(number: impl Display + LowerExp) -> String {
    let plain = number.to_string();
    let exponent = format!("{number:e}");
    if exponent.len() < plain.len() {
        exponent
    } else {
        plain
    }
}

/// Returns a line for each method: name, equations, numbers, integrator, order, and where it runs.
fn list() -> String {
    const HEAD: &str =
        "method                   equations   numbers         integrator     order  runs on";
    let line = |method: &Method| {
        let name = method.name();
        let order = method.order();
        let equations = method.equations().to_string();
        let numbers = method.numbers().to_string();
        let integrator = method.integrator().to_string();
        // Only some methods are available on the boards or usable for drawing.
        let boards = if ON_BOARDS.contains(method) {
            ", boards"
        } else {
            ""
        };
        let scenes = if Method::DRAWN.contains(method) {
            ", scenes"
        } else {
            ""
        };
        format!(
            "\n{name:24} {equations:11} {numbers:15} {integrator:14} {order:>5}  \
             host{boards}{scenes}"
        )
    };
    HEAD.to_owned() + &Method::ALL.iter().map(line).collect::<String>()
}
