//! What the chart of cost against error promises: fixed point fills what is between pictures and the last digits.

use double_pendulum::Method;
use host_tests::commands::report::accuracy::{error, exact, rates};
use host_tests::commands::report::scene::SCENES;

/// Steps of 1/256 s are as fine as fixed point is compared here.
const FINEST: u32 = 8;
/// The largest factor from one error to the next that is called no hole.
const NO_HOLE: f64 = 10.0;

#[test]
fn there_is_no_hole_between_1e_8_and_1e_12() {
    let scene = &SCENES[0];
    let exact = exact(scene);
    let mut errors = Vec::new();
    for method in Method::ALL.iter().filter(|method| method.is_fixed_point()) {
        for rate in rates(*method, FINEST) {
            if let Some(error) = error(*method, scene, rate, &exact) {
                println!("{method} {rate} {:.1e}", error.angle);
                errors.push(error.angle);
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let between = |pair: &[f64]| pair[1] > 1e-12 && pair[0] < 1e-8;
    for pair in errors.windows(2).filter(|pair| between(pair)) {
        assert!(pair[1] / pair[0] <= NO_HOLE, "nothing between {:e} and {:e} rad", pair[0], pair[1]);
    }
}
