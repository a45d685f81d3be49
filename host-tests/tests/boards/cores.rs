//! The golden bits on common cores, with or without a board here: every method, four motions of 640
//! steps.
//!
//! Each test loads the tools of its own core: the compiler's core library and the emulator. Without
//! them a core is skipped, and the test prints the reason.

use std::fs;
use std::io::{Write, stderr};
use std::process::Command;

use crate::support::LIMIT;
use boards::{process, toolchain};
use rayon::prelude::*;

enum Emulator {
    Machine(&'static str, &'static str),
    /// QEMU's user mode: the program runs under Linux.
    Linux,
    Node,
}
use Emulator::{Linux, Machine, Node};

/// The name, the compiler's target, the emulator and, with `f64` in hardware, the compiler's name
/// of the processor.
struct Core(&'static str, &'static str, Emulator, Option<&'static str>);

/// Returns true if a board's program for measurements runs on this core.
fn is_ours(Core(_, target, _, double): &Core) -> bool {
    toolchain::TARGETS.contains(target) && double.is_none()
}

fn emulated(core: &Core) -> anyhow::Result<Command> {
    let Core(_, target, emulator, double) = core;
    let toolchain = toolchain::set_up_for(target)?;
    let mut command = Command::new(&toolchain.qemu);
    // Machines without an operating system print by semihosting.
    match emulator {
        Machine(machine, processor) => {
            command.args(["-machine", machine, "-cpu", processor]);
            command.args(["-display", "none", "-monitor", "none", "-serial", "null"]);
            command.args(["-semihosting-config", "enable=on,target=native,arg=golden"]);
            command.arg("-kernel");
        }
        Linux => {}
        Node => {
            command.arg(toolchain::workspace().join("host-tests/boards/wasm.js"));
        }
    }
    // A failed build fails the test here; only a missing tool is returned as an error.
    let image = if is_ours(core) {
        toolchain.build("measure", target)
    } else {
        toolchain.build_cores(target, *double)
    };
    command.arg(image.unwrap_or_else(|error| panic!("{error}")));
    Ok(command)
}

/// Skips a core whose tools are missing, unless a board has this core.
fn computes_the_golden_bits(core: &Core, golden: &str) {
    let Core(name, target, _, double) = core;
    let image = (*target, *double);
    let is_built = is_ours(core) || toolchain::CORE_IMAGES.contains(&image);
    assert!(is_built, "{image:?}");
    let mut command = match emulated(core) {
        Err(missing) if is_ours(core) => panic!("{}: {missing}", name),
        Ok(command) => command,
        // The output of the test is captured, but this message is not.
        Err(missing) => {
            return writeln!(stderr(), "SKIPPED, {}: {missing}", name).expect("someone listens");
        }
    };
    let output = process::run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        output.stdout.lines().collect::<Vec<_>>(),
        golden.lines().collect::<Vec<_>>(),
        "{}: {}",
        name,
        output.stderr
    );
    assert!(output.status.success(), "{}", name);
    println!("{}: {} lines", name, golden.lines().count());
}

const OF_M0: Emulator = Machine("lm3s6965evb", "cortex-m0");
const OF_M3: Emulator = Machine("lm3s6965evb", "cortex-m3");
const OF_M4: Emulator = Machine("mps2-an386", "cortex-m4");
const OF_M7: Emulator = Machine("mps2-an500", "cortex-m7");
const OF_M33: Emulator = Machine("mps2-an505", "cortex-m33");
const OF_M55: Emulator = Machine("mps3-an547", "cortex-m55");

#[rustfmt::skip]
const CORES: [Core; 11] = [
    Core("Cortex-M0+",                  "thumbv6m-none-eabi",           OF_M0,  None),
    Core("Cortex-M3",                   "thumbv7m-none-eabi",           OF_M3,  None),
    Core("Cortex-M4F",                  "thumbv7em-none-eabihf",        OF_M4,  None),
    Core("Cortex-M7, f64 in software",  "thumbv7em-none-eabihf",        OF_M7,  None),
    Core("Cortex-M7 with double-fpu",   "thumbv7em-none-eabihf",        OF_M7,  Some("cortex-m7")),
    Core("Cortex-M33",                  "thumbv8m.main-none-eabihf",    OF_M33, None),
    Core("Cortex-M55, f64 in software", "thumbv8m.main-none-eabihf",    OF_M55, None),
    Core("Cortex-M55 with double-fpu",  "thumbv8m.main-none-eabihf",    OF_M55, Some("cortex-m55")),
    Core("RISC-V rv32imac",             "riscv32imac-unknown-none-elf", Linux,  None),
    Core("aarch64",                     "aarch64-unknown-none",         Linux,  None),
    Core("WebAssembly",                 "wasm32-unknown-unknown",       Node,   None),
];

#[test]
fn every_core_computes_the_golden_bits() {
    let file = toolchain::workspace().join("kernel/golden/bits.csv");
    let golden =
        fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    CORES
        .par_iter()
        .for_each(|core| computes_the_golden_bits(core, &golden));
}
