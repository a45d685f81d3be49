//! A simulated day: no method with steps in 32 bits loses energy or time by rounding.

use double_pendulum::parts::DirectionF64;
use double_pendulum::plan::Stepping;
use double_pendulum::{Equations, Error, Method, Numbers, Pendulum, State};
use exact::advance;
use exact::trials::{self, Trial};
use firmware::config::{STM32F405, TICK_RATE};
use firmware::graphics::Format;
use firmware::motion::{Resources, Simulation};
use firmware::scenes::{Report, SceneName};

/// The difference of the energy by a method in 32 bits from that of `f64` in the same steps, at any
/// time of a simulated day, relative to the energy above rest: the goal (measured at five mass
/// ratios and three steps: compensated `f32` up to 2.0e-4, plain 3.1e-4, fixed point 2.6e-6).
const DAY_ENERGY: f64 = 1e-3;

/// The difference of the energy of a run's directions and momenta from that of its state, in 32
/// bits, relative to the energy above rest: the goal. The state is up to half a step away, and the
/// directions and momenta are rounded to `f32`.
const DAY_READING: f64 = 1e-4;

const DAY: f64 = 86_400.0;
const SAMPLES: u32 = 480;
const SAMPLES_OF_A_SCENE: u32 = 240;

fn narrow() -> impl Iterator<Item = Method> {
    let is_narrow = |method: &Method| method.is_single() || method.numbers() == Numbers::Fixed32;
    Method::ALL
        .iter()
        .copied()
        .filter(|method| method.equations() == Equations::Directions)
        .filter(is_narrow)
}

/// The second result is the largest difference between two energies, divided by the energy above
/// rest: the energy of the directions and momenta, and the energy of the state.
fn followed(trial: &Trial, method: Method, dt: f64) -> Result<(Vec<State<f64>>, f64), Error> {
    let Trial {
        parameters, start, ..
    } = trial.held_by(method);
    let pendulum = Pendulum::new(&parameters)?;
    let mut run = trials::run(method, &parameters, &start, dt)?;
    let steps = (trial.seconds / dt / f64::from(SAMPLES)).round() as u32;
    let mut apart: f64 = 0.0;
    let states = (0..SAMPLES).map(|_| {
        run.advance(steps)?;
        apart = apart.max((pendulum.energy(&run.state()) - run.energy()).abs());
        Ok(run.state())
    });

    Ok((
        states.collect::<Result<_, Error>>()?,
        apart / pendulum.energy_above_rest(&start),
    ))
}

/// Compares the energy by each method in 32 bits with that of `f64` in the same steps, and with the
/// energy of the state.
fn a_day(mass_ratio: f64, dt: f64) -> Result<(), Error> {
    let trial = Trial::at_rest(mass_ratio, 0.5, 0.5, DAY);
    let pendulum = Pendulum::new(&trial.parameters)?;
    let energy = |state: &State<f64>| {
        pendulum.energy_above_rest(state) / pendulum.energy_above_rest(&trial.start)
    };
    let exact = trial.states_in_f64(dt, SAMPLES)?;
    for method in narrow() {
        let (states, apart) = match followed(&trial, method, dt) {
            // With a light bob 1 fixed point refuses steps of 1/100 s as too long.
            Err(Error::TooLarge { .. })
                if method.is_fixed_point() && mass_ratio == 20.0 && dt == 0.01 =>
            {
                continue;
            }
            followed => followed?,
        };

        let errors = states
            .iter()
            .zip(&exact)
            .map(|(state, exact)| (energy(state) - energy(exact)).abs());
        let error = errors.fold(0.0, f64::max);
        let about = format!(
            "m2/m1 {mass_ratio}, 1/{:.0} s, {method}: {error:.1e}, {apart:.1e}",
            1.0 / dt
        );
        println!("{about}");
        assert!(error <= DAY_ENERGY && apart <= DAY_READING, "{about}");
    }

    Ok(())
}

