//! The page's equations in C on the target, compiled by GCC at -O3: what one would write there without this kernel.
//!
//! GCC and newlib are used if they are installed; CMSIS-DSP's sources are fetched from PyPI by pip, once, by version and
//! hash. What cannot be had is left out, and the report says why.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::{Result, ensure};
use double_pendulum::Method;

use super::accuracy::{Error, LONG, SCENES, Scene, request, worst};
use super::join::Point;
use crate::commands::count::{Target, affordable_cost};
use crate::emulator::boards::Board;
use crate::emulator::process;
use crate::emulator::toolchain::{Toolchain, workspace};

/// What each program takes its sine and cosine from: its name in tables, and the functions.
pub const PROGRAMS: [(&str, [&str; 2]); 2] = [("C with newlib", ["sinf", "cosf"]), ("C with CMSIS-DSP", CMSIS_SINE)];
const CMSIS_SINE: [&str; 2] = ["arm_sin_f32", "arm_cos_f32"];

const COMPILER: &str = "arm-none-eabi-gcc";
/// For compiling, and for fetching 2 MB and what pip wants for it.
const LIMIT: Duration = Duration::from_secs(180);
/// Our sources, in the workspace, and what is made of them.
const SOURCES: &str = "host-tests/peers-c";
const MADE: &str = "target/peers-c";
/// The folder in CMSIS-DSP's archive, and what of it is compiled.
const CMSIS: &str = "cmsisdsp-1.10.3";
const CMSIS_SOURCES: [&str; 3] = [
    "Source/FastMathFunctions/arm_sin_f32.c",
    "Source/FastMathFunctions/arm_cos_f32.c",
    "Source/CommonTables/arm_common_tables.c",
];

/// Steps a second of what a step is counted with, the last of all that errors are computed with.
const RATE: u32 = 256;
const RATES: [u32; 5] = [16, 32, 64, 128, RATE];
/// What the programs compute, in Rust.
const TEXTBOOK: Method = Method::TextbookF32;

pub struct Program {
    name: &'static str,
    target: Target,
}

/// Every program for every board. Also says what had to be left out, and why.
pub fn compile(toolchain: &Toolchain, targets: &[Target]) -> Result<(Vec<Program>, Vec<String>)> {
    let (mut programs, mut absent) = (Vec::new(), Vec::new());
    for (name, sine) in PROGRAMS {
        for board in targets.iter().map(|target| target.board) {
            match elf(sine, board) {
                Ok(elf) => programs.push(Program { name, target: Target::of(toolchain, board, elf)? }),
                Err(reason) => absent.push(format!("left out: {name} on {} ({reason})", board.cpu)),
            }
        }
    }
    Ok((programs, absent))
}

/// Compiles a program for `board`; the ELF file.
fn elf(sine: [&str; 2], board: &Board) -> Result<PathBuf> {
    let folder = workspace().join(MADE);
    fs::create_dir_all(&folder)?;
    let elf = folder.join(format!("{}-{}.elf", sine[0], board.cpu));
    let mut command = Command::new(COMPILER);
    command.current_dir(workspace()).args(["-std=gnu11", "-O3", "-mthumb"]).arg(format!("-mcpu={}", board.cpu));
    if board.target.ends_with("eabihf") {
        command.args(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
    }
    command.args(["measure.c", "textbook.c"].map(|file| format!("{SOURCES}/{file}")));
    command.args([format!("-DSIN={}", sine[0]), format!("-DCOS={}", sine[1])]);
    if sine == CMSIS_SINE {
        let cmsis = cmsis_dsp(&folder)?;
        command.arg("-D__GNUC_PYTHON__"); // the library's name for: without the headers of CMSIS-Core
        command.args(["Include", "PrivateInclude"].map(|folder| format!("-I{}", cmsis.join(folder).display())));
        command.args(CMSIS_SOURCES.map(|file| cmsis.join(file)));
    }
    command.args(["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]);
    command.args(["-nostartfiles", "--specs=nosys.specs", "-T"]).arg(format!("{SOURCES}/link.ld"));
    run(command.arg("-lm").arg("-o").arg(&elf))?;
    Ok(elf)
}

/// The folder with CMSIS-DSP's sources, fetched if they are not there.
fn cmsis_dsp(folder: &Path) -> Result<PathBuf> {
    let unpacked = folder.join(CMSIS);
    if !unpacked.exists() {
        let mut fetch = Command::new("python3");
        fetch.args(["-m", "pip", "download", "--quiet", "--retries", "1", "--no-deps", "--no-binary", "cmsisdsp"]);
        fetch.arg("--requirement").arg(workspace().join(SOURCES).join("cmsis-dsp.txt"));
        run(fetch.arg("--dest").arg(folder))?;
        let unpacking = tempfile::tempdir_in(folder)?;
        let archive = folder.join(format!("{CMSIS}.tar.gz"));
        run(Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(unpacking.path()))?;
        fs::rename(unpacking.path().join(CMSIS), &unpacked)?;
    }
    Ok(unpacked)
}

/// Runs a command; the first line of its complaint if it fails.
fn run(command: &mut Command) -> Result<()> {
    let output = process::run(command, LIMIT)?;
    let program = command.get_program().to_string_lossy();
    ensure!(output.status.success(), "{program} failed: {}", output.stderr.trim().lines().next().unwrap_or_default());
    Ok(())
}

impl Program {
    /// Its cost and its errors through scenes with their exact motions.
    pub fn points(&self, scenes: &[(&'static Scene, Vec<[f64; 2]>)]) -> Result<Vec<Point>> {
        let step = affordable_cost(&self.target, &request(TEXTBOOK, &SCENES[0], RATE))?;
        let (name, board) = (self.name, self.target.board);
        let mut points = Vec::new();
        for &(scene, ref exact) in scenes {
            for rate in RATES.into_iter().filter(|&rate| scene != &LONG || rate == RATE) {
                let error = self.error(scene, rate, exact)?;
                points.push(Point { name, scene, board, rate, step, error, dominated: false });
            }
        }
        Ok(points)
    }

    /// The error of the states that it prints.
    fn error(&self, scene: &Scene, rate: u32, exact: &[[f64; 2]]) -> Result<Error> {
        let request = request(TEXTBOOK, scene, rate);
        let printed = self.target.output(&request)?;
        let state = |line: &str| {
            let mut bits = line.split_ascii_whitespace().map_while(|word| u64::from_str_radix(word, 16).ok());
            Some([bits.next()?, bits.next()?].map(f64::from_bits))
        };
        let states: Vec<_> = printed.lines().filter_map(state).collect();
        ensure!(states.len() == exact.len(), "{}: {}", self.name, printed.trim());
        Ok(worst(&request.parameters, &states, exact))
    }
}
