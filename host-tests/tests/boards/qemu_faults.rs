//! What a board says of a panic, and that its stack has no guard. The other crashes are injected into the running application (test
//! `qemu_restart`).

use crate::support::{on, settings, toolchain};
use cycles::Image;
use firmware::protocol::Frame;
use host_tests::emulator::boards::BOARDS;
use host_tests::emulator::qemu::Machine;

/// The name of the function at the address that the report gives after `what`.
fn function_after(what: &str, report: &str, image: &Image) -> String {
    let digits = report.split_once(what).and_then(|(_, rest)| rest.trim_start().strip_prefix("0x"));
    let address = digits.and_then(|digits| u32::from_str_radix(digits.get(..8)?, 16).ok());
    let address = address.unwrap_or_else(|| panic!("no address after {what:?} in\n{report}"));
    image.function_at(address).map_or(String::new(), |function| function.name.clone())
}

#[test]
fn a_panic_tells_where_and_why_and_ends_the_run_as_a_failure() -> anyhow::Result<()> {
    let toolchain = toolchain();
    for board in &BOARDS {
        let elf = toolchain.build("inject-panic", board.target)?;
        let (status, lines) = Machine::start(&settings(&toolchain, board, &elf))?.wait()?;
        let report = lines.iter().map(|line| format!("{line}\n")).collect::<String>();
        assert_eq!(status.code(), Some(1), "{}: {report}", board.name);
        for part in
            ["boot: about to panic", "PANIC", "inject-panic.rs:", "injected with the number 42", "cfsr 0x00000000"]
        {
            assert!(report.contains(part), "{}: no {part:?} in\n{report}", board.name);
        }
        let image = Image::read(&elf)?;
        for (what, name) in [("pc", "panic_fmt"), ("lr", "main")] {
            let caller = function_after(what, &report, &image);
            assert!(caller.contains(name), "{}: {what} in {caller}\n{report}", board.name);
        }
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
