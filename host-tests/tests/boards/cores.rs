//! The same bits on cores that people own, boards or not: every method, 2,560 steps of a chaotic motion.
//!
//! What a core needs is fetched by its test alone: the compiler's core library, QEMU. Where it cannot be had the test says so.

use std::io::{Write, stderr};
use std::process::Command;

use crate::support::LIMIT;
use double_pendulum::Method;
use firmware::job::Request;
use host_tests::emulator::{process, toolchain};
use rayon::prelude::*;

/// A core: its name, the compiler's target, QEMU's machine and processor, none for a RISC-V, which runs under Linux; and what the
/// compiler calls it if it is to compute `f64` itself, the kernel's feature `double-fpu`.
struct Core(
    &'static str,
    &'static str,
    Option<[&'static str; 2]>,
    Option<&'static str>,
);

/// Its emulator with the image.
fn emulated(Core(_, target, machine, double): &Core) -> anyhow::Result<Command> {
    let toolchain = toolchain::set_up_for(target)?;
    let mut command = Command::new(&toolchain.qemu);
    if let Some([machine, processor]) = machine {
        command.args([
            "-machine", machine, "-cpu", processor, "-display", "none", "-monitor", "none",
            "-serial", "null",
        ]);
        command.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    }
    let image = toolchain
        .build_cores(target, *double)
        .unwrap_or_else(|error| panic!("{error}"));
    command.arg(image);
    Ok(command)
}

fn computes_the_hosts_bits(core: &Core) {
    let Core(name, target, _, double) = core;
    let is_ours = toolchain::TARGETS.contains(target) && double.is_none();
    let mut command = match emulated(core) {
        Err(missing) if is_ours => panic!("{}: {missing}", name),
        Ok(command) => command,
        // The test's output is captured; this is not.
        Err(missing) => {
            return writeln!(stderr(), "SKIPPED, {}: {missing}", name).expect("someone listens");
        }
    };
    let output = process::run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    let host = Method::ALL.iter().map(|&method| {
        let crc = Request::on_any_core(method)
            .crc()
            .unwrap_or_else(|error| panic!("{error}"));
        format!("{method} {crc:08x}")
    });
    assert_eq!(
        output.stdout.lines().collect::<Vec<_>>(),
        host.collect::<Vec<_>>(),
        "{}: {}",
        name,
        output.stderr
    );
    assert!(output.status.success(), "{}", name);
    println!("{}: {} methods", name, Method::ALL.len());
}

#[rustfmt::skip]
const CORES: [Core; 9] = [
    Core("Cortex-M0+",                  "thumbv6m-none-eabi",           Some(["lm3s6965evb", "cortex-m0"]),   None),
    Core("Cortex-M3",                   "thumbv7m-none-eabi",           Some(["lm3s6965evb", "cortex-m3"]),   None),
    Core("Cortex-M4F",                  "thumbv7em-none-eabihf",        Some(["mps2-an386", "cortex-m4"]),    None),
    Core("Cortex-M7, f64 in software",  "thumbv7em-none-eabihf",        Some(["mps2-an500", "cortex-m7"]),    None),
    Core("Cortex-M7 with double-fpu",   "thumbv7em-none-eabihf",        Some(["mps2-an500", "cortex-m7"]),    Some("cortex-m7")),
    Core("Cortex-M33",                  "thumbv8m.main-none-eabihf",    Some(["mps2-an505", "cortex-m33"]),   None),
    Core("Cortex-M55, f64 in software", "thumbv8m.main-none-eabihf",    Some(["mps3-an547", "cortex-m55"]),   None),
    Core("Cortex-M55 with double-fpu",  "thumbv8m.main-none-eabihf",    Some(["mps3-an547", "cortex-m55"]),   Some("cortex-m55")),
    Core("RISC-V rv32imac",             "riscv32imac-unknown-none-elf", None,                                 None),
];

#[test]
fn every_core_computes_the_hosts_bits() {
    CORES.par_iter().for_each(computes_the_hosts_bits);
}
