use core::f64::consts::{PI, TAU};
use std::vec;

use double_pendulum::parts::DirectionF64;
use double_pendulum::{
    DirectionF32, DirectionF32Plain, Error, ExtrapolationF64, Fixed32, Fixed64, Form, HamiltonF32,
    HamiltonF64, Modes, Motion, Parameter, Parameters, Pendulum, State,
};
use fastrand::Rng;

const EVEN: Parameters<f64> = Parameters {
    m1: 1.0,
    m2: 1.0,
    l1: 1.0,
    l2: 1.0,
    g: 9.81,
};

fn is_stable_up_to<F: Form>(phase: f64) -> Result<(), Error> {
    let start = State::at_rest(1e-6, 1e-6);
    for parameters in [EVEN, Parameters { m2: 1000.0, ..EVEN }] {
        let pendulum = Pendulum::new(&parameters)?;
        let longest = phase / Modes::new(&parameters)?.fast.frequency;
        for dt in [0.999 * longest, -0.999 * longest] {
            pendulum.run::<F>(&start, dt)?.advance(1)?;
        }
        for dt in [1.001 * longest, -1.001 * longest, 1e6] {
            let Err(Error::TooLarge {
                parameter: Parameter::Dt,
                value,
                limit,
            }) = pendulum.run::<F>(&start, dt)
            else {
                panic!("{dt} s is accepted")
            };
            assert!(
                value == dt && (limit / longest - 1.0).abs() < 1e-9,
                "{limit}"
            );
            pendulum.run::<F>(&start, limit)?;
        }
    }

    let free = Pendulum::new(&Parameters { g: 0.0, ..EVEN })?;
    free.run::<F>(&State::at_rest(1.0, 2.0), 1e6)?.advance(2)
}

/// Phases of the fast mode, rad.
#[test]
fn run_refuses_steps_beyond_the_limit_of_stability() -> Result<(), Error> {
    let rk4 = 8.0_f64.sqrt();
    is_stable_up_to::<HamiltonF32>(rk4)?;
    is_stable_up_to::<HamiltonF64>(rk4)?;
    is_stable_up_to::<DirectionF32>(rk4)?;
    is_stable_up_to::<DirectionF32Plain>(rk4)?;
    is_stable_up_to::<DirectionF64>(rk4)?;
    is_stable_up_to::<ExtrapolationF64<2>>(0.95)?;
    is_stable_up_to::<ExtrapolationF64<12>>(4.77)?;
    is_stable_up_to::<ExtrapolationF64<16>>(7.35)
}

#[test]
fn fixed_point_accepts_the_limit_that_run_reports() -> Result<(), Error> {
    fn check<F: Form>(m2: f64) -> Result<(), Error> {
        let parameters = Parameters { m2, ..EVEN };
        let pendulum = Pendulum::new(&parameters)?;
        let start = State::at_rest(1e-6, 1e-6);
        let Err(Error::TooLarge { limit, .. }) = pendulum.run::<F>(&start, 1e6) else {
            panic!("1e6 s is accepted")
        };
        // The reported limit is accurate to a part in a million.
        pendulum.run::<F>(&start, 0.999_999 * limit)?.advance(100)
    }

    for m2 in [1.0, 100.0, 1000.0, 3000.0] {
        check::<Fixed32>(m2)?;
        check::<Fixed64<4>>(m2)?;
        check::<Fixed64<12>>(m2)?;
    }

    Ok(())
}

/// The step is limited only by the unit of time, whose square must be a finite `f64`.
#[test]
fn fixed64_at_rest_without_gravity_stays_at_rest_or_is_refused() -> Result<(), Error> {
    let free = Pendulum::new(&Parameters { g: 0.0, ..EVEN })?;
    let start = State::at_rest(1.0, 2.0);

    for dt in [1e-300, 1.0, 1e150] {
        let mut run = free.run::<Fixed64<8>>(&start, dt)?;
        run.advance(3)?;
        let state = run.state();
        assert!(
            state.check().is_ok() && (state.a1 - 1.0).abs() < 1e-15,
            "{state:?}"
        );
    }

    for dt in [1e152, 1e303, f64::MAX] {
        let refused = free.run::<Fixed64<8>>(&start, dt);
        assert!(
            matches!(refused, Err(Error::TooLarge { .. })),
            "{dt} s: {refused:?}"
        );
    }

    Ok(())
}

