//! A crash of the firmware ends the run with exit code 1 and a report that a person can read.

use crate::support::{guarded, on, settings, toolchain};
use cycles::Image;
use firmware::protocol::Frame;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Lockstep, Machine};
use object::{Object, ObjectSymbol};

/// What the binary says before its end, which must be a failure; and the program itself.
fn crash(board: &Board, binary: &str) -> anyhow::Result<(String, Image)> {
    let toolchain = toolchain();
    let elf = toolchain.build(binary, board.target).unwrap_or_else(|error| panic!("{error}"));
    let (status, lines) = Machine::start(&settings(&toolchain, board, &elf))?.wait()?;
    let report = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
    assert_eq!(status.code(), Some(1), "{}: {report}", board.name);
    let image = Image::read(&elf).unwrap_or_else(|error| panic!("{error}"));
    Ok((report, image))
}

/// The name of the function at the address that the report gives after `what`.
fn function_after(what: &str, report: &str, image: &Image) -> String {
    let digits = report.split_once(what).and_then(|(_, rest)| rest.trim_start().strip_prefix("0x"));
    let address = digits.and_then(|digits| u32::from_str_radix(digits.get(..8)?, 16).ok());
    let address = address.unwrap_or_else(|| panic!("no address after {what:?} in\n{report}"));
    image.function_at(address).map_or(String::new(), |function| function.name.clone())
}

#[test]
fn a_panic_tells_where_and_why() -> anyhow::Result<()> {
    for board in &BOARDS {
        let (report, image) = crash(board, "inject-panic")?;
        for part in
            ["boot: about to panic", "PANIC", "inject-panic.rs:", "injected with the number 42", "cfsr 0x00000000"]
        {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
        let (handlers_caller, its_caller) =
            (function_after("pc", &report, &image), function_after("lr", &report, &image));
        assert!(handlers_caller.contains("panic_fmt"), "{}: {handlers_caller}\n{report}", board.name);
        assert!(its_caller.contains("main"), "{}: {its_caller}\n{report}", board.name);
    }
    Ok(())
}

#[test]
fn a_hard_fault_tells_where_and_why() -> anyhow::Result<()> {
    for board in &BOARDS {
        let (report, image) = crash(board, "inject-hardfault")?;
        let parts = if board.is_guarded() {
            ["HARDFAULT: undefined instruction", "cfsr 0x00010000", "lr 0x"]
        } else {
            ["HARDFAULT: unknown cause (a Cortex-M0+ tells none)", "xpsr 0x", "lr 0x"]
        };
        for part in parts {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
        let place = function_after("pc", &report, &image);
        assert!(place.contains("main") || place.contains("udf"), "{}: pc in {place}\n{report}", board.name);
    }
    Ok(())
}

#[test]
fn a_board_whose_stack_has_no_guard_says_so() -> anyhow::Result<()> {
    for board in BOARDS.iter().filter(|board| !board.is_guarded()) {
        let mut machine = on(board, Machine::start)?;
        machine.wait_for::<Frame>()?;
        let log: Vec<_> = machine.log.arrived().map(|line| line.text).collect();
        assert!(log.iter().any(|line| line == "no memory protection unit: the stack has no guard"), "{log:?}");
    }
    Ok(())
}

#[test]
fn a_stack_overflow_is_named_as_such() -> anyhow::Result<()> {
    for board in guarded() {
        let (report, image) = crash(board, "inject-stack-overflow")?;
        for part in ["HARDFAULT: stack overflow", "pc and lr are lost", "cfsr 0x000000", "mmfar 0x20007f"] {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
        let caller = function_after("stack is at", &report, &image);
        assert_eq!(caller, "descend", "{}: {report}", board.name);
    }
    Ok(())
}

#[test]
fn a_stack_overflow_changes_nothing_below_the_stack() -> anyhow::Result<()> {
    let toolchain = toolchain();
    for board in guarded() {
        let elf = toolchain.build("inject-stack-overflow", board.target)?;
        let bytes = std::fs::read(&elf)?;
        let file = object::File::parse(&*bytes)?;
        let address = |name: &str| {
            let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
            symbol.map_or_else(|| panic!("no {name}"), |symbol| symbol.address() as u32 & !1)
        };
        let statics = address("_ram_start")..address("__euninit");
        let mut probe = Lockstep::start(&settings(&toolchain, board, &elf))?;
        probe.run_to(address("descend"))?;
        let before = probe.read(statics.clone())?;
        probe.run_to(address("HardFault"))?;
        assert!(before.len() > 1024, "{}: there is something to damage", board.name);
        assert!(probe.read(statics)? == before, "{}: the statics are damaged", board.name);
    }
    Ok(())
}
