//! The page's equations in C on the target, compiled by GCC at -O3: what one would write there without this kernel.
//!
//! GCC and newlib are used if they are installed; CMSIS-DSP's sources are fetched from PyPI by pip, once, by version and
//! hash. What cannot be had is left out, and the table says why.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use double_pendulum::Method;
use firmware::job::Request;

use super::accuracy::{Contestant, Error, Point, worst};
use super::costs::{self, Cost};
use super::parallel;
use super::scene::{LONG, SCENES, Scene};
use crate::commands::count::{CountError, ERROR_BAR, StepCost, Target};
use crate::commands::table::{Table, small};
use crate::emulator::boards::{BOARDS, Board};
use crate::emulator::process;
use crate::emulator::toolchain::{Toolchain, workspace};

const COMPILER: &str = "arm-none-eabi-gcc";
/// For compiling, and for fetching 2 MB and what pip wants for it.
const LIMIT: Duration = Duration::from_secs(180);
/// Our sources, in the workspace.
const SOURCES: &str = "host-tests/peers-c";
/// What is made of them.
const MADE: &str = "target/peers-c";
/// The folder in CMSIS-DSP's archive, and the archive.
const CMSIS: &str = "cmsisdsp-1.10.3";
/// What of it is compiled.
const CMSIS_SOURCES: [&str; 3] = [
    "Source/FastMathFunctions/arm_sin_f32.c",
    "Source/FastMathFunctions/arm_cos_f32.c",
    "Source/CommonTables/arm_common_tables.c",
];
/// Methods of the kernel that stand beside, the one that the others are compared with last.
const BESIDE: [Method; 3] = [TEXTBOOK, Method::Rk4F32, Method::Rk4F32Direction];
/// What the C programs compute, in Rust.
const TEXTBOOK: Method = Method::TextbookF32;

/// Steps a second of what a step is counted with, and all that its errors are computed with.
pub const RATE: u32 = 256;
const RATES: [u32; 5] = [16, 32, 64, 128, RATE];

/// Where a C program takes its sine from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sine {
    Newlib,
    CmsisDsp,
}

impl Sine {
    const ALL: [Self; 2] = [Self::Newlib, Self::CmsisDsp];

