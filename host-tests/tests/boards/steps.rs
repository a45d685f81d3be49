//! The steps of every method, which real boards have twice, in flash and in memory: they run wherever they are copied.

use std::collections::BTreeSet;

use crate::support::application;
use crate::support::code::Code;
use host_tests::emulator::boards::{PICO, STM32F405};
use object::{Object, ObjectSection};

/// What is measured, and what the scenes spend most of their time in, by a part and the end of its name.
const STEPS: [(&str, &str); 4] = [
    ("OnBoards as firmware::job::run::Run>", "advance"),
    ("double_pendulum::methods::Form>", "advance"),
    ("Fixed32 as double_pendulum::methods::Form>", "advance"),
    ("rows::Rows", "end_in"),
];

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
        for (name, end) in STEPS {
            let mut found = code
                .functions_named(|step| step.contains(name) && step.ends_with(end))
                .peekable();
            assert!(found.peek().is_some(), "{}: no {name}", board.name);
            assert!(
                found.all(|function| steps.contains(&function)),
                "{}: {name} stands elsewhere",
                board.name
            );
        }
        let name = |address| code.function_at(address).map_or("?", |(_, name)| name);
        let out: Vec<_> = code
            .leads_out_of(&steps)
            .map(|(at, to)| (name(at), name(to)))
            .collect();
        assert!(out.is_empty(), "{}: {out:#?}", board.name);
        // By which the linker reaches what is too far for a branch.
        let far: Vec<_> = code
            .functions_named(|name| name.contains("Thunk"))
            .filter(|at| steps.contains(at))
            .map(name)
            .collect();
        assert!(far.is_empty(), "{}: {far:#?}", board.name);
    }
    Ok(())
}

/// The functions that steps of the form `form` reach in the Pico's application.
fn reached(code: &Code, form: &str) -> BTreeSet<String> {
    let is_step =
        |name: &str| name.contains(form) && name.contains("Form>") && name.ends_with("advance");
    let mut found: Vec<u32> = code.functions_named(is_step).collect();
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

/// As the kernel's example `fixed_point` says: on a Cortex-M0+ a step in 32 bits is made of integers, one of `f32` is not.
#[test]
fn steps_in_fixed_point_reach_no_soft_float() -> anyhow::Result<()> {
    let code = Code::read(&application(&PICO))?;
    let is_soft = |name: &String| name.starts_with("__aeabi_f") || name.starts_with("__aeabi_d");
    let [fixed, float] = ["Fixed32 as", "Rk4Direction<"].map(|form| reached(&code, form));
    assert!(float.iter().any(is_soft), "{float:#?}");
    assert!(
        !fixed.is_empty() && !fixed.iter().any(is_soft),
        "{fixed:#?}"
    );
    Ok(())
}
