//! The page's equations in C on the target, compiled by GCC at -O3: what one would write there without this kernel.
//!
//! GCC and newlib are used if they are installed; CMSIS-DSP's sources are fetched from PyPI by pip, once, by version and
//! hash. What cannot be had is left out, and the report says why.

use std::path::PathBuf;
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
pub const PROGRAMS: [(&str, [&str; 2]); 2] =
    [("C with newlib", ["sinf", "cosf"]), ("C with CMSIS-DSP", ["arm_sin_f32", "arm_cos_f32"])];
/// For compiling, and for fetching 2 MB and what pip wants for it.
const LIMIT: Duration = Duration::from_secs(180);

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

/// Compiles a program for `board`; the ELF file, or the first line of the complaint.
fn elf(sine: [&str; 2], board: &Board) -> Result<PathBuf> {
    let elf = format!("{}-{}.elf", sine[0], board.cpu);
    let mut build = Command::new(workspace().join("host-tests/peers-c/build.sh"));
    build.arg(board.cpu).args(sine).arg(&elf);
    if board.target.ends_with("eabihf") {
        build.args(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
    }
    let output = process::run(&mut build, LIMIT)?;
    ensure!(output.status.success(), "{}", output.stderr.trim().lines().next().unwrap_or("it cannot be built"));
    Ok(workspace().join("target/peers-c").join(elf))
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
