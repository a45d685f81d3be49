//! An example of an added method (`rk4-f32-lagrange`, in these tests only): its type is in
//! `methods/lagrange.rs`, and scenes are drawn by it.

use double_pendulum::parts::Canonical;
use double_pendulum::plan::{Budget, Costs, Limit, PlannedRun, Problem, Search, Stepping};
use double_pendulum::{Error, Method, Motion, Parameters};

use super::forms;
use crate::methods::lagrange::Lagrange;

/// The added method.
const ADDED: Method = Method::Rk4F32Lagrange;

/// The added method is in the table with its name and order 4. The average rates of 8 steps by its
/// equations, in `f64`, are those of Hamilton's equations within 3e-8 of the velocities and forces
/// that the energy allows ([`forms::RK4`]).
#[test]
fn added_method_obeys_hamiltons_equations() {
    assert_eq!(Method::from_name("rk4-f32-lagrange"), Some(ADDED));
    assert!(Method::ALL.contains(&ADDED) && ADDED.order() == 4);
    forms::is_that_of_hamiltons_equations::<Canonical<f64, Lagrange<f64>>>(forms::RK4);
}

/// A scene of 4 s is drawn by the added method. The search must predict that all its frames are
/// accurate to half a pixel of a display 64 pixels high, at the method's own price. The angles of
/// each frame must be those of 64 bits to 1e-3 rad.
#[test]
fn added_method_draws_a_scene() -> Result<(), Error> {
    let scene = Problem {
        pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
        start: Motion::at_rest(0.5, 0.5),
        tolerance: 1.0 / 32.0,
        duration: 4.0,
        rate: 60,
    };
    let budget = Budget {
        frame: 1e5,
        planning: 1e9,
    };

    // The search evaluates it.
    let stepping = Stepping {
        method: ADDED,
        steps: 4,
    };
    let mut search =
        Search::of(stepping, &scene, &Costs::CORTEX_M3, &budget).expect("a drawn method");
    let plan = loop {
        if let Some(plan) = search.advance(f32::INFINITY).expect("a good scene") {
            break plan;
        }
    };
    assert_eq!(plan.stepping(), stepping);
    assert_eq!((plan.limit, plan.horizon), (Limit::End, scene.duration));
    assert_eq!(
        Some(plan.cost),
        Costs::CORTEX_M3.step(ADDED).map(|step| 4.0 * step)
    );

    // Its frames are accurate.
    let mut shown = plan.run(&scene)?;
    let mut exact = PlannedRun::new(
        &scene,
        Stepping {
            method: Method::Extrapolation10Fixed64,
            steps: 1,
        },
    )?;
    for _ in 0..scene.frames() {
        shown.advance(1)?;
        exact.advance(1)?;
        let [shown, exact] = [shown, exact].map(|run| run.rounded_state().angles());
        for (angle, other) in shown.into_iter().zip(exact) {
            assert!((angle - other).abs() < 1e-3, "{angle} {other}");
        }
    }
    assert_eq!(shown.time(), scene.duration);
    Ok(())
}

/// Each name of the table must lead back to its method by `Method::from_name`.
#[test]
fn method_names_are_unique() {
    Method::ALL
        .iter()
        .for_each(|method| assert_eq!(Method::from_name(method.name()), Some(*method)));
}
