//! A crash of the firmware ends the run with exit code 1 and a report that a person can read.

mod support;

use host_tests::board::{BOARDS, Board};
use host_tests::count::Image;
use host_tests::qemu::{Machine, QemuError};
use support::{settings, toolchain};

/// What the binary says before its end, which must be a failure; and the program itself.
fn crash(board: &Board, binary: &str) -> Result<(String, Image), QemuError> {
    let toolchain = toolchain();
    let elf = toolchain.build(binary, board.target).unwrap_or_else(|error| panic!("{error}"));
    let (status, lines) = Machine::start(&settings(&toolchain, board, &elf))?.wait()?;
    let report = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
    assert_eq!(status.code(), Some(1), "{}: {report}", board.name);
    let image = Image::read(&elf).unwrap_or_else(|error| panic!("{error}"));
    Ok((report, image))
}

#[test]
fn a_panic_tells_where_and_why() -> Result<(), QemuError> {
    for board in &BOARDS {
        let (report, _) = crash(board, "inject-panic")?;
        for part in ["boot: about to panic", "PANIC", "inject-panic.rs:", "injected with the number 42"] {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
    }
    Ok(())
}

#[test]
fn a_hard_fault_tells_where_and_why() -> Result<(), QemuError> {
    for board in &BOARDS {
        let (report, image) = crash(board, "inject-hardfault")?;
        for part in ["HARDFAULT: undefined instruction", "cfsr 0x00010000", "lr 0x"] {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
        let pc = report.split_once("pc 0x").and_then(|(_, rest)| u32::from_str_radix(rest.get(..8)?, 16).ok());
        let pc = pc.unwrap_or_else(|| panic!("no pc in\n{report}"));
        let function = image.function_at(pc).unwrap_or_else(|| panic!("no function at the pc in\n{report}"));
        let place = function.name.as_str();
        assert!(place.contains("main") || place.contains("udf"), "{}: pc in {place}\n{report}", board.name);
    }
    Ok(())
}
