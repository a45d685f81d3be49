//! The page's equations in C on the target, compiled by GCC at -O3, as an alternative to this
//! kernel.
//!
//! GCC and newlib are used if they are installed. pip loads the sources of CMSIS-DSP from PyPI
//! once, by version and hash. A missing part is left out, and the report contains the reason.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use double_pendulum::Method;

use super::accuracy::{Error, SCENES, Scene, rates, request, usual_rate, worst};
use super::join::Point;
use crate::commands::count::{Target, affordable_cost};
use emulator::boards::Board;
use emulator::process;
use emulator::toolchain::{Toolchain, workspace};

/// The programs: the name in tables, and the functions for sine and cosine.
pub const PROGRAMS: [(&str, [&str; 2]); 2] = [
    ("C with newlib", ["sinf", "cosf"]),
    ("C with CMSIS-DSP", ["arm_sin_f32", "arm_cos_f32"]),
];
/// The time limit to compile, or to load 2 MB and pip's own files.
const LIMIT: Duration = Duration::from_secs(180);

/// The method in Rust with the same equations.
const TEXTBOOK: Method = Method::TextbookF32;

/// Builds the programs into `target/peers-c` of the project, runs them in QEMU, and returns the
/// costs and errors of every program on every board, in 16, 32, 64, 128 and 256 steps per second
/// through `scenes`: each with its exact angles (rad), [`SAMPLES`](super::accuracy::SAMPLES) per
/// second. In the long scene it is 256 steps only. The order is that of [`PROGRAMS`], then of the
/// targets, of the scenes, and of the steps, from the coarsest on.
///
/// Also returns a line for each program and board that cannot be built, with the reason; it has no
/// points. A program that fails on the target is an error, and so is another number of exact
/// angles.
pub fn points(
    toolchain: &Toolchain,
    targets: &[Target],
    scenes: &[(&'static Scene, Vec<[f64; 2]>)],
) -> Result<(Vec<Point>, Vec<String>)> {
    let mut points = Vec::new();
    let mut absent = Vec::new();
    let each = PROGRAMS
        .into_iter()
        .flat_map(|program| targets.iter().map(move |target| (program, target.board)));

    for ((name, sine), board) in each {
        // A program that cannot be built here is left out of the report.
        let target = match elf(sine, board) {
            Ok(elf) => Target::of(toolchain, board, elf)?,
            Err(reason) => {
                absent.push(format!("left out: {name} on {} ({reason})", board.cpu));
                continue;
            }
        };

        let step = affordable_cost(
            &target,
            &request(TEXTBOOK, &SCENES[0], usual_rate(TEXTBOOK)),
        )?;

        // The error depends on the scene and the rate, the cost of a step does not.
        for &(scene, ref exact) in scenes {
            for rate in rates(TEXTBOOK, scene, 8) {
                let error = error(&target, scene, rate, exact).context(name)?;
                points.push(Point {
                    name,
                    scene,
                    board,
                    rate,
                    step,
                    error,
                });
            }
        }
    }

    Ok((points, absent))
}

/// Compiles a program for `board`. Returns the ELF file, or the first line of the error message.
fn elf(sine: [&str; 2], board: &Board) -> Result<PathBuf> {
    let elf = format!("{}-{}.elf", sine[0], board.cpu);
    let mut build = Command::new(workspace().join("host-tests/peers/c/build.sh"));
    build.arg(board.cpu).args(sine).arg(&elf);
    // A processor with a floating-point unit also passes floating-point arguments in its registers.
    if board.target.ends_with("eabihf") {
        build.args(["-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]);
    }
    let output = process::run(&mut build, LIMIT)?;
    ensure!(
        output.status.success(),
        "{}",
        output
            .stderr
            .trim()
            .lines()
            .next()
            .unwrap_or("it cannot be built")
    );
    Ok(workspace().join("target/peers-c").join(elf))
}

/// Returns the error of the states that a program prints.
fn error(target: &Target, scene: &Scene, rate: u32, exact: &[[f64; 2]]) -> Result<Error> {
    let request = request(TEXTBOOK, scene, rate);
    let printed = target.output(&request)?;
    // Each line has two angles, as the bits of `f64` in hexadecimal digits.
    let state = |line: &str| {
        let mut bits = line
            .split_ascii_whitespace()
            .map_while(|word| u64::from_str_radix(word, 16).ok());
        Some([bits.next()?, bits.next()?].map(f64::from_bits))
    };
    let states: Vec<_> = printed.lines().filter_map(state).collect();
    ensure!(states.len() == exact.len(), "{}", printed.trim());
    Ok(worst(&request.parameters, &states, exact))
}
