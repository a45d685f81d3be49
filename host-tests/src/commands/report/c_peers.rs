//! The page's equations in C on the target, compiled by GCC at -O3: what one would write there without this kernel.
//!
//! GCC and newlib are used if they are installed; CMSIS-DSP's sources are fetched from PyPI by pip, once, by version and
//! hash. What cannot be had is left out, and the report says why.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use double_pendulum::Method;

use super::accuracy::{Error, SCENES, Scene, rates, request, usual_rate, worst};
use super::join::Point;
use crate::commands::count::{Target, affordable_cost};
use crate::emulator::boards::Board;
use crate::emulator::process;
use crate::emulator::toolchain::{Toolchain, workspace};

/// What each program takes its sine and cosine from: its name in tables, and the functions.
pub const PROGRAMS: [(&str, [&str; 2]); 2] = [
    ("C with newlib", ["sinf", "cosf"]),
    ("C with CMSIS-DSP", ["arm_sin_f32", "arm_cos_f32"]),
];
/// For compiling, and for fetching 2 MB and what pip wants for it.
const LIMIT: Duration = Duration::from_secs(180);

/// What the programs compute, in Rust.
const TEXTBOOK: Method = Method::TextbookF32;

/// Cost and errors of every program on every board, through scenes with their exact motions. Also says what had to be left out,
/// and why.
pub fn points(
    toolchain: &Toolchain,
    targets: &[Target],
    scenes: &[(&'static Scene, Vec<[f64; 2]>)],
) -> Result<(Vec<Point>, Vec<String>)> {
    let (mut points, mut absent) = (Vec::new(), Vec::new());
    let each = PROGRAMS
        .into_iter()
        .flat_map(|program| targets.iter().map(move |target| (program, target.board)));
    for ((name, sine), board) in each {
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

/// Compiles a program for `board`; the ELF file, or the first line of the complaint.
fn elf(sine: [&str; 2], board: &Board) -> Result<PathBuf> {
    let elf = format!("{}-{}.elf", sine[0], board.cpu);
    let mut build = Command::new(workspace().join("host-tests/peers-c/build.sh"));
    build.arg(board.cpu).args(sine).arg(&elf);
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

/// The error of the states that a program prints.
fn error(target: &Target, scene: &Scene, rate: u32, exact: &[[f64; 2]]) -> Result<Error> {
    let request = request(TEXTBOOK, scene, rate);
    let printed = target.output(&request)?;
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
