//! Links the firmware's binaries for a chip: the memory map, the vector table and defmt's string
//! table.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../memory.x");
    // The Pico drives either an OLED or a colour panel, which this variable names.
    println!("cargo:rerun-if-env-changed=PANEL");
    println!("cargo:rustc-check-cfg=cfg(lcd)");
    if env::var("PANEL").is_ok_and(|name| name.contains("lcd") || name.contains("display")) {
        println!("cargo:rustc-cfg=lcd");
    }
    // The code uses this name for features that a Cortex-M0+ lacks.
    println!("cargo:rustc-check-cfg=cfg(armv6m)");
    if env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv6m")) {
        println!("cargo:rustc-cfg=armv6m");
    }

    // The rest is only for chips.
    let is = |name: &str, value: &str| env::var(name).as_deref() == Ok(value);
    if !is("CARGO_CFG_TARGET_OS", "none") || !is("CARGO_CFG_TARGET_ARCH", "arm") {
        return;
    }
    // The linker runs in the workspace's folder. A path relative to it stays valid when the
    // checkout is moved.
    println!("cargo:rustc-link-search=.");
    println!("cargo:rustc-link-search=firmware/src/board");
    println!("cargo:rerun-if-changed=src/board");

    // The chip's flash begins elsewhere than the emulated boards' flash, which begins at 0.
    for argument in [
        "--defsym=flash_origin=0x08000000",
        "--defsym=flash_length=0x00100000",
    ] {
        println!("cargo:rustc-link-arg-bin=stm32f405={argument}");
    }
    // The Pico's flash begins with the boot stage, which its boot ROM runs first.
    for argument in [
        "--defsym=flash_origin=0x10000100",
        "--defsym=flash_length=0x001fff00",
        // The picture of a colour panel takes up to 75 KB.
        "--defsym=ram_of_statics=0x00038000",
        "-Tpico/pico.x",
    ] {
        println!("cargo:rustc-link-arg-bin=pico={argument}");
    }
    // A Cortex-M33 or M55 starts in its secure state, with its memory at these addresses.
    if is("TARGET", "thumbv8m.main-none-eabihf") {
        for place in [
            "flash_origin=0x10000000",
            "ram_origin=0x30000000",
            "half_of_ram=0x00004000",
        ] {
            println!("cargo:rustc-link-arg-bin=cores=--defsym={place}");
        }
    }

    // The relocations show the tests which functions call or address another. They take no flash.
    for argument in ["-Tlink.x", "-Tdefmt.x", "--nmagic", "--emit-relocs"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}