    fn name(self) -> &'static str {
        match self {
            Self::Newlib => "C textbook: newlib's sinf and cosf",
            Self::CmsisDsp => "C textbook: CMSIS-DSP's arm_sin_f32 and arm_cos_f32",
        }
    }

    /// Compiles the program for `board`; the ELF file, or why there is none.
    fn compile(self, board: &Board) -> Result<PathBuf, String> {
        let (root, folder) = (workspace(), workspace().join(MADE));
        fs::create_dir_all(&folder).map_err(|error| format!("cannot make {MADE}: {error}"))?;
        let elf = folder.join(format!("{self:?}-{}.elf", board.cpu).to_lowercase());
        let mut command = Command::new(COMPILER);
        command.current_dir(root).args(["-std=gnu11", "-O3", "-mthumb"]).arg(format!("-mcpu={}", board.cpu));
        if board.target.ends_with("eabihf") {
            command.args(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
        }
        let sources = ["measure.c", "textbook.c"].map(|file| format!("{SOURCES}/{file}"));
        command.args(sources);
        match self {
            Self::Newlib => command.args(["-DSIN=sinf", "-DCOS=cosf"]),
            Self::CmsisDsp => {
                let cmsis = cmsis_dsp(&folder)?;
                command.args(["-DSIN=arm_sin_f32", "-DCOS=arm_cos_f32"]);
                command.arg("-D__GNUC_PYTHON__"); // the library's name for: without the headers of CMSIS-Core
                command.args(["Include", "PrivateInclude"].map(|folder| format!("-I{}", cmsis.join(folder).display())));
                command.args(CMSIS_SOURCES.map(|file| cmsis.join(file)))
            }
        };
        command.args(["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]);
        command.args(["-nostartfiles", "--specs=nosys.specs", "-T"]).arg(format!("{SOURCES}/link.ld"));
        run(command.arg("-lm").arg("-o").arg(&elf))?;
        Ok(elf)
    }
}

/// The folder with CMSIS-DSP's sources, fetched if they are not there.
fn cmsis_dsp(folder: &Path) -> Result<PathBuf, String> {
    let unpacked = folder.join(CMSIS);
    if !unpacked.exists() {
        let mut fetch = Command::new("python3");
        fetch.args(["-m", "pip", "download", "--quiet", "--retries", "1", "--no-deps", "--no-binary", "cmsisdsp"]);
        fetch.arg("--requirement").arg(workspace().join(SOURCES).join("cmsis-dsp.txt"));
        run(fetch.arg("--dest").arg(folder))?;
        let unpacking = tempfile::tempdir_in(folder).map_err(|error| error.to_string())?;
        let archive = folder.join(format!("{CMSIS}.tar.gz"));
        run(Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(unpacking.path()))?;
        fs::rename(unpacking.path().join(CMSIS), &unpacked).map_err(|error| error.to_string())?;
    }
    Ok(unpacked)
}

/// Runs a command; the first line of its complaint if it fails.
fn run(command: &mut Command) -> Result<(), String> {
    let output = process::run(command, LIMIT).map_err(|error| error.to_string())?;
    let reason = || output.stderr.trim().lines().next().unwrap_or_default().to_owned();
    let program = || command.get_program().to_string_lossy().into_owned();
    if output.status.success() { Ok(()) } else { Err(format!("{} failed: {}", program(), reason())) }
}

/// One program's steps on one board.
#[derive(Clone, Debug)]
pub struct Counted {
    /// What it computes with.
    pub name: &'static str,
    /// The board.
    pub board: &'static Board,
    /// Per step of 1/256 s.
    pub step: StepCost,
    /// The largest error through each of the scenes.
    pub points: Vec<Point>,
    /// The same through the long scene, in steps of 1/256 s.
    pub long: Error,
}

impl Counted {
    /// The largest error through the first scene in steps of 1/256 s.
    pub fn error(&self) -> Option<Error> {
        self.points.iter().find(|point| point.scene == &SCENES[0] && point.rate == RATE).map(|point| point.error)
    }
}

/// Counts the C programs on the boards of `targets` through the first scene and compares their states through those that
/// `exact` and `long` are the exact motions of. Also says what had to be left out, and why.
pub fn count(
    toolchain: &Toolchain,
    targets: &[Target],
    exact: &[Vec<[f64; 2]>],
    long: &[[f64; 2]],
) -> Result<(Vec<Counted>, String), CountError> {
    let mut absent = String::new();
    let mut programs = Vec::new();
    for sine in Sine::ALL {
        for target in targets {
            match sine.compile(target.board) {
                Ok(elf) => programs.push((sine, Target::of(toolchain, target.board, elf)?)),
                Err(reason) => {
                    absent = format!("{absent} Left out: {} on {} ({reason}).", sine.name(), target.board.cpu);
                }
            }
        }
    }
    let counted = parallel(&programs, |(sine, target)| {
        let (name, step) = (sine.name(), costs::one(target, &request(&SCENES[0], RATE))?);
        let mut points = Vec::new();
        for (scene, exact) in SCENES.iter().zip(exact) {
            for rate in RATES {
                let error = error(target, scene, rate, exact)?;
                points.push(Point { scene, contestant: Contestant::C(name), rate, error });
            }
        }
        let long = error(target, &LONG, RATE, long)?;
        Ok(Counted { name, board: target.board, step, points, long })
    });
    Ok((counted.into_iter().collect::<Result<_, CountError>>()?, absent))
}

/// The request through `scene` with `rate` steps a second.
fn request(scene: &Scene, rate: u32) -> Request {
    super::accuracy::request(TEXTBOOK, scene, rate)
}

/// The error of the states that a program prints.
fn error(target: &Target, scene: &Scene, rate: u32, exact: &[[f64; 2]]) -> Result<Error, CountError> {
    let request = request(scene, rate);
    let printed = target.output(&request)?;
    let mut states = Vec::new();
    for line in printed.lines() {
        let bits = line.split_ascii_whitespace().map(|word| u64::from_str_radix(word, 16));
        if let Ok([a1, a2, ..]) = bits.collect::<Result<Vec<_>, _>>().as_deref() {
            states.push([*a1, *a2].map(f64::from_bits));
        }
    }
    if states.len() == exact.len() {
        Ok(worst(scene, &states, exact))
    } else {
        Err(CountError::Refused { request: request.method.to_string(), reason: printed.trim().to_owned() })
    }
}

/// The C programs beside some of the kernel's arithmetics.
pub fn table((counted, absent): &(Vec<Counted>, String), points: &[Point], costs: &[Cost]) -> Table {
    let scene = &SCENES[0];
    let mut rows = Vec::new();
    for board in BOARDS.iter().filter(|board| costs.iter().any(|cost| cost.board == *board)) {
        let theirs = counted.iter().filter(|one| one.board == board);
        let theirs = theirs.filter_map(|one| Some((one.name.to_owned(), one.step, one.error()?)));
        let ours = BESIDE.iter().filter_map(|method| {
            let contestant = Contestant::Kernel(*method);
            let is_it = |point: &&Point| point.contestant == contestant && point.scene == scene && point.rate == RATE;
            let cost = costs::of(costs, *method, scene, board)?;
            Some((method.to_string(), cost.step, points.iter().find(is_it)?.error))
        });
        let ours: Vec<_> = ours.collect();
        let unit = ours.last().map_or(f64::NAN, |(_, step, _)| step.cycles);
        for (name, step, error) in theirs.chain(ours) {
            let mut row = vec![name, board.cpu.to_owned()];
            row.extend([step.instructions, step.cycles].map(|count| format!("{count:.0}")));
            row.push(format!("{:.2}", step.cycles / unit));
            row.extend([step.code_bytes, step.stack_bytes].map(|count| count.to_string()));
            row.extend([small(error.angle), small(error.pixels)]);
            rows.push(row);
        }
    }
    Table {
        name: "target-peers",
        title: String::from("The page's equations in C on the target"),
        note: format!(
            "Per step; scene {}, step 1/{RATE} s, error over the scene. GCC at -O3, which may contract multiplication \
             and addition; counted like all others. {ERROR_BAR} Relative: estimated cycles against \
             rk4-f32-direction.{absent}",
            scene.name,
        ),
        columns: vec![
            "method",
            "processor",
            "instructions",
            "cycles (estimate)",
            "relative",
            "code bytes",
            "stack bytes",
            "error (rad)",
            "error (pixels)",
        ],
        rows,
    }
}
