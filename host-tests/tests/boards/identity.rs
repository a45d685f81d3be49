//! Bit-identical results of the host and the boards, of optimised and unoptimised code, after every
//! single step. The test `cores` compares the golden bits on more cores.

use std::process::Command;

use crate::support::targets;
use anyhow::Result;
use boards::toolchain;
use cycles::{Core, Instruction};
use double_pendulum::{Method, Parameters};
use firmware::job::Request;
use host_tests::report::accuracy::{ReportedMotion, SCENES, request};
use rayon::prelude::*;

/// Fewer on the Cortex-M0+, which has no long products.
const STEPS: [u32; 2] = [1_000_000, 100_000];
const STEPS_UNOPTIMISED: u32 = 10_000;
const RATE: u32 = 256;
const MOTIONS: [&ReportedMotion; 2] = [&SCENES[0], &SCENES[1]];

fn every_state(method: Method, scene: &ReportedMotion, steps: u32) -> Request {
    Request {
        samples: steps,
        stride: 1,
        ..request(method, scene, RATE)
    }
}

#[test]
#[ignore = "takes hours"]
fn host_and_targets_agree_after_every_one_of_a_million_steps() -> Result<()> {
    let targets = targets();
    let motions = || {
        MOTIONS
            .iter()
            .flat_map(|scene| Method::ALL.iter().map(move |&method| (scene, method)))
    };
    let runs: Vec<_> = targets
        .iter()
        .flat_map(|target| motions().map(move |motion| (target, motion)))
        .collect();
    runs.into_par_iter()
        .try_for_each(|(target, (scene, method))| {
            let steps = STEPS[usize::from(target.board.core() == Core::M0Plus)];
            // The CRC covers every state, so one different bit anywhere is noticed.
            let request = every_state(method, scene, steps);
            let host = request.crc()?;
            let (crc, _) = target.run(&request)?;
            assert_eq!(
                crc, host,
                "{method}, {} on {}",
                scene.name, target.board.name
            );
            Ok(())
        })
}

#[test]
#[ignore = "compiles kernel and firmware again; `.ci/run` runs it"]
fn unoptimised_code_computes_the_same_bits() {
    let requests: Vec<_> = Method::ALL
        .iter()
        .map(|&method| every_state(method, MOTIONS[1], STEPS_UNOPTIMISED))
        .collect();
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(toolchain::workspace()).args([
        "run",
        "--quiet",
        "--package=firmware",
        "--example=crc",
        "--no-default-features",
    ]);
    for package in ["double-pendulum-kernel", "firmware", "libm"] {
        cargo.args([
            "--config",
            &format!("profile.dev.package.{package}.opt-level=0"),
        ]);
    }

    let Request {
        parameters: Parameters { m1, m2, l1, l2, g },
        angles: [a1, a2],
        velocities: [w1, w2],
        dt,
        stride,
        samples,
        ..
    } = requests[0];
    let numbers = [m1, m2, l1, l2, g, a1, a2, w1, w2, dt];
    cargo
        .arg("--")
        .args(numbers.map(|number| number.to_string()));
    cargo.args([stride, samples].map(|number| number.to_string()));
    let output = cargo.output().expect("cargo runs");
    assert!(output.status.success(), "{output:?}");

    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(text.lines().count(), requests.len());
    for (line, request) in text.lines().zip(&requests) {
        let optimised = request.crc().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(line, format!("{optimised:08x}"), "{}", request.method);
    }
}

/// The rows of the timing table for instructions that round once where the kernel rounds twice.
const CONTRACTED: [&str; 4] = ["vmla, vmls", "vnmla, vnmls", "vfma, vfms", "vfnma, vfnms"];
/// The rows for the separate instructions. The kernel must contain them; otherwise the search does
/// not see its code.
const SEPARATE: [&str; 2] = ["vmul, vnmul", "vadd, vsub"];

#[test]
fn nothing_is_contracted() {
    for target in targets()
        .iter()
        .filter(|target| target.board.cpu == "cortex-m4")
    {
        let words = target.image.words().into_iter();
        let row = |(at, first, second): (u32, u16, Option<u16>)| {
            Some((
                at,
                Instruction::decode(first, second.unwrap_or_default())?
                    .row
                    .name,
            ))
        };
        let rows: Vec<_> = words.filter_map(row).collect();
        for name in SEPARATE {
            assert!(
                rows.iter().filter(|(_, row)| *row == name).count() > 500,
                "{name}"
            );
        }

        let found = rows.iter().find(|(_, row)| CONTRACTED.contains(row));
        let place = found.map(|(at, row)| (target.image.function_at(*at), row));
        assert_eq!(place, None, "in {}", target.board.name);
    }
}
