//! Pictures between steps: as close to the exact motion as their documentation says.

use double_pendulum::form::Interpolation;
use double_pendulum::{Error, Pendulum, Real};
use host_tests::oracle::tolerances;
use host_tests::oracle::trials::Trial;

/// The largest error of a sine or cosine at the quarters of the steps of 5 s, `steps` a second.
fn error<R: Real>(angle: f64, steps: f64) -> Result<f64, Error> {
    const QUARTERS: usize = 4;
    let trial = Trial::at_rest(1.0, angle, angle, 16.0 / (steps * QUARTERS as f64));
    let pendulum = Pendulum::new(trial.parameters.cast::<R>())?;
    let mut worst = 0.0_f64;
    let mut from = trial;
    for _ in 0..5 * steps as usize / QUARTERS {
        let exact = from.exact::<f64>()?; // 16 quarters of a step
        let states: Vec<_> = std::iter::once(from.start).chain(exact).collect();
        for quarters in states.windows(QUARTERS + 1).step_by(QUARTERS) {
            let ends = [0, QUARTERS].map(|i| pendulum.node(&quarters[i].cast()));
            let step = Interpolation::new([&ends[0], &ends[1]], R::from_f64(1.0 / steps));
            for (i, exact) in quarters.iter().enumerate() {
                let drawn = step.directions(R::from_f64(i as f64 / QUARTERS as f64));
                for ([sin, cos], exact) in drawn.into_iter().zip(exact.angles()) {
                    worst = worst.max((sin.to_f64() - exact.sin()).abs()).max((cos.to_f64() - exact.cos()).abs());
                }
            }
        }
        from.start = states[16];
    }
    Ok(worst)
}

#[test]
fn pictures_between_steps_keep_their_promise() -> Result<(), Error> {
    let [regular, chaotic] = tolerances::BETWEEN_STEPS;
    let [in_double, in_single] = [error::<f64>(0.5, 15.0)?, error::<f32>(0.5, 15.0)?];
    println!("{in_double:.1e} {in_single:.1e}");
    assert!(in_double <= regular && in_single <= regular + tolerances::BETWEEN_STEPS_SINGLE);
    let error = error::<f64>(2.0, 15.0)?;
    assert!(error <= chaotic, "{error:e}");
    Ok(())
}

#[test]
fn their_error_falls_with_the_sixth_power_of_the_step() -> Result<(), Error> {
    let [coarse, fine] = [error::<f64>(0.5, 15.0)?, error::<f64>(0.5, 30.0)?];
    let order = (coarse / fine).log2();
    assert!(tolerances::BETWEEN_STEPS_ORDER.contains(&order), "{order} from {coarse:e} and {fine:e}");
    Ok(())
}
