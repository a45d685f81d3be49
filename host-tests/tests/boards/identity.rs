//! The same bits from the host and from both chips, from optimised and unoptimised code, after every single step.

use std::io::Write;
use std::process::{Command, Stdio};

use double_pendulum::Method;
use firmware::job::Request;
use host_tests::commands::count::Target;
use host_tests::commands::report::identity::{Steps, compare, every_state};
use host_tests::commands::report::scene::SCENES;
use host_tests::emulator::toolchain;

/// `cargo write-report` compares a million each.
const STEPS: Steps = Steps { full: 100_000, reduced: 10_000 };
/// Unoptimised code is slow.
const STEPS_UNOPTIMISED: u32 = 10_000;

fn targets() -> Vec<Target> {
    let toolchain = toolchain::ready().unwrap_or_else(|error| panic!("{error}"));
    Target::build_all(&toolchain).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn host_and_targets_agree_after_every_step() {
    for one in compare(&targets(), STEPS, &|| ()).unwrap_or_else(|error| panic!("{error}")) {
        assert!(one.agrees(), "{one:x?}");
    }
}

/// The kernel's own code, and what it is compiled with, unoptimised: overflow checks and all.
#[test]
fn unoptimised_code_computes_the_same_bits() {
    let scenes = [&SCENES[0], &SCENES[1]];
    let requests: Vec<Request> = Method::ALL
        .iter()
        .flat_map(|&method| scenes.map(|scene| every_state(method, scene, STEPS_UNOPTIMISED)))
        .collect();
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(toolchain::workspace()).args(["run", "--quiet", "--package", "firmware", "--example", "crc"]);
    cargo.args(["--target-dir", "target/unoptimised"]);
    for package in ["double-pendulum-kernel", "firmware", "libm"] {
        cargo.args(["--config", &format!("profile.dev.package.{package}.opt-level=0")]);
    }
    let mut child = cargo.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("cargo runs");
    let mut input = child.stdin.take().expect("a pipe");
    requests.iter().try_for_each(|request| writeln!(input, "{request}")).expect("it reads");
    drop(input);
    let output = child.wait_with_output().expect("cargo ends");
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(text.lines().count(), requests.len());
    for (line, request) in text.lines().zip(&requests) {
        let optimised = request.crc().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(line, format!("{optimised:08x}"), "{}", request.method);
    }
}

/// Multiply-accumulate, by mask and value, single and double precision (ARM DDI 0403, A7.7: VMLA, VNMLA, VFMA,
/// VFNMA).
const MULTIPLY_ACCUMULATE: [(u32, u32); 4] = [
    (0xffb0_0e10, 0xee00_0a00), // vmla, vmls
    (0xffb0_0e10, 0xee10_0a00), // vnmla, vnmls
    (0xffb0_0e10, 0xeea0_0a00), // vfma, vfms
    (0xffb0_0e10, 0xee90_0a00), // vfnma, vfnms
];
/// vmul and vadd in single precision.
const MULTIPLY: (u32, u32) = (0xffb0_0f50, 0xee20_0a00);
const ADD: (u32, u32) = (0xffb0_0f50, 0xee30_0a00);

#[test]
fn nothing_is_contracted() {
    let is = |(mask, value): (u32, u32)| move |&(_, word): &(u32, u32)| word & mask == value;
    for target in targets().iter().filter(|target| target.board.cpu == "cortex-m4") {
        let words = target.image().words().into_iter();
        let words: Vec<_> = words.map(|(at, first, second)| (at, u32::from(first) << 16 | u32::from(second))).collect();
        // So many has the kernel at least, or the search would not see its code.
        for kind in [MULTIPLY, ADD] {
            assert!(words.iter().filter(|word| is(kind)(word)).count() > 500);
        }
        for kind in MULTIPLY_ACCUMULATE {
            let found = words.iter().find(|word| is(kind)(word));
            let place = found.map(|(at, word)| (target.image().function_at(*at), word));
            assert_eq!(place, None, "in {}", target.board.name);
        }
    }
}

/// The search would find them: encodings as LLVM's assembler gives them.
#[test]
fn multiply_accumulate_is_recognised() {
    let words =
        [0xee02_0a01, 0xee02_0a41, 0xee12_0a41, 0xee12_0a01, 0xeea2_0a01, 0xeea2_0a41, 0xee92_0a41, 0xee92_0a01];
    for (i, word) in words.into_iter().enumerate() {
        let kinds = MULTIPLY_ACCUMULATE.map(|(mask, value)| word & mask == value);
        assert_eq!(kinds.iter().position(|found| *found), Some(i / 2), "{word:08x}");
        assert_eq!(kinds.iter().filter(|found| **found).count(), 1, "{word:08x}");
    }
    for word in [0xee22_0a01_u32, 0xee32_0a01, 0xee82_0a01] {
        assert!(MULTIPLY_ACCUMULATE.iter().all(|(mask, value)| word & mask != *value), "{word:08x}");
    }
}
