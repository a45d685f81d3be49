//! A plan and its motion: the cheapest method that is accurate to half a pixel, and its horizon.

use std::error::Error;

use double_pendulum::plan::{Budget, Costs, Plan, Problem};
use double_pendulum::{Motion, Parameters};

fn main() -> Result<(), Box<dyn Error>> {
    let pendulum = Parameters::equal_rods(1.0, 1.0, 9.81);
    let start = Motion::at_rest(2.0, 2.0);
    let scene = Problem {
        pendulum,
        start,
        tolerance: 0.5 / 16.0,
        duration: 30.0,
        rate: 60,
    };
    // A Cortex-M4F at 168 MHz: the budgets are cycles, as the costs are.
    let costs = Costs::CORTEX_M4F;
    let budget = Budget {
        frame: 400e3,
        planning: 1e9,
    };

    let plan = Plan::search(&scene, &costs, &budget)?;
    println!(
        "{}, {} steps per frame: accurate for {:.1} s",
        plan.method, plan.steps, plan.horizon
    );

    let mut run = plan.run(&scene)?;
    while run.time() < plan.horizon {
        run.advance(1)?;
        let [[_sin1, _cos1], [_sin2, _cos2]] = run.directions(); // draw it here
    }
    Ok(())
}
