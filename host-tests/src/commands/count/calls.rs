//! Programs whose calls of a function are counted: the steps of a request, and any function.

use std::collections::BTreeSet;
use std::time::Duration;

use anyhow::{Result, bail, ensure};
use cycles::{Calls, Cost, Function, Registers};
use firmware::job::Request;

use super::trace::{Ended, LIMIT};
use super::{COUNTED, Target};
use crate::console::progress::Progress;
use crate::emulator::process::timed_out;

/// Runs `request` on `target`, all calls of the counted function together.
pub fn counted<'a>(target: &'a Target, request: &Request) -> Result<Calls<'a>> {
    let entries = target.image().functions_named(COUNTED).map(|function| function.address).collect();
    let mut calls = Calls::of(target.image(), target.core(), entries);
    match target.trace(&request.to_string(), LIMIT, &mut |registers| calls.see(registers))? {
        Ended { status: Some(status), .. } if status.success() => {}
        Ended { status: None, .. } => bail!(timed_out(&target.elf.display().to_string(), LIMIT)),
        Ended { output, .. } => bail!("{request}: {}", output.trim()),
    }
    ensure!(!calls.ended.is_empty(), "{COUNTED} was never called");
    Ok(calls)
}

/// Counts the calls of `function` until the program on `target` ends or the time is up: the function, what each call that returned
/// cost, one at least unless the program says that it failed, and how it ended.
pub fn calls_of<'a>(target: &'a Target, function: &str, limit: Duration) -> Result<(&'a Function, Vec<Cost>, Ended)> {
    let (image, core) = (target.image(), target.core());
    let function = image.function(function)?;
    let (vectors, board) = (target.board.flash(), target.board.name);
    // It would never run.
    ensure!(
        image.holds(vectors),
        "never called: the program has nothing at {vectors:#x}, where {board} reads its vectors; see --on"
    );
    let mut calls = Calls::of(image, core, BTreeSet::from([function.address]));
    let progress = Progress::start(&format!("counts the calls of {}", function.name));
    let (mut instructions, mut before, mut unknown) = (0_u64, Registers::default(), None);
    let ended = target.trace("", limit, &mut |registers| {
        instructions += 1;
        if instructions % TELL == 0 {
            progress.alive(Some(&format!("{} calls, {instructions} instructions", calls.ended.len())));
        }
        // An exception right after an instruction that the processor does not have is for the lack of it.
        if is_exception(&registers) && !is_exception(&before) {
            let instruction = image.instruction_at(before.pc()).ok();
            unknown = unknown.or(instruction.filter(|one| one.is_missing_on(core)).map(|one| (before.pc(), one)));
        }
        before = registers;
        calls.see(registers)
    })?;
    let name = &function.name;
    let failed = ended.status.is_some_and(|status| !status.success());
    if calls.ended.is_empty() && !failed {
        ensure!(!calls.is_running(), "{name} was called and never returned");
        let Some((address, instruction)) = unknown else { bail!("{name} was never called") };
        let (instruction, cpu) = (instruction.row.name, target.board.cpu);
        bail!("{name} was never called: {instruction} at {address:#x} is no instruction of a {cpu}; see --on");
    }
    Ok((function, calls.ended, ended))
}

/// Instructions between two words about them.
const TELL: u64 = 1 << 18;

/// Whether the processor has just entered an exception: the link register then holds no address.
fn is_exception(registers: &Registers) -> bool {
    (0xffff_ffe0..u32::MAX).contains(&registers.lr())
}
