//! `cargo count --elf`: any function of any program, and one line for what cannot be counted.

use std::path::{Path, PathBuf};
use std::process::Command;

use host_tests::commands::count::ERROR_BAR;
use host_tests::emulator::boards::BOARDS;
use host_tests::emulator::process::{self, Output};

/// Says why it refuses an empty request and ends itself, on a Cortex-M3.
fn measure() -> PathBuf {
    crate::support::toolchain().build("measure", BOARDS[0].target).unwrap_or_else(|error| panic!("{error}"))
}

fn count(elf: &Path, function: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_count"));
    command.args(["--on", BOARDS[0].name, "--function", function, "--elf"]).arg(elf);
    process::run(&mut command, crate::support::LIMIT).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_function_is_counted_by_either_of_its_names() {
    let elf = measure();
    let output = count(&elf, "core::fmt::write");
    assert!(output.status.success(), "{output:?}");
    let lines: Vec<_> = output.stdout.lines().collect();
    let [head, limits, _, instructions, cycles] = lines[..] else { panic!("{output:?}") };
    assert!(head.starts_with("core::fmt::write on lm3s6965evb, "), "{head}");
    assert_eq!(limits, ERROR_BAR);
    let mean = |line: &str| line.split_ascii_whitespace().nth(1).and_then(|mean| mean.parse::<f64>().ok());
    assert!(mean(instructions) > Some(10.0) && mean(cycles) > mean(instructions), "{output:?}");

    let bytes = std::fs::read(&elf).unwrap_or_else(|error| panic!("{error}"));
    let file = object::File::parse(&*bytes).unwrap_or_else(|error| panic!("{error}"));
    use object::{Object, ObjectSymbol};
    let names = file.symbols().filter_map(|symbol| symbol.name().ok().map(str::to_owned));
    let mangled = names.into_iter().find(|name| format!("{:#}", rustc_demangle::demangle(name)) == "core::fmt::write");
    assert_eq!(count(&elf, &mangled.unwrap_or_default()).stdout, output.stdout);
}

#[test]
fn what_cannot_be_counted_is_said_in_a_line() {
    let elf = measure();
    let host = Path::new(env!("CARGO_BIN_EXE_count"));
    for (elf, function, reason) in [
        (Path::new("/nowhere/to/be/found.elf"), "main", "No such file"),
        (Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")), "main", "Unknown file magic"),
        (host, "main", "no program for ARM but for"),
        (&elf, "nothing_of_this_name", "no function nothing_of_this_name"),
        (&elf, "counted_steps", "counted_steps may be any of "),
        (&elf, "__aeabi_ddiv", "__aeabi_ddiv was never called"),
        (&elf, "main", "main was called and never returned"),
    ] {
        let output = count(elf, function);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert_eq!((output.stdout.as_str(), output.stderr.lines().count()), ("", 1), "{output:?}");
        assert!(output.stderr.contains(reason), "{output:?}");
    }
}
