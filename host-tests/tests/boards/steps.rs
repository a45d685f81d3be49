//! The steps of every method. Real boards store them twice, in flash and in memory, so they must
//! run at any address.

use std::collections::BTreeSet;

use crate::support::application;
use crate::support::code::Code;
use emulator::boards::{PICO, STM32F405};
use object::{Object, ObjectSection};

/// The functions that are measured and that take most of the scenes' time, each by a part and the
/// end of its name.
const STEPS: [(&str, &str); 5] = [
    ("OnBoards as firmware::job::run::Run>", "advance"),
    ("methods::any::DrawnMotion", "advance"),
    ("double_pendulum::methods::FormOperations>", "advance"),
    (
        "Fixed32 as double_pendulum::methods::FormOperations>",
        "advance",
    ),
    ("rows::Rows", "end_in"),
];

/// The functions of [`STEPS`] are all in the section that is copied to memory, and no branch in it
/// leads outside, not even by a thunk of the linker.
#[test]
fn no_branch_leads_out_of_the_steps() -> anyhow::Result<()> {
    const RAM: u32 = 0x2000_0000;

    for (board, runs_in_ram) in [(&STM32F405, false), (&PICO, true)] {
        let elf = application(board);
        let bytes = std::fs::read(&elf)?;
        let section = object::File::parse(&*bytes)?;
        let section = section.section_by_name(".steps").expect("the steps");
        let steps = section.address() as u32..(section.address() + section.size()) as u32;
        assert_eq!(
            steps.start >= RAM,
            runs_in_ram,
            "{}: {steps:x?}",
            board.name
        );
        let code = Code::read(&elf)?;
        // All functions of the steps are in the section.
        for (name, end) in STEPS {
            let mut found = code
                .functions_named(|step| step.contains(name) && step.ends_with(end))
                .peekable();
            assert!(found.peek().is_some(), "{}: no {name}", board.name);
            assert!(
                found.all(|function| steps.contains(&function)),
                "{}: {name} is in another section",
                board.name
            );
        }

        // A branch that leaves the section would have the wrong target after a copy.
        let name = |address| code.function_at(address).map_or("?", |(_, name)| name);
        let out: Vec<_> = code
            .leads_out_of(&steps)
            .map(|(at, to)| (name(at), name(to)))
            .collect();
        assert!(out.is_empty(), "{}: {out:#?}", board.name);

        // The linker inserts these functions for targets that are too far for a branch.
        let far: Vec<_> = code
            .functions_named(|name| name.contains("Thunk"))
            .filter(|at| steps.contains(at))
            .map(name)
            .collect();
        assert!(far.is_empty(), "{}: {far:#?}", board.name);
    }

    Ok(())
}

/// Returns the functions that steps of the form `form` reach in the Pico's application.
fn reached(code: &Code, form: &str) -> BTreeSet<String> {
    let is_step = |name: &str| {
        name.contains(form) && name.contains("FormOperations>") && name.ends_with("advance")
    };
    let mut found: Vec<u32> = code.functions_named(is_step).collect();
    // The list grows while it is searched.
    let mut seen = 0;
    while let Some(&function) = found.get(seen) {
        seen += 1;
        let new: Vec<u32> = code
            .named_by(function)
            .filter(|to| !found.contains(to))
            .collect();
        found.extend(new);
    }
    found
        .into_iter()
        .filter_map(|function| Some(code.function_at(function)?.1.to_owned()))
        .collect()
}

/// A step in 32-bit fixed point on a Cortex-M0+ calls no function of software floating point,
/// directly or indirectly, while a step in `f32` does. It is the claim of the kernel's example
/// `fixed_point`.
#[test]
fn steps_in_fixed_point_reach_no_soft_float() -> anyhow::Result<()> {
    let code = Code::read(&application(&PICO))?;
    let is_soft = |name: &String| name.starts_with("__aeabi_f") || name.starts_with("__aeabi_d");
    let [fixed, float] = ["Fixed32 as", "Rk4Direction<"].map(|form| reached(&code, form));
    // The search finds soft floats where they are used.
    assert!(float.iter().any(is_soft), "{float:#?}");
    assert!(
        !fixed.is_empty() && !fixed.iter().any(is_soft),
        "{fixed:#?}"
    );
    Ok(())
}
