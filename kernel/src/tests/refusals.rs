use std::string::ToString;

use double_pendulum::Parameter::{A1, A2, Dt, FrequencyRatio, G, L1, L2, M2, P1, P2, W1, W2};
use double_pendulum::{
    ClosedFormF32, DirectionF32, DirectionF32Plain, Error, ExtrapolationF64, Fixed32, Fixed64,
    Form, HamiltonF32, Modes, Motion, Parameters, Pendulum, State, periodic_mass_ratio,
};

const GOOD: Parameters<f64> = Parameters {
    m1: 1.0,
    m2: 2.0,
    l1: 3.0,
    l2: 4.0,
    g: 9.8,
};

fn pendulum(parameters: Parameters<f64>) -> Result<(), Error> {
    Pendulum::new(&parameters).map(drop)
}

/// Runs the linear motion in `f32`, whose turns are counted in 31 bits.
fn linear(start: Motion<f64>) -> Result<(), Error> {
    let pendulum = Pendulum::new(&GOOD)?;
    pendulum
        .run::<ClosedFormF32>(&pendulum.to_state(&start), 0.01)
        .map(drop)
}

fn single_step(dt: f64) -> Result<(), Error> {
    Pendulum::new(&GOOD)?
        .run::<HamiltonF32>(&State::default(), dt)
        .map(drop)
}

fn periods(fast: u16, slow: u16, lengths: [f64; 2]) -> Result<(), Error> {
    periodic_mass_ratio(fast, slow, lengths).map(drop)
}

#[test]
fn errors_contain_the_parameter_and_its_value() {
    let infinite = f64::INFINITY;
    let not_finite = |parameter, value| Error::NotFinite { parameter, value };
    let not_positive = |parameter, value| Error::NotPositive { parameter, value };
    let too_large = |parameter, value| Error::TooLarge {
        parameter,
        value,
        limit: 1e9,
    };
    let too_small = |parameter, value, limit| Error::TooSmall {
        parameter,
        value,
        limit,
    };

    for (refused, error) in [
        (
            pendulum(Parameters { l1: 0.0, ..GOOD }),
            not_positive(L1, 0.0),
        ),
        (
            pendulum(Parameters { l1: -1.0, ..GOOD }),
            not_positive(L1, -1.0),
        ),
        (
            pendulum(Parameters {
                l1: infinite,
                ..GOOD
            }),
            not_finite(L1, infinite),
        ),
        (
            periods(3, 2, [1e-170, 1.5e-170]),
            too_small(L1, 1e-170, 1e-9),
        ),
        (
            pendulum(Parameters { m2: 1e-10, ..GOOD }),
            too_small(M2, 1e-10, 1e-9),
        ),
        (pendulum(Parameters { l2: 2e9, ..GOOD }), too_large(L2, 2e9)),
        (
            pendulum(Parameters { g: 1e-10, ..GOOD }),
            too_small(G, 1e-10, 1e-9),
        ),
        (
            single_step(1e-50),
            Error::OutOfRange {
                parameter: Dt,
                value: 1e-50,
            },
        ),
        (
            pendulum(Parameters { g: -9.8, ..GOOD }),
            too_small(G, -9.8, 0.0),
        ),
        (
            Modes::new(&Parameters { g: 0.0, ..GOOD }).map(drop),
            not_positive(G, 0.0),
        ),
        (
            linear(Motion::at_rest(1e12, 0.0)),
            Error::OutOfRange {
                parameter: A1,
                value: 1e12,
            },
        ),
        (
            State::at_rest(0.0, infinite).check(),
            not_finite(A2, infinite),
        ),
        (
            Motion::at_rest(0.0, infinite).check(),
            not_finite(A2, infinite),
        ),
        (
            periods(3, 0, [1.0, 1.0]),
            not_finite(FrequencyRatio, infinite),
        ),
        (
            periods(1, 1, [1.0, 1.0]),
            too_small(FrequencyRatio, 1.0, 1.0),
        ),
        (
            periods(3, 2, [8.0, 2.0]),
            too_small(FrequencyRatio, 1.5, 2.0),
        ),
        (
            periods(2, 1, [8.0, 2.0]),
            too_small(FrequencyRatio, 2.0, 2.0),
        ),
        (
            periods(2, 1, [2.0, 8.0]),
            too_small(FrequencyRatio, 2.0, 2.0),
        ),
        (periods(3, 2, [0.0, 1.0]), not_positive(L1, 0.0)),
    ] {
        assert_eq!(refused, Err(error));
    }

    // NaN is not equal to itself, so that its error is matched by hand.
    let nan = pendulum(Parameters {
        m2: f64::NAN,
        ..GOOD
    });
    assert!(
        matches!(nan, Err(Error::NotFinite { parameter: M2, value }) if value.is_nan()),
        "{nan:?}"
    );

    // Zero gravity is allowed, and so are 1.6e9 turns, which are fewer than 2^31.
    let good = [
        pendulum(Parameters { g: 0.0, ..GOOD }),
        State::at_rest(1.0, 2.0).check(),
        Motion::at_rest(1.0, 2.0).check(),
        linear(Motion::at_rest(1e10, 0.0)),
    ];
    assert_eq!(good, [Ok(()); 4]);
}

