//! The functions that the steps of a method call on the Pico.

use std::collections::BTreeSet;

use crate::support::application;
use crate::support::code::Code;
use boards::PICO;

/// Returns the functions that steps of the form `form` reach in the Pico's application.
fn reached(code: &Code, form: &str) -> BTreeSet<String> {
    let is_step = |name: &str| {
        name.contains(form) && name.contains("methods::Advance>") && name.ends_with("advance")
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