#[test]
fn energy_is_kept_for_a_day() -> Result<(), Error> {
    a_day(0.2, 1.0 / 100.0)?;
    a_day(5.0, 1.0 / 100.0)
}

/// Fixed point may refuse the mass ratio 20 in steps of 1/100 s as too long.
#[test]
#[ignore = "a minute: a day of four forms at fifteen mass ratios and steps"]
fn energy_is_kept_for_a_day_at_any_mass_ratio_and_step() -> Result<(), Error> {
    for mass_ratio in [0.05, 0.2, 1.0, 5.0, 20.0] {
        for steps in [100.0, 240.0, 256.0] {
            a_day(mass_ratio, 1.0 / steps)?;
        }
    }

    Ok(())
}

/// The amplitude is so small that the period does not depend on the energy.
#[test]
fn time_is_accurate_to_one_step_after_a_day() -> Result<(), Error> {
    for mass_ratio in [0.2, 5.0] {
        let dt = 1.0 / 100.0;
        let pendulum = Pendulum::new(&Trial::at_rest(mass_ratio, 0.0, 0.0, DAY).parameters)?;
        let slow = pendulum.modes()?.slow;
        let trial = Trial::at_rest(mass_ratio, 0.01, 0.01 * slow.shape, DAY);
        let exact = trial.states_in_f64(dt, SAMPLES)?;
        let scale = trial.parameters.m2 * slow.frequency;
        let phase =
            |state: &State<f64>| (state.p2 / scale / (1.0 + 1.0 / slow.shape)).atan2(state.a2);
        for method in narrow() {
            let (states, _) = followed(&trial, method, dt)?;
            for (state, exact) in states.iter().zip(&exact) {
                let behind = trials::apart(phase(state), phase(exact)) / slow.frequency;
                assert!(behind <= dt, "{method}: {behind} s of {dt} s");
            }
        }
    }

    Ok(())
}

/// A scene runs at the costs of the STM32F405: for a day by each method with steps in 32 bits, and
/// for a quarter of a day by its initial method, extrapolation.
#[test]
fn reported_energy_is_that_of_one_instant_all_day() -> Result<(), Error> {
    let settings = SceneName::Beats2To1.first_settings();
    let pendulum = Pendulum::new(&settings.parameters.cast::<f64>())?;
    let start = pendulum.to_state(&settings.motion().cast());
    let energy = pendulum.energy_above_rest(&start);
    for method in [
        None,
        Some(Method::Rk4F32DirectionPlain),
        Some(Method::Rk4F32Direction),
        Some(Method::Rk4Fixed32),
    ] {
        let mut simulation = Simulation::new(
            &settings,
            &Resources {
                format: Format::OLED,
                processor: STM32F405,
                method,
            },
        )?;

        let Stepping { method, steps } = simulation.motion.stepping();
        let dt = 1.0 / f64::from(TICK_RATE * steps);
        let mut exact = pendulum.run::<DirectionF64>(&start, dt)?.counting_turns();
        let mut worst: f64 = 0.0;
        let samples = if method == Method::Extrapolation10Fixed64 {
            SAMPLES_OF_A_SCENE / 4
        } else {
            SAMPLES_OF_A_SCENE
        };
        for _ in 0..samples {
            let ticks = DAY as u32 * TICK_RATE / SAMPLES_OF_A_SCENE;
            (0..ticks).for_each(|_| simulation.tick());
            // Extrapolation loses no energy.
            let lost = if method == Method::Extrapolation10Fixed64 {
                0.0
            } else {
                advance(&mut exact, ticks * steps)?;
                pendulum.energy_above_rest(&exact.state()) / energy - 1.0
            };
            let error = (f64::from(Report::of(&simulation).energy_error) - lost).abs();
            assert!(error.is_finite(), "{}", method.name());
            worst = worst.max(error);
        }

        println!("{}, {steps} steps a frame: {worst:.1e}", method.name());
        assert!(
            worst <= DAY_ENERGY,
            "{}, {steps} steps a frame: {worst:e}",
            method.name()
        );
    }

    Ok(())
}