/// An angle may also be out of range later, when both modes add up.
#[test]
fn closed_form_names_the_number_that_is_out_of_range() -> Result<(), Error> {
    let rest = Motion::default();
    for (start, at_fault) in [
        (Motion { a1: 1e12, ..rest }, A1),
        (Motion { a2: -1e12, ..rest }, A2),
        (Motion { w1: 1e12, ..rest }, W1),
        (Motion { w2: -1e12, ..rest }, W2),
        (Motion::at_rest(1e12, -1e12), A1),
        // The frequency of the slow mode is about 1.2 rad/s.
        (
            Motion {
                a1: 1e12,
                w2: 1e12,
                ..rest
            },
            A1,
        ),
        (
            Motion {
                a1: 1e11,
                w2: 1e12,
                ..rest
            },
            W2,
        ),
        (
            Motion {
                a1: 1e12,
                w2: 1e11,
                ..rest
            },
            A1,
        ),
    ] {
        let Err(Error::OutOfRange { parameter, value }) = linear(start) else {
            panic!("{:?} of {start:?}", linear(start));
        };
        let named = match parameter {
            A1 => start.a1,
            A2 => start.a2,
            W1 => start.w1,
            _ => start.w2,
        };
        assert_eq!(parameter, at_fault, "{start:?}");
        assert!((value / named - 1.0).abs() < 1e-12, "{value} of {start:?}");
    }

    // With a long rod 2, angle 1 reaches 1.33 times the angle at which rod 2 starts.
    let long = Pendulum::new(&Parameters { l2: 300.0, ..GOOD })?;
    let refused = |a2| {
        let start = long.to_state(&Motion { a2, ..rest });
        long.run::<ClosedFormF32>(&start, 0.01).err()
    };
    assert_eq!(refused(1e9), None);
    assert!(matches!(
        refused(1.2e10),
        Some(Error::OutOfRange { parameter: A2, .. })
    ));
    Ok(())
}

