//! Requests over the serial link, answered by the application that runs on the boards.

use std::f64::consts::PI;

use double_pendulum::{Equations, Error, Integrator, Method, Parameters};
use firmware::app::Event;
use firmware::job::{ON_BOARDS, Reading, Request};
use firmware::protocol::{Answer, Command, Field};

use crate::bench::{answers, app, wire};

/// The difference from `rk4-f64` within a second of a motion with both rods turning over, in steps
/// of 1/8192 s, by every method but the closed form, rad and kg m^2/s. The first value is for `f64`
/// and 64-bit fixed point, the second for `f32` and 32-bit fixed point, and the third for the sines
/// of `micromath`.
const TURNING: [f64; 3] = [5e-7, 5e-3, 1.0];

/// The difference of the closed form from `rk4-f64` within a second of a motion of 2e-5 rad, rad
/// and kg m^2/s. In double precision, the first value, it is the nonlinear part and RK4's own error
/// (measured 1.8e-13), in single precision a few roundings (measured 1.4e-11).
const SMALL_MOTION: [f64; 2] = [3e-13, 2e-11];

const REQUEST: Request = Request {
    method: Method::Rk4F32,
    parameters: Parameters {
        m1: 1.0,
        m2: 2.75,
        l1: 1.0,
        l2: 0.5,
        g: 9.8,
    },
    angles: [2.0, -1.0],
    velocities: [0.5, 0.25],
    dt: 1.0 / 1024.0,
    stride: 16,
    samples: 5,
};

fn answers_to(requests: &[Request]) -> Vec<(u16, Answer)> {
    let mut app = app();
    for (number, request) in (1..).zip(requests) {
        app.receive(wire(number, Command::Simulate(*request)), |event| {
            assert!(
                matches!(event, Event::Asked | Event::StepTooLong(_)),
                "{event:?}"
            );
        });
    }
    while app.work(|_| ()) {}
    answers(&app.link)
}

fn samples(answers: &[(u16, Answer)], request: u16) -> usize {
    let is_sample =
        |&&(to, answer): &&(u16, Answer)| to == request && matches!(answer, Answer::Sample { .. });
    answers.iter().filter(is_sample).count()
}

fn readings(request: &Request) -> Result<Vec<Reading>, Error> {
    let mut readings = Vec::new();
    request.readings(|reading| {
        readings.push(*reading);
        Ok::<_, Error>(())
    })?;
    Ok(readings)
}

/// Both rods turn over, and the closed form, which counts no turns, makes steps of more than a
/// quarter turn.
#[test]
fn every_method_of_the_boards_answers_with_the_hosts_readings() {
    for &method in ON_BOARDS {
        let parameters = Parameters {
            l2: 1.0,
            ..REQUEST.parameters
        };
        let request = Request {
            method,
            parameters,
            ..REQUEST
        };
        let (dt, stride) = if method.integrator() == Integrator::ClosedForm {
            (1.0 / 8.0, 1)
        } else {
            (1.0 / 1024.0, 256)
        };
        let turning = Request {
            velocities: [14.0, -9.0],
            dt,
            stride,
            ..request
        };

        for request in [request, turning] {
            let readings = readings(&request).expect("a pendulum");
            assert_eq!(readings.len(), 6);
            let expected = (0..)
                .zip(readings)
                .map(|(index, reading)| (1, Answer::Sample { index, reading }));
            assert_eq!(
                answers_to(&[request]),
                expected.collect::<Vec<_>>(),
                "{method}"
            );
        }
    }
}

#[test]
fn every_method_computes_the_same_motion() {
    let turning = Request {
        velocities: [14.0, -9.0],
        dt: 1.0 / 8192.0,
        stride: 1024,
        samples: 8,
        ..REQUEST
    };
    let small = Request {
        angles: [1e-5, -2e-5],
        velocities: [0.0, 3e-5],
        ..turning
    };
    let readings = |method, motion: Request| {
        readings(&Request { method, ..motion }).unwrap_or_else(|error| panic!("{method}: {error}"))
    };

    let last = readings(Method::Rk4F64, turning)
        .last()
        .expect("a sample")
        .state;
    assert!(
        last[0].abs() > PI && last[1].abs() > PI,
        "both rods turn over: {last:?}"
    );

    for &method in Method::ALL {
        // The tolerance depends on the arithmetic.
        let [double, single, micromath] = TURNING;
        let (motion, near) = match method {
            _ if method.equations() == Equations::Linear => {
                (small, SMALL_MOTION[usize::from(method.is_single())])
            }
            Method::Rk4F32Micromath => (turning, micromath),
            Method::Rk4Fixed32 => (turning, single),
            _ if method.is_single() => (turning, single),
            _ => (turning, double),
        };

        let mut farthest = 0.0_f64;
        for (reading, exact) in readings(method, motion)
            .iter()
            .zip(&readings(Method::Rk4F64, motion))
        {
            farthest = reading
                .state
                .iter()
                .zip(exact.state)
                .map(|(x, y)| (x - y).abs())
                .fold(farthest, f64::max);
        }
        println!("{method}: {farthest:e}");
        assert!(farthest < near, "{method}: {farthest:e}");
    }
}

