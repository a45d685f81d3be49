//! The same bits on cores that people own, boards or not: every method, 2,560 steps of a chaotic motion.
//!
//! What a core needs is fetched by its test alone: the compiler's core library, QEMU. Where it cannot be had the test says so.

use std::io::{Write, stderr};
use std::process::Command;

use crate::support::LIMIT;
use double_pendulum::Method;
use firmware::job::Request;
use host_tests::emulator::{process, toolchain};

/// A core, and what it is emulated by.
struct Core {
    name: &'static str,
    target: &'static str,
    /// QEMU's machine and processor; none for a RISC-V, which runs under Linux.
    machine: Option<[&'static str; 2]>,
    /// What the compiler calls it, if it is to compute `f64` itself: the kernel's feature `double-fpu`.
    double: Option<&'static str>,
}

/// Its emulator with the image.
fn emulated(core: &Core) -> anyhow::Result<Command> {
    let toolchain = toolchain::set_up_for(core.target)?;
    let mut command = Command::new(match core.machine {
        Some(_) => toolchain.qemu().to_owned(),
        None => toolchain::set_up_riscv()?,
    });
    if let Some([machine, processor]) = core.machine {
        command
            .args(["-machine", machine, "-cpu", processor, "-display", "none", "-monitor", "none", "-serial", "null"]);
        command.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    }
    let image = toolchain.build_cores(core.target, core.double).unwrap_or_else(|error| panic!("{error}"));
    command.arg(image);
    Ok(command)
}

fn computes_the_hosts_bits(core: &Core) {
    let is_ours = toolchain::TARGETS.contains(&core.target) && core.double.is_none();
    let mut command = match emulated(core) {
        Err(missing) if is_ours => panic!("{}: {missing}", core.name),
        Ok(command) => command,
        // The test's output is captured; this is not.
        Err(missing) => return writeln!(stderr(), "SKIPPED, {}: {missing}", core.name).expect("someone listens"),
    };
    let output = process::run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    let host = Method::ALL.iter().map(|&method| {
        let crc = Request::on_any_core(method).crc().unwrap_or_else(|error| panic!("{error}"));
        format!("{method} {crc:08x}")
    });
    assert_eq!(output.stdout.lines().collect::<Vec<_>>(), host.collect::<Vec<_>>(), "{}: {}", core.name, output.stderr);
    assert!(output.status.success(), "{}", core.name);
    println!("{}: {} methods", core.name, Method::ALL.len());
}

macro_rules! cores {
    ($($test:ident $name:literal $target:literal $machine:expr, $double:expr;)*) => {$(
        #[test]
        fn $test() {
            computes_the_hosts_bits(&Core { name: $name, target: $target, machine: $machine, double: $double });
        }
    )*};
}

#[rustfmt::skip]
cores! {
    cortex_m0_plus    "Cortex-M0+"                         "thumbv6m-none-eabi"           Some(["lm3s6965evb", "cortex-m0"]), None;
    cortex_m3         "Cortex-M3"                          "thumbv7m-none-eabi"           Some(["lm3s6965evb", "cortex-m3"]), None;
    cortex_m4f        "Cortex-M4F"                         "thumbv7em-none-eabihf"        Some(["mps2-an386", "cortex-m4"]),  None;
    cortex_m7         "Cortex-M7, f64 in software"         "thumbv7em-none-eabihf"        Some(["mps2-an500", "cortex-m7"]),  None;
    cortex_m7_double  "Cortex-M7 with double-fpu"          "thumbv7em-none-eabihf"        Some(["mps2-an500", "cortex-m7"]),  Some("cortex-m7");
    cortex_m33        "Cortex-M33"                         "thumbv8m.main-none-eabihf"    Some(["mps2-an505", "cortex-m33"]), None;
    cortex_m55        "Cortex-M55, f64 in software"        "thumbv8m.main-none-eabihf"    Some(["mps3-an547", "cortex-m55"]), None;
    cortex_m55_double "Cortex-M55 with double-fpu"         "thumbv8m.main-none-eabihf"    Some(["mps3-an547", "cortex-m55"]), Some("cortex-m55");
    riscv_imac        "RISC-V rv32imac"                    "riscv32imac-unknown-none-elf" None,                               None;
}