#[test]
fn run_names_a_step_that_takes_constants_out_of_range() -> Result<(), Error> {
    fn refused<F: Form>(parameters: &Parameters<f64>, dt: f64) -> Result<Option<Error>, Error> {
        let pendulum = Pendulum::new(parameters)?;
        Ok(pendulum.run::<F>(&State::default(), dt).err())
    }
    let out_of_range = |parameter, value| Some(Error::OutOfRange { parameter, value });

    for m2 in [1.0, 100.0] {
        let parameters = Parameters::equal_rods(m2, 1.0, 9.81);
        for dt in [1e20, -1e20] {
            let expected = refused::<HamiltonF32>(&parameters, dt)?;
            assert!(
                matches!(expected, Some(Error::TooLarge { parameter: Dt, .. })),
                "{expected:?}"
            );
            assert_eq!(refused::<DirectionF32>(&parameters, dt)?, expected);
            assert_eq!(refused::<DirectionF32Plain>(&parameters, dt)?, expected);
        }
        assert!(matches!(
            refused::<ExtrapolationF64<12>>(&parameters, 1e200)?,
            Some(Error::TooLarge { parameter: Dt, .. })
        ));

        // Too short, or infinite in `f32`.
        for dt in [1e-20, -1e-20, 1e50] {
            assert_eq!(
                refused::<DirectionF32>(&parameters, dt)?,
                out_of_range(Dt, dt)
            );
        }
        assert_eq!(
            refused::<ExtrapolationF64<12>>(&parameters, 1e-200)?,
            out_of_range(Dt, 1e-200)
        );
    }
    Ok(())
}

/// (m1/m2) (l1/l2)^2 = 1e54 is infinite in `f32`. G1 and G2 may be out of range in this step only.
#[test]
fn direction_form_names_the_rod_or_step_that_is_out_of_range() -> Result<(), Error> {
    let refused = |ratio, g, dt| {
        let pendulum = Pendulum::new(&Parameters {
            m1: 1.0,
            m2: 1.0 / ratio,
            l1: 1e9,
            l2: 1e9 / ratio,
            g,
        })?;
        let run = pendulum.run::<DirectionF32>(&State::default(), dt);
        Ok(run.err())
    };
    let out_of_range = |parameter, value| Some(Error::OutOfRange { parameter, value });

    assert_eq!(refused(1e9, 9.81, 1e-6)?, None);
    assert_eq!(refused(1.0, 10.0, 1e-20)?, out_of_range(Dt, 1e-20));
    Ok(())
}

#[test]
fn fixed_point_names_the_momentum_of_infinite_energy() -> Result<(), Error> {
    let pendulum = Pendulum::new(&GOOD)?;
    for (p1, p2, parameter, value) in [
        (1e200, 1.0, P1, 1e200),
        (1e200, -1e250, P2, -1e250),
        (-1e308, 1e308, P1, -1e308),
    ] {
        let start = State {
            p1,
            p2,
            ..State::default()
        };
        let error = Err(Error::OutOfRange { parameter, value });
        for dt in [1e-3, -1e-300] {
            assert_eq!(pendulum.run::<Fixed32>(&start, dt).map(drop), error);
            assert_eq!(pendulum.run::<Fixed64<12>>(&start, dt).map(drop), error);
        }
    }
    Ok(())
}

#[test]
fn errors_are_printed_in_one_line() {
    for (error, line) in [
        (
            Error::NotPositive {
                parameter: L1,
                value: 0.0,
            },
            "l1 = 0.0 m: must be greater than zero",
        ),
        (
            Error::TooLarge {
                parameter: Dt,
                value: 2.0,
                limit: 0.5,
            },
            "dt = 2.0 s: must not exceed 0.5 s",
        ),
        (
            Error::TooSmall {
                parameter: G,
                value: -1.0,
                limit: 0.0,
            },
            "g = -1.0 m/s^2: must be at least 0.0 m/s^2",
        ),
        (
            Error::TooSmall {
                parameter: FrequencyRatio,
                value: 2.0,
                limit: 2.0,
            },
            "frequency ratio = 2.0: must exceed 2.0",
        ),
        (
            Error::Diverged {
                parameter: P2,
                value: f64::INFINITY,
            },
            "p2 = inf: the motion has diverged; \
             use a shorter step or, for the closed form, a shorter time",
        ),
        (
            Error::UnequalRods { l1: 3.0, l2: 4.0 },
            "l2 = 4.0 m: must equal l1 = 3.0 m; these equations are for rods of equal length",
        ),
    ] {
        assert_eq!(error.to_string(), line);
    }
}