fn energy_stays_within_its_bound<F: Form>() -> Result<(), Error> {
    let mut rng = Rng::with_seed(5);
    let mut symmetric = |most: f64| most * (2.0 * rng.f64() - 1.0);
    let mut refused = 0;
    for _ in 0..200 {
        let parameters = Parameters {
            m2: symmetric(5.0).exp2(),
            l2: symmetric(2.0).exp2(),
            ..EVEN
        };

        let pendulum = Pendulum::new(&parameters)?;
        let motion = Motion {
            a1: symmetric(PI),
            a2: symmetric(PI),
            w1: symmetric(300.0),
            w2: symmetric(300.0),
        };

        let start = pendulum.to_state(&motion);
        let most = 100.0 * pendulum.energy_above_rest(&start);

        let mut run = pendulum.run::<F>(&start, 1.0 / 60.0)?;
        for _ in 0..100 {
            let before = run;
            match run.advance(1) {
                Ok(()) => {
                    let energy: f64 = run.energy().into();
                    assert!(energy <= 1.001 * most, "{energy:e} J of {most:e} J");
                    for [s, c] in run.directions() {
                        let square: f64 = (s * s + c * c).into();
                        let length = square.sqrt();
                        assert!((0.49..2.01).contains(&length), "{length}");
                    }
                }
                Err(error) => {
                    assert!(matches!(error, Error::Diverged { .. }), "{error:?}");
                    assert_eq!(run, before, "a refused step does not change the run");
                    refused += 1;
                    break;
                }
            }
        }
    }
    assert!(refused > 100, "{refused} of 200 refused");
    Ok(())
}

#[test]
fn advance_refuses_an_energy_far_above_that_of_the_start() -> Result<(), Error> {
    energy_stays_within_its_bound::<HamiltonF32>()?;
    energy_stays_within_its_bound::<HamiltonF64>()?;
    energy_stays_within_its_bound::<DirectionF32>()?;
    energy_stays_within_its_bound::<DirectionF32Plain>()?;
    energy_stays_within_its_bound::<DirectionF64>()?;
    energy_stays_within_its_bound::<ExtrapolationF64<12>>()
}

#[test]
fn unit_of_momentum_may_be_subnormal_in_single_precision() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters {
        m1: 1e9,
        m2: 1e9,
        l1: 1e9,
        l2: 1e9,
        g: 9.81,
    })?;
    for start in [State::at_rest(0.0, 0.0), State::at_rest(1.0, 2.0)] {
        pendulum.run::<DirectionF32>(&start, 1e-12)?.advance(64)?;
        pendulum
            .run::<DirectionF32Plain>(&start, 1e-12)?
            .advance(64)?;
    }
    Ok(())
}

fn counts_turns_on_request<F: Form>() -> Result<(), Error> {
    let pendulum = Pendulum::new(&Parameters { m2: 2.75, ..EVEN })?;
    let mut plain = pendulum.run::<F>(&State::at_rest(3.0, 3.0 + TAU), 1.0 / 256.0)?;
    let mut counting = plain.counting_turns();
    let mut farthest: f64 = 0.0;
    for _ in 0..512 {
        plain.advance(5)?;
        counting.advance(5)?;
        let mut words = [vec![], vec![]];
        plain.bits(|word| words[0].push(word));
        counting.bits(|word| words[1].push(word));
        assert_eq!(words[0], words[1]);

        assert_eq!(plain.counting_turns().angles(), plain.angles());

        let motion = plain.motion();
        for (nearly, exact) in motion
            .momenta_nearly()
            .into_iter()
            .zip(motion.momenta::<f64>())
        {
            let error = (Into::<f64>::into(nearly) - exact).abs();
            assert!(error <= 3e-7 * exact.abs(), "{nearly:?} for {exact}");
        }

        let [own, counted] =
            [plain.angles(), counting.angles()].map(|angles| angles.map(Into::<f64>::into));
        let states = [plain.state(), counting.state()].map(|state| state.angles());
        for (own, counted) in own
            .into_iter()
            .zip(counted)
            .chain(states[0].into_iter().zip(states[1]))
        {
            let turns = (counted - own) / TAU;
            assert!(
                (turns - turns.round()).abs() < 1e-6,
                "{own} and {counted} rad"
            );
            if motion.has_turns() {
                assert_eq!(own, counted);
            } else {
                assert!(own.abs() <= PI + 1e-6, "{own} rad");
            }
            farthest = farthest.max(counted.abs());
        }
    }
    assert!(farthest > 3.0 * PI, "no rod turned over: {farthest} rad");
    assert_eq!([plain.time(), counting.time()], [10.0; 2]);

    let mut backwards = pendulum.run::<F>(&State::at_rest(1.0, 2.0), -1.0 / 256.0)?;
    assert_eq!(backwards.time(), 0.0);
    backwards.advance(3)?;
    assert_eq!(backwards.time(), -3.0 / 256.0);

    Ok(())
}

#[test]
fn turns_are_counted_on_request() -> Result<(), Error> {
    counts_turns_on_request::<DirectionF32>()?;
    counts_turns_on_request::<DirectionF32Plain>()?;
    counts_turns_on_request::<Fixed32>()?;
    counts_turns_on_request::<Fixed64<12>>()?;
    counts_turns_on_request::<ExtrapolationF64<12>>()?;
    counts_turns_on_request::<HamiltonF64>()
}
