//! `cargo simulate`: any motion as a table, computed here, or by the firmware on an emulated board
//! from the same request.

mod options;
mod request;
mod second_run;
mod tolerance;

pub use options::{Place, SimulateOptions, StartOptions};
pub use request::{Rows, plan};
pub use tolerance::{Choice, choose};

use std::fmt::{Display, LowerExp};
use std::io::{self, BufWriter, Write, stdout};
use std::time::Duration;

use anyhow::{Context, anyhow, bail, ensure};
use double_pendulum::{Method, Numbers, Pendulum};
use firmware::job::{ON_BOARDS, Reading, Request};
use firmware::protocol::{Answer, Command};

use boards::Board;
use boards::console::cli::{Refused, complain, say};
use boards::console::progress::Progress;
use boards::link::refusal;
use boards::out_file::OutFile;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::toolchain;
use second_run::SecondRun;

struct Job<'a> {
    options: &'a SimulateOptions,
    request: Request,
    rows: Rows,
    /// The accuracy of the rows, if the search for a method has measured it.
    note: Option<String>,
    end: Option<String>,
}

/// Prints the table of methods, or the motion as CSV. A line on stderr, which is the last line of a
/// file, too, says until when the rows hold.
pub fn run(options: &SimulateOptions) -> anyhow::Result<()> {
    if options.list {
        return Ok(say(list())?);
    }

    // The file is refused before the search for a method.
    let file = options.out.as_ref();
    let file = file
        .map(|path| OutFile::create("--out", path))
        .transpose()?;
    let job = Job::new(options).map_err(|error| Refused::because(format_args!("{error:#}")))?;
    options.start.advice().iter().for_each(complain);

    let Some(mut file) = file else {
        let Written { rows, note, done } = job.write(&mut stdout().lock())?;
        if rows > 0 {
            complain(format_args!("note: {note}"));
        }
        return done;
    };
    let written = job.write(&mut file);
    let Written { rows, note, done } = written.map_err(|error| file.failed(&error))?;

    // The rows before an error are correct, so they are kept.
    if rows > 0 {
        writeln!(file, "# {note}").map_err(|error| file.failed(&error))?;
        let path = file.path().to_owned();
        file.finish()?;
        complain(format_args!("note: {note}"));
        say(format_args!("wrote {}", path.display()))?;
    }
    done
}

struct Written {
    rows: u32,
    note: String,
    done: anyhow::Result<()>,
}

impl<'a> Job<'a> {
    fn new(options: &'a SimulateOptions) -> anyhow::Result<Self> {
        if let Some(scene) = options.scene.filter(|scene| !scene.has_angles()) {
            bail!(
                "--scene {}: has no motion to compute; choose another scene, as in --scene page",
                scene.name()
            );
        }
        if let Some(tolerance) = &options.tolerance {
            let Choice {
                request,
                rows,
                note,
                end,
                ..
            } = choose(options, tolerance)?;
            return Ok(Self {
                options,
                request,
                rows,
                note: Some(note),
                end,
            });
        }
        let (request, rows) = plan(options)?;
        Ok(Self {
            options,
            request,
            rows,
            note: None,
            end: None,
        })
    }

    fn write(&self, output: &mut impl Write) -> io::Result<Written> {
        let Self {
            options,
            request,
            rows,
            ..
        } = self;
        let mut output = BufWriter::new(output);
        let mut second = SecondRun::new(request, rows.time(1));
        let bar = Progress::of("rows", u64::from(request.samples) + 1);
        let mut number = 0;
        let mut unwritten = None;
        let mut write = |reading: &Reading| -> anyhow::Result<()> {
            bar.advance(1);
            let time = rows.time(number);
            if self.note.is_none() {
                let [a1, a2, ..] = reading.state;
                second.compare(time, [a1, a2]);
            }
            // A motion that fails at once prints no heading.
            let head = (number == 0).then(|| header(options) + "\n");
            let line = head.unwrap_or_default() + &row(request, options, time, reading);
            writeln!(output, "{line}").map_err(|error| {
                unwritten = Some(error);
                anyhow!("a row cannot be written")
            })?;
            number += 1;
            Ok(())
        };
        let done = match options.place {
            None => request.readings(&mut write),
            Some(board) => on_board(request, board, &mut write),
        };
        drop(bar);

        if let Some(error) = unwritten {
            return Err(error);
        }
        output.flush()?;
        let done = match (done, &self.end) {
            (Ok(()), Some(end)) => Err(anyhow!("{end}")),
            (done, _) if number == 0 => done,
            (done, _) => done.with_context(|| format!("after {number} rows")),
        };
        Ok(Written {
            rows: number,
            note: self.note.clone().unwrap_or_else(|| second.words()),
            done,
        })
    }
}

const OVERHEAD: Duration = Duration::from_secs(120);
/// A step takes at most 200,000 instructions (f64 in steps of order 8, `cargo count`), and a busy
/// host executes 10 million a second.
const PER_STEP: Duration = Duration::from_millis(20);

fn on_board(
    request: &Request,
    board: &'static Board,
    mut row: impl FnMut(&Reading) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let toolchain = toolchain::set_up()?;
    let elf = toolchain.build_for(board)?;
    let limit = OVERHEAD
        .saturating_add(PER_STEP.saturating_mul(request.stride.saturating_mul(request.samples)));

    let settings = MachineSettings {
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

/// x points to the right and y upwards from the pivot.
const NAMES: [&str; 12] = [
    "t", "a1", "a2", "p1", "p2", "w1", "w2", "energy", "x1", "y1", "x2", "y2",
];
const UNITS: [&str; 12] = [
    "s", "rad", "rad", "kg m^2/s", "kg m^2/s", "rad/s", "rad/s", "J", "m", "m", "m", "m",
];

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

fn row(request: &Request, options: &SimulateOptions, time: f64, reading: &Reading) -> String {
    let Reading {
        state: [a1, a2, p1, p2],
        velocities: [w1, w2],
        energy,
    } = *reading;
    let pendulum = Pendulum::<f64>::new(&request.parameters);
    let bobs = pendulum.map(|pendulum| pendulum.positions([a1, a2]).map(|bob| [bob.x, bob.y]));
    let [[x1, y1], [x2, y2]] = bobs.unwrap_or([[f64::NAN; 2]; 2]);

    let numbers = [time, a1, a2, p1, p2, w1, w2, energy, x1, y1, x2, y2];

    // Numbers of a method in `f32` are printed with the digits of an `f32`.
    let is_single = request.method.numbers() == Numbers::F32;
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

/// Returns the fewest digits that are parsed to the same number.
fn shortest(number: impl Display + LowerExp) -> String {
    let plain = number.to_string();
    let exponent = format!("{number:e}");
    if exponent.len() < plain.len() {
        exponent
    } else {
        plain
    }
}

fn list() -> String {
    const HEAD: &str =
        "method                   equations   numbers         integrator     order  runs on";
    let line = |method: &Method| {
        let name = method.name();
        let order = method.order();
        let equations = method.equations().to_string();
        let numbers = method.numbers().to_string();
        let integrator = method.integrator().to_string();
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
