//! Links the firmware's binaries for a chip: the memory map, the vector table and defmt's string table.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    // The code asks by this name for what a Cortex-M0+ lacks.
    println!("cargo:rustc-check-cfg=cfg(armv6m)");
    if env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv6m")) {
        println!("cargo:rustc-cfg=armv6m");
    }
    let is = |name: &str, value: &str| env::var(name).as_deref() == Ok(value);
    if !is("CARGO_CFG_TARGET_OS", "none") || !is("CARGO_CFG_TARGET_ARCH", "arm") {
        return;
    }
    // From the workspace's folder, in which the linker runs: a checkout that was moved keeps what it has built.
    println!("cargo:rustc-link-search=.");
    println!("cargo:rustc-link-search=firmware/src/board");
    println!("cargo:rerun-if-changed=src/board");
    // The emulated boards' flash starts at 0; this chip's starts elsewhere and has 1 MiB.
    for argument in [
        "--defsym=flash_origin=0x08000000",
        "--defsym=flash_length=0x00100000",
        "-Tstm32f405/stm32f405.x",
    ] {
        println!("cargo:rustc-link-arg-bin=stm32f405={argument}");
    }
    // The Pico's flash begins with the stage that its boot ROM runs first.
    let pico = [
        "--defsym=flash_origin=0x10000100",
        "--defsym=flash_length=0x001fff00",
        "-Tpico/pico.x",
    ];
    // With relocations, which tell the tests who refers to which function; they take no flash.
    let any = ["-Tlink.x", "-Tdefmt.x", "--nmagic", "--emit-relocs"];
    pico.iter()
        .for_each(|argument| println!("cargo:rustc-link-arg-bin=pico={argument}"));
    // The example with a colour panel is for the Pico, too.
    if env::var_os("CARGO_FEATURE_COLOUR_PANEL").is_some() {
        pico.iter()
            .chain(&any)
            .for_each(|argument| println!("cargo:rustc-link-arg-examples={argument}"));
    }
    // A Cortex-M33 or M55 starts on its secure side, which sees its memory here.
    if is("TARGET", "thumbv8m.main-none-eabihf") {
        for place in [
            "flash_origin=0x10000000",
            "ram_origin=0x30000000",
            "ram_length=0x00008000",
        ] {
            println!("cargo:rustc-link-arg-bin=cores=--defsym={place}");
        }
    }
    any.iter()
        .for_each(|argument| println!("cargo:rustc-link-arg-bins={argument}"));
}