#[test]
fn the_crc_covers_every_sample() -> Result<(), Error> {
    for &method in Method::ALL {
        let crc = |stride, samples| {
            Request {
                stride,
                samples,
                ..Request::on_any_core(method)
            }
            .crc()
        };
        assert_ne!(crc(1, 2)?, crc(2, 1)?, "{method}");
        assert_ne!(crc(1, 1)?, crc(2, 1)?, "{method}");
    }
    Ok(())
}

#[test]
fn a_request_equals_its_parsed_text() {
    for &method in Method::ALL {
        let request = Request { method, ..REQUEST };
        assert_eq!(Request::parse(&request.to_string()), Some(request));
        assert_eq!(
            method.order() == 0,
            method.integrator() == Integrator::ClosedForm,
            "{method}"
        );
    }

    let text = REQUEST.to_string();
    for broken in [
        "",
        &text[2..],
        &text.replace('0', "g"),
        &text.replacen("01", "ff", 1),
        "\u{e4}\u{e4}",
    ] {
        assert_eq!(Request::parse(broken), None, "{broken}");
    }
}

#[test]
fn a_step_too_long_for_the_energy_is_computed_with_a_warning() {
    let coarse = Request {
        parameters: Parameters {
            m2: 1000.0,
            ..REQUEST.parameters
        },
        ..REQUEST
    };

    // The heavy bob 2 makes the step of the request more than ten times too long.
    let admissible_step = coarse.admissible_step().expect("a pendulum");
    assert!(admissible_step < coarse.dt / 10.0);
    let fine = Request {
        dt: admissible_step,
        ..coarse
    };
    let closed_form = Request {
        method: Method::ClosedFormF64,
        ..coarse
    };
    for (request, is_warned) in [(coarse, true), (fine, false), (closed_form, false)] {
        let answers = answers_to(&[request]);
        let warned = answers.strip_prefix(&[(1, Answer::StepTooLong(admissible_step))]);
        assert_eq!(
            (warned.is_some(), samples(warned.unwrap_or(&answers), 1)),
            (is_warned, 6)
        );
    }
}

#[test]
fn the_admissible_step_is_in_proportion_to_the_order_of_extrapolation() {
    let step = |method| Request { method, ..REQUEST }.admissible_step();
    let rk4 = step(Method::Rk4F64).expect("a pendulum");
    for (method, share) in [
        (Method::Rk4F32, 1.0),
        (Method::Extrapolation8Fixed64, 4.0),
        (Method::Extrapolation10Fixed64, 5.0),
        (Method::Extrapolation16F64, 8.0),
    ] {
        assert_eq!(step(method), Some(share * rk4), "{method}");
    }
    assert_eq!(step(Method::ClosedFormF64), None);
}

#[test]
fn a_refusal_names_the_field_and_does_not_end_the_previous_request() {
    let pendulum = |m1, m2, l1, l2, g| Request {
        parameters: Parameters { m1, m2, l1, l2, g },
        ..REQUEST
    };
    let start = |angles, velocities| Request {
        angles,
        velocities,
        ..REQUEST
    };

    for (wrong, field) in [
        (
            Request {
                method: Method::TextbookF32,
                ..REQUEST
            },
            Field::Method,
        ),
        (pendulum(0.0, 1.0, 1.0, 1.0, 9.8), Field::M1),
        (pendulum(1.0, -1.0, 1.0, 1.0, 9.8), Field::M2),
        (pendulum(1.0, 1.0, f64::NAN, 1.0, 9.8), Field::L1),
        (pendulum(1.0, 1.0, 1.0, f64::INFINITY, 9.8), Field::L2),
        (pendulum(1.0, 1.0, 1.0, 1.0, -9.8), Field::G),
        (start([f64::NAN, 0.0], [0.0; 2]), Field::A1),
        (start([0.0, f64::NAN], [0.0; 2]), Field::A2),
        (start([0.0; 2], [f64::INFINITY, 0.0]), Field::W1),
        (start([0.0; 2], [0.0, f64::INFINITY]), Field::W2),
        // Momentum 1, (m1 + m2) l1^2 w1 = 3.75e38 kg m^2/s, is beyond the range of `f32`.
        (start([0.0; 2], [1e38, 0.0]), Field::W1),
        (Request { dt: 0.0, ..REQUEST }, Field::Dt),
        (Request { dt: 9.0, ..REQUEST }, Field::Dt),
    ] {
        let answers = answers_to(&[REQUEST, wrong]);
        // The refusal comes first, because the motion is computed later.
        assert_eq!(answers[0], (2, Answer::Refused(field)));
        assert_eq!((answers.len(), samples(&answers, 1)), (7, 6), "{field:?}");
    }
}

#[test]
fn a_new_request_replaces_the_one_under_way() {
    let answers = answers_to(&[REQUEST; 2]);
    assert_eq!((answers.len(), samples(&answers, 2)), (6, 6));
}

#[test]
fn the_longest_request_equals_its_parsed_text() {
    let request = Request {
        stride: u32::MAX,
        samples: u32::MAX,
        ..REQUEST
    };
    let text = request.to_string();
    assert_eq!(text.len(), 2 * 91);
    assert_eq!(Request::parse(&text), Some(request));
}
