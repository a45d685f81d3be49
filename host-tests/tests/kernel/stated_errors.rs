//! The errors in the READMEs' tables are those of the command that a user would type, such as
//! `cargo simulate --angles 0.5,0.5 --method rk4-f32-direction --step 1/256`, against the exact
//! motion of the numbers typed.

use double_pendulum::{Error, Method, Motion, Parameters, State};
use exact::taylor::Reference;
use exact::trials::{apart, run};

/// Returns the largest error of an angle, rad, in `seconds` of the motion from rest at 0.5 rad, in
/// steps of 1/`rate` s, after every `every` steps.
fn largest(method: Method, rate: u32, seconds: u32, every: u32) -> Result<f64, Error> {
    let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
    let mut motion = run(
        method,
        &parameters,
        &State::at_rest(0.5, 0.5),
        1.0 / f64::from(rate),
    )?;
    let mut exact = Reference::new(&parameters, &Motion::at_rest(0.5, 0.5));
    let mut largest: f64 = 0.0;
    for step in (every..=rate * seconds).step_by(every as usize) {
        motion.advance(every)?;
        exact.advance_to(f64::from(step) / f64::from(rate));
        let now = motion.state();
        let then = exact.motion();
        largest = largest
            .max(apart(now.a1, then.a1))
            .max(apart(now.a2, then.a2));
    }
    Ok(largest)
}

/// The table of kernel/README.md has the largest error of all steps. The report in README.md and
/// host-tests/README.md compares four moments a second (`--every 1/4`). Each stated error is the
/// measured one, rounded.
#[test]
fn errors_in_the_readmes_are_those_of_the_command() -> Result<(), Error> {
    let of_kernel = [
        (Method::Rk4F32Direction, 60, 3.9e-6),
        (Method::Rk4F32Direction, 240, 7e-8),
        (Method::Rk4F32Direction, 256, 4.3e-8),
        (Method::Rk4F32DirectionPlain, 256, 2.7e-6),
        (Method::Rk4Fixed32, 256, 1.1e-8),
        (Method::Extrapolation12Fixed64, 7, 2.7e-10),
        (Method::Extrapolation12Fixed64, 13, 1.4e-13),
        (Method::Extrapolation12F64, 7, 2.7e-10),
        (Method::Extrapolation12F64, 16, 3.1e-14),
    ];
    let of_report = [
        (Method::TextbookF32, 256, 10, 3.3e-6),
        (Method::TextbookF32, 256, 100, 1.4e-5),
        (Method::Rk4F32Direction, 256, 10, 4.0e-8),
        (Method::Rk4F32Direction, 256, 100, 3.1e-7),
        (Method::Rk4Fixed32, 256, 10, 9.3e-9),
        (Method::Rk4Fixed32, 256, 100, 5.8e-8),
        (Method::Extrapolation12Fixed64, 16, 10, 1.1e-14),
        (Method::Extrapolation12Fixed64, 16, 100, 9.5e-14),
    ];
    let all = of_kernel
        .map(|(method, rate, stated)| (method, rate, 10, 1, stated))
        .into_iter()
        .chain(
            of_report
                .map(|(method, rate, seconds, stated)| (method, rate, seconds, rate / 4, stated)),
        );

    let mut wrong = Vec::new();
    for (method, rate, seconds, every, stated) in all {
        let found = largest(method, rate, seconds, every)?;
        println!("{method} 1/{rate} s, {seconds} s: {found:e}, stated {stated:e}");
        // Half a unit of the second digit.
        if (found / stated - 1.0).abs() > 0.05 {
            wrong.push((method, rate, seconds, found, stated));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
    Ok(())
}
