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

use super::accuracy::{Error, ReportedMotion, SCENES, rates, request, usual_rate, worst};
use super::join::Point;
use crate::count::{Target, affordable_cost};
use boards::Board;
use boards::process;
use boards::toolchain::{Toolchain, workspace};

pub const PROGRAMS: [(&str, [&str; 2]); 2] = [
    ("C with newlib", ["sinf", "cosf"]),
    ("C with CMSIS-DSP", ["arm_sin_f32", "arm_cos_f32"]),
];
const LIMIT: Duration = Duration::from_secs(180);

/// The method in Rust with the same equations.
const TEXTBOOK: Method = Method::TextbookF32;

/// Builds the programs, runs them in QEMU, and returns the costs and errors of every program on
/// every board, and a line for each that cannot be built.
pub fn points(
    toolchain: &Toolchain,
    targets: &[Target],
    scenes: &[(&'static ReportedMotion, Vec<[f64; 2]>)],
) -> Result<(Vec<Point>, Vec<String>)> {
    let mut points = Vec::new();
    let mut absent = Vec::new();
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

fn error(target: &Target, scene: &ReportedMotion, rate: u32, exact: &[[f64; 2]]) -> Result<Error> {
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
