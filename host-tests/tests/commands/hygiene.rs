//! What the project is made of: every dependency and every `unsafe` has its reason, and there are no more of them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use host_tests::emulator::toolchain::workspace;

/// Lines of code with `unsafe`, by file, and what for.
const UNSAFE: [(&str, usize, &str); 29] = [
    ("firmware/src/bin/inject-stack-overflow.rs", 3, "the end of the statics, the last of them; a name to be found by"),
    ("firmware/src/board/cortex_m/calls.rs", 3, "words of the stack and of the code"),
    ("firmware/src/board/cortex_m/crash.rs", 7, "the fault handler: its stack, stacked registers, the control block"),
    ("firmware/src/board/cortex_m/fault_status.rs", 2, "the control block, one of its registers written"),
    ("firmware/src/board/cortex_m/stopwatch.rs", 1, "the tick's counter, borrowed"),
    ("firmware/src/board/cortex_m/guard.rs", 2, "the end of the statics, the memory protection unit"),
    ("firmware/src/board/cortex_m/identity.rs", 2, "the program in flash, between two names of the linker"),
    ("firmware/src/board/cortex_m/interrupt.rs", 3, "the interrupt handler, which sees what it interrupts"),
    ("firmware/src/board/lm3s6965evb/gpio.rs", 1, "a device of the data sheet"),
    ("firmware/src/board/lm3s6965evb/ssi.rs", 1, "a device of the data sheet"),
    ("firmware/src/board/lm3s6965evb/system.rs", 1, "a device of the data sheet"),
    ("firmware/src/board/lm3s6965evb/uart.rs", 3, "a device of the data sheet, an interrupt and its number"),
    ("firmware/src/board/lm3s6965evb/watchdog.rs", 1, "a device of the data sheet"),
    ("firmware/src/board/mps2_an386.rs", 4, "devices of the data sheet, an interrupt and its number"),
    ("firmware/src/board/pico/link.rs", 3, "the UART's registers, a byte for it, interrupts"),
    ("firmware/src/board/pico/mod.rs", 1, "the place of what the boot ROM runs first"),
    ("firmware/src/board/pico/watchdog.rs", 1, "the register of what stands still under a debugger"),
    ("firmware/src/board/register.rs", 3, "volatile access, the one place where it is done"),
    ("firmware/src/board/cortex_m/semihosting.rs", 1, "a call to the debugger"),
    ("firmware/src/board/cortex_m/long_product.rs", 2, "the name of a function of the compiler's library"),
    ("firmware/src/board/steps.rs", 2, "a function's copy, between names of the linker"),
    ("firmware/src/board/stm32f405/i2c.rs", 5, "register values read before and written back, its two interrupts"),
    ("firmware/src/board/log.rs", 11, "the log's state, used with interrupts off"),
    ("firmware/src/board/pico/i2c.rs", 6, "register values, its interrupt"),
    ("firmware/src/board/stm32f405/mod.rs", 1, "the chip's identity and unique number"),
    ("firmware/src/board/stm32f405/uart.rs", 2, "a register shared by both directions, an interrupt"),
    ("firmware/src/board/stm32f405/watchdog.rs", 1, "the register of what stands still under a debugger"),
    ("firmware/src/board/cortex_m/retained.rs", 2, "memory that start-up leaves alone"),
    ("firmware/src/board/cortex_m/watchdog.rs", 2, "an interrupt and its number"),
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap_or_else(|error| panic!("{error}")).path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn unsafe_code_is_where_it_must_be() {
    let mut files = Vec::new();
    for folder in ["kernel/src", "firmware/src", "host-tests/src", "host-tests/vectors/src"] {
        sources(&workspace().join(folder), &mut files);
    }
    let counted = files.iter().filter_map(|file| {
        let is_unsafe = |line: &&str| {
            let code = line.split("//").next().unwrap_or_default();
            code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")
        };
        let lines = read(file).lines().filter(is_unsafe).count();
        let name = file.strip_prefix(workspace()).ok()?.to_str()?.to_owned();
        (lines > 0).then_some((name, lines))
    });
    let counted: BTreeSet<_> = counted.collect();
    let expected: BTreeSet<_> = UNSAFE.iter().map(|(name, lines, _)| (String::from(*name), *lines)).collect();
    assert_eq!(counted, expected);
}

/// The names in a manifest's tables of dependencies, this project's own crates apart.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let mut within = false;
    let mut names = BTreeSet::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            within = line.ends_with("dependencies]");
        } else if within && let Some((name, _)) = line.split_once(['.', ' ', '=']) {
            names.insert(name.to_owned());
        }
    }
    for own in ["double-pendulum-kernel", "firmware", "vectors", "#", ""] {
        names.remove(own);
    }
    names
}

#[test]
fn every_dependency_has_its_reason() {
    let manifests =
        ["", "kernel/", "firmware/", "host-tests/", "host-tests/vectors/"].map(|folder| format!("{folder}Cargo.toml"));
    let named: BTreeSet<_> =
        manifests.iter().flat_map(|manifest| dependencies(&read(&workspace().join(manifest)))).collect();
    let table = read(&workspace().join(".ci/dependencies.md"));
    let rows = table.lines().filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned()));
    assert_eq!(named, rows.collect());
}
