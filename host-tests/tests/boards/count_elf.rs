//! `cargo count --elf`: any function of any program, and a clear message if it cannot be counted.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{LIMIT, toolchain};
use cycles::{ERROR_BAR, Image};
use emulator::boards::BOARDS;
use emulator::process::{self, Output};

/// Builds a program at an address that calls a function and a label three times each and then
/// executes `last`.
fn program(folder: &Path, address: &str, last: &str) -> PathBuf {
    const SOURCE: &str = r#"
#![no_std]
#![no_main]
core::arch::global_asm!("
.section .text.program, \"ax\"
.thumb
.syntax unified
.global start
.word 0x20004000
.word start + 1
.rept 14
.word wait + 1
.endr
start:
movs r4, #3
1: bl {step}
bl label
subs r4, #1
bne 1b
LAST
movs r0, #0x18
bkpt 0xab
wait: wfi
b wait
label: movs r0, #7
bx lr
never: bx lr
", step = sym inner::step);
mod inner {
    #[inline(never)]
    pub extern "C" fn step(x: u32) -> u32 { core::hint::black_box(x) + 1 }
}
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! { loop {} }
"#;
    let source = folder.join("program.rs");
    let elf = folder.join(format!("{address}-{}.elf", last.len()));
    std::fs::write(&source, SOURCE.replace("LAST", last)).unwrap_or_else(|error| panic!("{error}"));

    // The program has its own linker options, and no start-up code.
    let mut rustc = Command::new("rustc");
    rustc.args([
        "--edition",
        "2024",
        "-O",
        "-C",
        "panic=abort",
        "--target",
        BOARDS[0].target,
    ]);
    for option in [
        "--entry=start",
        "--image-base=0",
        "--nmagic",
        &format!("-Ttext={address}"),
    ] {
        rustc.arg(format!("-Clink-arg={option}"));
    }

    rustc.arg("-o").arg(&elf).arg(&source);
    let output = process::run(&mut rustc, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    assert!(output.status.success(), "{output:?}");
    elf
}

/// The time limit of a program that never ends: many times the time until it waits, on a busy
/// machine too.
const SECONDS: [&str; 2] = ["--seconds", "6"];
/// The ends of programs: success, failure, an endless wait (asleep, because an endless loop would
/// fill the log), or an instruction that needs a floating-point unit.
const ENDS: &str = "ldr r1, =0x20026";
const FAILS: &str = "ldr r1, =0x020023";
const WAITS: &str = "b wait";
const NEEDS_FLOATS: &str = ".inst.w 0xee300a00 @ vadd.f32 s0, s0, s0";
/// A call of a function that loads a floating-point register right after another load.
const LOADS_FLOATS: &str = "bl floats
b wait
floats: ldr r0, [sp]
.inst.w 0xed9d0a00 @ vldr s0, [sp]
bx lr";

/// Runs `cargo count` for a function of a program on the first board.
fn count(elf: &Path, function: &str, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-tests"));
    command
        .args([
            "count",
            "--on",
            BOARDS[0].name,
            "--function",
            function,
            "--elf",
        ])
        .arg(elf)
        .args(more);
    process::run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"))
}

/// A label and a function that are called three times are counted, with their mean number of
/// instructions and cycles, by the name and by the mangled name. It is reported whether the program
/// ended or was stopped after the time limit.
#[test]
fn functions_and_labels_are_counted_and_the_end_is_reported() -> anyhow::Result<()> {
    let folder = tempfile::tempdir()?;
    let elf = program(folder.path(), "0x0", ENDS);

    // A label of a program that ends without help.
    let output = count(&elf, "label", &[]);
    assert!(
        output.stderr.contains("the program ended, exit status: 0"),
        "{output:?}"
    );
    let lines: Vec<_> = output.stdout.lines().collect();
    let [head, limits, _, instructions, cycles] = lines[..] else {
        panic!("{output:?}")
    };
    assert_eq!(
        head,
        "label on lm3s6965evb, from its first instruction to its return: calls 3"
    );
    assert_eq!(limits, ERROR_BAR);
    let mean = |line: &str| {
        line.split_ascii_whitespace()
            .nth(1)
            .and_then(|mean| mean.parse::<f64>().ok())
    };
    assert_eq!(
        (mean(instructions), mean(cycles)),
        (Some(2.0), Some(4.0)),
        "a move, and a return with its refill"
    );

    // A function by its name, and by its mangled name.
    let image = Image::read(&elf)?;
    let mangled = &image.function("program::inner::step")?.symbol;
    let by_name = count(&elf, "program::inner::step", &[]);
    let is_it =
        |line: &str| line.starts_with("program::inner::step on") && line.ends_with(": calls 3");
    assert!(
        by_name.stdout.lines().next().is_some_and(is_it),
        "{by_name:?}"
    );
    assert_eq!(count(&elf, mangled, &[]).stdout, by_name.stdout);

    // Counting ends when the program is stopped.
    let output = count(&program(folder.path(), "0x0", WAITS), "label", &SECONDS);
    assert!(
        output.status.success() && output.stdout.contains(": calls 3\n"),
        "{output:?}"
    );
    assert!(
        output.stderr.contains("stopped after 6 s and 3 calls"),
        "{output:?}"
    );
    Ok(())
}

/// A missing file, a file of another kind or machine, a function that is unknown, ambiguous, never
/// called or never returns, and a program that fails or that the board cannot start: each has its
/// own reason as the last line of stderr, its exit code, and no output.
#[test]
fn a_function_that_cannot_be_counted_is_an_error_of_one_line() -> anyhow::Result<()> {
    // The program reports why it refuses an empty request and ends with failure.
    let measure = toolchain().build("measure", BOARDS[0].target)?;
    let host = Path::new(env!("CARGO_BIN_EXE_host-tests"));
    let folder = tempfile::tempdir()?;
    let [ends, fails, floats, loads] =
        [ENDS, FAILS, NEEDS_FLOATS, LOADS_FLOATS].map(|last| program(folder.path(), "0x0", last));
    let elsewhere = program(folder.path(), "0x8000000", ENDS);

    // A file, a function in it, the reason of the error, and the exit code.
    for (elf, function, reason, code) in [
        (
            Path::new("/nowhere/to/be/found.elf"),
            "main",
            "No such file",
            2,
        ),
        (
            Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")),
            "main",
            "Unknown file magic",
            2,
        ),
        (host, "main", "no program for ARM but for", 2),
        (
            &measure,
            "nothing_of_this_name",
            "no function nothing_of_this_name",
            2,
        ),
        (&measure, "counted_steps", "counted_steps may be any of ", 2),
        (
            &measure,
            "__aeabi_ddiv",
            "the program failed after 0 calls, exit status: 1: ",
            1,
        ),
        (
            &fails,
            "label",
            "the program failed after 3 calls, exit status: 1",
            1,
        ),
        (&ends, "never", "never was never called", 2),
        (&ends, "start", "start was called and never returned", 2),
        (
            &elsewhere,
            "label",
            "never called: the program has nothing at 0x0, where lm3s6965evb reads its vectors",
            2,
        ),
        (
            &floats,
            "never",
            "never was never called: vadd, vsub at ",
            2,
        ),
        (
            &loads,
            "floats",
            " is no instruction of a Cortex-M3; choose another core",
            2,
        ),
    ] {
        // An error prints nothing on stdout, and its last line is the reason.
        let output = count(elf, function, &SECONDS);
        assert_eq!(
            (output.status.code(), output.stdout.as_str()),
            (Some(code), ""),
            "{output:?}"
        );
        assert!(
            output
                .stderr
                .lines()
                .last()
                .is_some_and(|line| line.contains(reason)),
            "{reason}: {output:?}"
        );
    }

    Ok(())
}
